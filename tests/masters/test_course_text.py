"""The page that leads from the course text to the notebooks leaves none of them out."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import nbformat
import pytest

from autograder import exercises
from autograder.masters.master_files import chapter_path, masters

ROOT = Path(__file__).resolve().parents[2]
PARTS_OF_THE_TEXT = 74
CONTINUED = "Step "
"""An exercise is judged where its last step ends."""
PAGE = (ROOT / "docs" / "course-text.md").read_text(encoding="utf-8")


def test_every_notebook_is_linked() -> None:
    linked = set(re.findall(r"\(\.\./(chapters/[^)#]+)\)", PAGE))
    assert linked == {chapter_path(ROOT, master).relative_to(ROOT).as_posix() for master in masters(ROOT)}


def test_every_exercise_is_named() -> None:
    named = set(re.findall(r"`(\w+\.\w+)`", PAGE))
    hunts = {one.id for one in exercises.unbroken() if one.hides_causes}  # of these, the notebooks are linked
    assert set(exercises.all_ids()) - hunts <= named


@dataclass(frozen=True)
class Row:
    """A row of the table: one or more parts of the text, and where they are."""

    numbers: tuple[int, ...]
    part: str
    chapter: Path
    heading: str
    cells: tuple[str, ...]


def rows() -> list[Row]:
    """The rows of the table that says where each part of the text is."""
    found = re.findall(
        r"^\| (\d+)(?:–(\d+))? \| (.+?) \| (?:\[[^\]]+\]\(\.\./(chapters/\S+)\) )?\| (.+?) \| (.*)\|$",
        PAGE,
        flags=re.MULTILINE,
    )
    made = []
    chapter = ""
    for first, last, part, linked, heading, cells in found:
        chapter = linked or chapter  # an empty one is that of the row above
        numbers = tuple(range(int(first), int(last or first) + 1))
        made.append(Row(numbers, part, ROOT / chapter, heading, tuple(re.findall(r"`([^`]+)`", cells))))
    return made


def test_the_table_has_every_part_of_the_text() -> None:
    assert [number for row in rows() for number in row.numbers] == list(range(1, PARTS_OF_THE_TEXT + 1))


@pytest.mark.parametrize("row", rows(), ids=lambda row: str(row.numbers[0]))
def test_a_part_of_the_text_is_where_the_table_says(row: Row) -> None:
    """The heading is in the notebook, and the cells are below it, before the next heading of its level."""
    level, below = 0, set[str]()
    for cell in nbformat.read(row.chapter, as_version=4).cells:
        if cell.cell_type == "markdown":
            text = re.sub(r"^```.*?^```", "", cell.source, flags=re.MULTILINE | re.DOTALL)
            for marks, title in re.findall(r"^(#+) (.+)$", text, flags=re.MULTILINE):
                if title == row.heading:
                    level = len(marks)
                elif level and len(marks) <= level and not (level == 2 and title.startswith(CONTINUED)):
                    level = -1
        if level > 0:
            below |= {
                cell.get("metadata", {}).get("nbgrader", {}).get("grade_id", ""),
                *cell.get("attachments", {}),
            }
    assert level, f"no heading '{row.heading}'"
    assert {name.replace(".", "-") if name in exercises.all_ids() else name for name in row.cells} <= below
