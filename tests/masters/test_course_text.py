"""The page that leads from the course text to the notebooks leaves none of them out."""

from __future__ import annotations

import re
from pathlib import Path

from autograder import exercises
from autograder.masters.layout import chapter_path, masters

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "course-text.md").read_text(encoding="utf-8")


def test_every_notebook_is_linked() -> None:
    linked = set(re.findall(r"\(\.\./(chapters/[^)#]+)\)", PAGE))
    assert linked == {chapter_path(ROOT, master).relative_to(ROOT).as_posix() for master in masters(ROOT)}


def test_every_exercise_is_named() -> None:
    named = set(re.findall(r"`(\w+\.\w+)`", PAGE))
    assert set(exercises.all_ids()) <= named


def test_the_first_notebook_lists_them_all() -> None:
    first = (ROOT / "solutions/01_ros2_fundamentals/00_nervous_system.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| \d+ \| \[[^\]]+\]\(([\w]+)\.ipynb\)", first, flags=re.MULTILINE)
    others = {master.stem for master in masters(ROOT)} - {"00_nervous_system"}
    assert len(table) == len(set(table))
    assert set(table) == others
