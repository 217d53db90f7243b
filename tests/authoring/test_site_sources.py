"""What the website tells of each notebook, before Sphinx makes pages of it."""

from __future__ import annotations

from pathlib import Path

import msgspec
import nbformat
import pytest

from autograder import course
from autograder.authoring.site_building import SOLUTION_SUMMARY, _write_sources
from autograder.kit.hunts.ticket import Ticket

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sources")
    _write_sources(ROOT, folder, {})
    return folder


def page_of(sources: Path, chapter: str, lab: str) -> str:
    notebook = nbformat.read(sources / "chapters" / chapter / f"{lab}.ipynb", as_version=4)
    # What folds a cell is its metadata.
    return " ".join(
        word for cell in notebook.cells for word in f"{cell.source} {dict(cell.metadata)}".split()
    )


def test_a_lab_has_its_solutions(sources: Path) -> None:
    assert SOLUTION_SUMMARY in page_of(sources, "01_ros2_fundamentals", "lab_1_2")


@pytest.mark.parametrize(
    "file", sorted(ROOT.glob(f"solutions/*/*/*{course.TICKET}")), ids=lambda file: file.name
)
def test_a_bug_hunt_has_no_solution_and_no_cause(sources: Path, file: Path) -> None:
    ticket = msgspec.toml.decode(file.read_bytes(), type=Ticket)
    text = page_of(sources, file.parents[1].name, file.parent.name)
    assert ticket.task in text
    told = [words for words in (ticket.cause, ticket.sooner, ticket.seen, SOLUTION_SUMMARY) if words in text]
    assert told == []
