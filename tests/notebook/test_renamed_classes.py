"""A class that was given another name in its cell: a check of the earlier name does not judge what no cell defines."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

import pytest

from tests.cases import cases

if TYPE_CHECKING:
    from .conftest import CellOutput, Notebook

# A judge that is reached has said enough: the check has 0.0 points then.
JUDGE = cases(__file__, "JUDGE")
_numbers = count()


def checked(notebook: Notebook, *cells: tuple[str, str]) -> CellOutput:
    """Run cells, each with its id, and then check a Talker, whose name each test has for itself."""
    name = f"Talker{next(_numbers)}"
    notebook.run(JUDGE)
    for cell, source in cells:
        notebook.run(source.replace("Talker", name), f"{cell} of {name}")
    return notebook.run(f"check('lab', {name})", f"check of {name}")


OLD, NEW = "class Talker: ...", "class Speaker: ..."


@pytest.mark.parametrize(
    "cells", cases(__file__, "a_name_that_its_cell_does_not_define_any_more_is_not_judged")
)
def test_a_name_that_its_cell_does_not_define_any_more_is_not_judged(
    notebook: Notebook, cells: list[tuple[str, str]]
) -> None:
    shown = checked(notebook, *cells)
    assert shown.error is not None
    assert "does not define Talker" in shown.error
    assert "Correct that cell and run it" in shown.error


def test_what_the_checked_function_uses_must_be_in_a_cell_too(notebook: Notebook) -> None:
    for cell, source in (
        ("h", "class Help: ..."),
        ("m", "def make(): return Help()"),
        ("h", "class Helper: ..."),
    ):
        notebook.run(source, cell)
    notebook.run(JUDGE)
    shown = notebook.run("check('lab', make)")
    assert "does not define Help any more, it defines Helper" in str(shown.error)


@pytest.mark.parametrize("cells", cases(__file__, "a_name_that_is_defined_elsewhere_is_judged"))
def test_a_name_that_is_defined_elsewhere_is_judged(notebook: Notebook, cells: list[tuple[str, str]]) -> None:
    shown = checked(notebook, *cells)
    assert (shown.error, shown.value) == (None, "0.0")


BASE, BETTER = (f"class TalkerBase:\n    def tell(self):\n        return {word}" for word in ("1", "2"))


@pytest.mark.parametrize("derived", ["class Talker(TalkerBase): ...", "class Talker:\n    kind = TalkerBase"])
def test_a_class_made_from_one_that_was_corrected_later_is_not_judged(
    notebook: Notebook, derived: str
) -> None:
    shown = checked(notebook, ("base", BASE), ("derived", derived), ("base", BETTER))
    assert shown.error is not None
    assert "still from an older one" in shown.error
    assert "Run the cell with Talker" in shown.error
    assert checked(notebook, ("base", BASE), ("base", BETTER), ("derived", derived)).error is None


@pytest.mark.parametrize("again", [BASE, "class TalkerBase(TalkerBase): ..."])
def test_a_cell_that_ran_again_unchanged_or_builds_on_its_own_class_hinders_no_check(
    notebook: Notebook, again: str
) -> None:
    cells = [("base", BASE), ("derived", "class Talker(TalkerBase): ..."), ("base", again)]
    assert checked(notebook, *cells[:2], ("base", BASE)).error is None
    assert checked(notebook, cells[0], cells[2], cells[1]).error is None
