"""Each part of the course text is where ``course_text.toml`` says, and the page about it leaves out no notebook."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import nbformat
import pytest

from autograder import exercises
from autograder.masters.master_files import chapter_path, masters

ROOT = Path(__file__).resolve().parents[2]
PARTS_OF_THE_TEXT = 74
CONTINUED = "Step "
"""An exercise is judged where its last step ends."""
ROWS = tomllib.loads((Path(__file__).parent / "course_text.toml").read_text(encoding="utf-8"))["rows"]
PAGE = (ROOT / "docs" / "course-text.md").read_text(encoding="utf-8")


def test_every_notebook_is_linked() -> None:
    linked = set(re.findall(r"\(\.\./(chapters/[^)#]+)\)", PAGE))
    assert linked == {chapter_path(ROOT, master).relative_to(ROOT).as_posix() for master in masters(ROOT)}


def test_the_table_has_every_part_of_the_text() -> None:
    parts = [number for row in ROWS for number in range(row["parts"][0], row["parts"][1] + 1)]
    assert parts == list(range(1, PARTS_OF_THE_TEXT + 1))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: str(row["parts"][0]))
def test_a_part_of_the_text_is_where_the_table_says(row: dict[str, Any]) -> None:
    """The heading is in the notebook, and the cells are below it, before the next heading of its level."""
    level, below = 0, set[str]()
    notebook = ROOT / "chapters" / "01_ros2_fundamentals" / f"{row['notebook']}.ipynb"
    for cell in nbformat.read(notebook, as_version=4).cells:
        if cell.cell_type == "markdown":
            text = re.sub(r"^```.*?^```", "", cell.source, flags=re.MULTILINE | re.DOTALL)
            for marks, title in re.findall(r"^(#+) (.+)$", text, flags=re.MULTILINE):
                if title == row["heading"]:
                    level = len(marks)
                elif level and len(marks) <= level and not (level == 2 and title.startswith(CONTINUED)):
                    level = -1
        if level > 0:
            below |= {
                cell.get("metadata", {}).get("nbgrader", {}).get("grade_id", ""),
                *cell.get("attachments", {}),
            }
    assert level, f"no heading '{row['heading']}'"
    assert {
        name.replace(".", "-") if name in exercises.all_ids() else name for name in row.get("below", [])
    } <= below
