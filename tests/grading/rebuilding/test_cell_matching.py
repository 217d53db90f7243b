"""Right answers count whatever an editor did to their cells; what is given, and each check, stays the master's."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import jupytext
import nbformat
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from nbformat import NotebookNode

from autograder.execution.executed_cells import CellType
from autograder.grading.rebuilding.notebook_parsing import parse
from autograder.grading.rebuilding.notebook_rebuilding import rebuild
from autograder.grading.rebuilding.submitted_notebook import SubmittedCell
from tests.cases import cases
from tests.drawn import drawn

if TYPE_CHECKING:
    from collections.abc import Callable

QUESTION = "Why can many nodes publish on one topic?"
FILE = "ws/src/talker.py"
CELLS = cases(__file__, "CELLS")
ANSWERS = cases(__file__, "ANSWERS")
RIGHT = {"talker": "hello", "hears": "hello", "rule": "a:=b", "file": "print('hello')"}

Cells = list[SubmittedCell]


def master() -> NotebookNode:
    cells = [nbformat.v4.new_markdown_cell("# A lab", id="text-1")]
    for name, source in CELLS.items():
        cell = nbformat.v4.new_code_cell(source, id=name)
        marks = {
            "grade": name.startswith("check"),
            "solution": name in ANSWERS,
            "locked": name not in ANSWERS,
        }
        cell.metadata["nbgrader"] = {"grade_id": name, **marks}
        cells.append(cell)
    question = nbformat.v4.new_markdown_cell(f"{QUESTION}\n\nYOUR ANSWER HERE", id="why")
    question.metadata["nbgrader"] = {"grade_id": "why", "grade": True, "solution": True, "locked": False}
    question.metadata["autograder"] = {"rubric": "", "given": QUESTION}
    return nbformat.v4.new_notebook(cells=[*cells, question])


def handed_in() -> NotebookNode:
    notebook = nbformat.from_dict(master())
    for cell in notebook.cells:
        cell.metadata.pop("autograder", None)
        cell.source = ANSWERS.get(cell.id, cell.source)
    notebook.cells[-1].source = f"{QUESTION}\n\nBecause nobody owns it."
    return notebook


def submitted(notebook: NotebookNode | None = None) -> Cells:
    return parse(nbformat.writes(notebook or handed_in()).encode())[0]


def outcome(cells: Cells) -> dict[str, str]:
    """What the checks see where the rebuilt notebook is run from top to bottom."""
    scope: dict[str, Any] = {"seen": {}, "files": {}}
    for cell in rebuild(master(), cells).cells:
        if cell.cell_type == "markdown":
            continue
        head, _, text = cell.source.partition("\n")
        if head.startswith("%%writefile"):
            scope["files"][head.split()[-1]] = text
        else:
            try:
                exec(cell.source, scope)
            except NameError:
                continue  # as in a notebook, the next cell runs
    return dict(scope["seen"])


def without_metadata(cells: Cells) -> Cells:
    return [replace(cell, grade_id="") for cell in cells]


def without_ids(cells: Cells) -> Cells:
    return [replace(cell, identifier=f"{number:08x}") for number, cell in enumerate(cells)]


def bare(cells: Cells) -> Cells:
    return without_ids(without_metadata(cells))


def through_jupytext(cells: Cells) -> Cells:
    notebook = handed_in()
    for cell in notebook.cells:
        cell.metadata.clear()
    return submitted(jupytext.reads(jupytext.writes(notebook, fmt="py:percent"), fmt="py:percent"))


def answers_in_own_cells(*, at: Callable[[Cells], int]) -> Callable[[Cells], Cells]:
    """The solution cells are deleted, and their texts are in new cells at a place."""

    def moved(cells: Cells) -> Cells:
        kept = [cell for cell in cells if cell.grade_id not in ANSWERS]
        place = at(kept)
        own = [SubmittedCell(CellType.CODE, text, "", "own") for text in ANSWERS.values()]
        return [*kept[:place], *own, *kept[place:]]

    return moved


def place_of(name: str) -> Callable[[Cells], int]:
    return lambda cells: next(place for place, cell in enumerate(cells) if cell.identifier == name)


def merged(first: str, *others: str) -> Callable[[Cells], Cells]:
    """Cells are merged into one, which keeps the marks of the first that is named."""

    def joined(cells: Cells) -> Cells:
        text = "\n\n".join(cell.source for cell in cells if cell.identifier in (first, *others))
        kept = [cell for cell in cells if cell.identifier not in others]
        return [replace(cell, source=text) if cell.identifier == first else cell for cell in kept]

    return joined


def reordered(cells: Cells) -> Cells:
    return [*cells[5:], *cells[:5]]


def duplicated(cells: Cells) -> Cells:
    """The answer was tried in a copy first, and both are there."""
    place = place_of("Talker")(cells)
    wrong = replace(cells[place], source='class Talker(Node):\n    says = "helo"', identifier="copy")
    return [*cells[:place], wrong, *cells[place:]]


def split(cells: Cells) -> Cells:
    """A helper of the answer is split off, into a cell before it."""
    place = place_of("hears")(cells)
    helper = SubmittedCell(CellType.CODE, 'heard = "hello"', "", "half")
    answer = replace(cells[place], source="def hears():\n    return heard")
    return [*cells[:place], helper, answer, *cells[place + 1 :]]


def with_a_helper(cells: Cells) -> Cells:
    """The class is below a given cell, and needs the cell before it when it is defined."""
    kept = [cell for cell in cells if cell.identifier != "Talker"]
    helper = SubmittedCell(CellType.CODE, 'class Base(Node):\n    says = "hello"', "", "own1")
    answer = SubmittedCell(CellType.CODE, "class Talker(Base):\n    pass", "", "own2")
    place = place_of("check-talker")(kept)
    return [*kept[:place], helper, answer, *kept[place:]]


def with_a_helper_at_the_end(cells: Cells) -> Cells:
    cells = with_a_helper(cells)
    own = [cell for cell in cells if cell.identifier.startswith("own")]
    return [*(cell for cell in cells if cell not in own), *own]


def in_one_cell_at_the_end(cells: Cells) -> Cells:
    kept = [cell for cell in cells if cell.identifier not in {"Talker", "hears", "check-talker"}]
    text = "\n\n".join(ANSWERS[name] for name in ("Talker", "hears"))
    return [*kept, SubmittedCell(CellType.CODE, text, "", "own")]


def file_by_a_script(cells: Cells) -> Cells:
    """Its cell is deleted, and a script of the student's writes it, far above the place of the stub."""
    script = SubmittedCell(CellType.CODE, f"files['{FILE}'] = \"print('hello')\"", "", "own")
    kept = [cell for cell in cells if cell.identifier != "talker_py"]
    return [*kept[:2], script, *kept[2:]]


def by_other_words(cells: Cells) -> Cells:
    """Deleted, and defined anew by an assignment and with another way to write the path."""
    kept = [cell for cell in cells if cell.grade_id not in {"Talker", "talker_py"}]
    alias = SubmittedCell(CellType.CODE, 'class Mine(Node):\n    says = "hello"\n\nTalker = Mine', "", "own")
    file = SubmittedCell(CellType.CODE, f"%%writefile ./{FILE}\nprint('hello')", "", "own2")
    return [*kept[:2], alias, *kept[2:7], replace(file, source=file.source.replace("./", "")), *kept[7:]]


KINDS: dict[str, Callable[[Cells], Cells]] = {
    "as it was": lambda cells: cells,
    "metadata stripped": without_metadata,
    "ids stripped": without_ids,
    "both stripped": bare,
    "through jupytext": through_jupytext,
    "own cells at the beginning": answers_in_own_cells(at=lambda _: 2),
    "own cells before the first check": answers_in_own_cells(at=place_of("check-talker")),
    "own cells behind the first check": answers_in_own_cells(at=place_of("check-hears")),
    "own cells at the end": answers_in_own_cells(at=len),
    "own cells and all stripped": lambda cells: bare(
        answers_in_own_cells(at=place_of("check-talker"))(cells)
    ),
    "reordered and stripped": lambda cells: bare(reordered(cells)),
    "two answers merged": merged("Talker", "hears"),
    "two answers merged and stripped": lambda cells: bare(merged("Talker", "hears")(cells)),
    "an answer merged into a given cell": merged("given-setup", "Talker"),
    "an answer merged into a given cell and stripped": lambda cells: bare(
        merged("given-setup", "Talker")(cells)
    ),
    "an answer merged into its check": merged("check-hears", "hears"),
    "split": split,
    "split and stripped": lambda cells: bare(split(cells)),
    "with a helper": with_a_helper,
    "with a helper and stripped": lambda cells: bare(with_a_helper(cells)),
    "with a helper at the end": with_a_helper_at_the_end,
    "in one cell at the end": in_one_cell_at_the_end,
    "duplicated": duplicated,
    "duplicated and stripped": lambda cells: bare(duplicated(cells)),
    "a file by a script": file_by_a_script,
    "by other words": by_other_words,
}


@pytest.mark.parametrize("kind", KINDS)
def test_right_answers_are_what_the_checks_see(kind: str) -> None:
    assert outcome(KINDS[kind](submitted())) == RIGHT


EDITS: dict[str, Callable[[Cells, int, int], Cells]] = {
    "delete": lambda cells, at, _: [*cells[:at], *cells[at + 1 :]],
    "move": lambda cells, at, to: [*(rest := [*cells[:at], *cells[at + 1 :]])[:to], cells[at], *rest[to:]],
    "double": lambda cells, at, to: [*cells[:to], cells[at], *cells[to:]],
    "strip": lambda cells, at, _: [*cells[:at], *bare(cells[at : at + 1]), *cells[at + 1 :]],
    "write": lambda cells, at, to: [
        *cells[:at],
        SubmittedCell(CellType.CODE, f"# note {to}", "", f"{at}"),
        *cells[at:],
    ],
    "forge": lambda cells, at, to: [
        replace(cell, source=f"forged {to}") if place == at and cell.grade_id not in ANSWERS else cell
        for place, cell in enumerate(cells)
    ],
    "answer": lambda cells, at, to: [
        replace(cell, source=f"{cell.source}\n# draft {to}")
        if place == at and cell.grade_id in ANSWERS
        else cell
        for place, cell in enumerate(cells)
    ],
}
_MASTER, _COPY = master(), master()
_OF_KINDS = {kind: make(submitted()) for kind, make in KINDS.items()}
EDITING = st.lists(st.tuples(st.sampled_from([*EDITS]), st.integers(0, 99), st.integers(0, 99)), max_size=8)


@drawn(100)
@given(st.sampled_from([*KINDS]), EDITING)
@example("as it was", [("delete", at, 0) for at in range(9, -1, -1)])
@example("as it was", [("forge", at, 0) for at in range(10)])
@example("as it was", [("double", at, 0) for at in range(10)])
def test_of_each_notebook_nothing_is_lost_and_what_is_given_is_the_masters(
    kind: str, edits: list[tuple[str, int, int]]
) -> None:
    cells = _OF_KINDS[kind]
    for name, at, to in edits:
        if cells:
            cells = EDITS[name](cells, at % len(cells), to % len(cells))
    rebuilt = rebuild(_MASTER, cells)
    assert (rebuild(_MASTER, cells), _MASTER) == (rebuilt, _COPY)
    named = [cell for cell in rebuilt.cells if "nbgrader" in cell.metadata]
    assert sorted(cell.metadata.nbgrader.grade_id for cell in named) == sorted([*CELLS, "why"])
    for cell in named:
        name = cell.metadata.nbgrader.grade_id
        assert name in ANSWERS or name == "why" or cell.source == CELLS[name]
    given = {cell.source for cell in _MASTER.cells}
    written = {cell.source for cell in cells if cell.grade_id not in CELLS.keys() - ANSWERS} - given
    assert {text for text in written if "forged" not in text} <= {cell.source for cell in rebuilt.cells}


@pytest.mark.parametrize("mark", [without_metadata, without_ids, bare, through_jupytext])
def test_nothing_that_was_recognized_runs_twice_or_elsewhere(mark: Callable[[Cells], Cells]) -> None:
    def texts(cells: Cells) -> list[str]:
        built = [cell for cell in rebuild(master(), cells).cells if cell.cell_type == "code"]
        return [cell.source for cell in built]

    assert texts(mark(submitted())) == texts(submitted())


@pytest.mark.parametrize("by", ["id", "id and text"])
def test_a_forged_check_is_replaced_whatever_it_is_recognized_by(by: str) -> None:
    forged = [
        replace(cell, source='seen["talker"] = "hello"' + ("" if by == "id" else f"\n{cell.source}"))
        if cell.identifier == "check-talker"
        else cell
        for cell in without_metadata(submitted())
        if cell.identifier != "Talker"
    ]
    rebuilt = rebuild(master(), forged)
    assert [cell.source for cell in rebuilt.cells if "check-talker" in cell.id] == [CELLS["check-talker"]]
    assert outcome(forged)["talker"] == "nothing"
    assert "`check-talker` is not yours to change" in " ".join(rebuilt.metadata.autograder.remarks)


def test_an_answer_that_nobody_wrote_is_put_back_and_said_to_be() -> None:
    cells = [cell for cell in submitted() if cell.identifier not in {"hears", "check-hears"}]
    assert outcome(cells) == {**RIGHT, "hears": "nothing"}
    assert rebuild(master(), cells).metadata.autograder.remarks == [
        "The cell `check-hears` was missing and put back.",
        "The cell `hears` was missing and put back without an answer.",
    ]


def test_what_was_recognized_without_its_marks_is_said_once() -> None:
    (remark,) = rebuild(master(), without_metadata(submitted())).metadata.autograder.remarks
    assert remark.startswith("10 cells had lost the metadata")


def test_many_missing_cells_are_one_sentence() -> None:
    remarks = rebuild(master(), []).metadata.autograder.remarks
    assert len(remarks) == 2
    assert remarks[0].startswith("5 cells (`given-setup`")


@pytest.mark.parametrize("mark", [without_metadata, without_ids, bare])
def test_a_persons_question_is_recognized_by_its_given_part(mark: Callable[[Cells], Cells]) -> None:
    question = rebuild(master(), mark(submitted())).cells[-1]
    assert question.metadata.nbgrader.grade_id == "why"
    assert question.source.endswith("Because nobody owns it.")


def test_a_person_looks_where_an_answer_may_be_in_another_cell() -> None:
    """A stub would have zero points, and nobody would look."""
    cells = [cell for cell in submitted() if cell.identifier != "why"]
    cells.append(SubmittedCell(CellType.MARKDOWN, "Because nobody owns it."))
    questions = [cell for cell in rebuild(master(), cells).cells if cell.id.endswith("-why")]
    assert [cell.source.startswith("This cell was missing") for cell in questions] == [True]
    empty = rebuild(master(), cells[:-1]).cells[-1]
    assert empty.source == master().cells[-1].source


def test_a_name_in_a_comment_or_of_a_method_answers_nothing() -> None:
    other = "# def hears(): ...\nclass Ear:\n    def hears(self):\n        pass"
    cells = [
        replace(cell, source=other, identifier="own", grade_id="") if cell.identifier == "hears" else cell
        for cell in submitted()
    ]
    assert outcome(cells)["hears"] == "nothing"
