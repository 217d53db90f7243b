from __future__ import annotations

import nbformat
import pytest
from nbformat import NotebookNode

from autograder.execution.executed_cells import CellType
from autograder.grading.rebuilding.notebook_rebuilding import rebuild, rebuild_unreadable
from autograder.grading.rebuilding.submitted_notebook import SubmittedCell
from autograder.grading.tasks.task_making import cells_of
from tests.cases import cases


def master_cell(
    name: str, source: str, *, kind: str = "code", solution: bool = False, grade: bool = False
) -> NotebookNode:
    cell = nbformat.v4.new_markdown_cell(source) if kind == "markdown" else nbformat.v4.new_code_cell(source)
    if name:
        cell.metadata["nbgrader"] = {
            "grade_id": name,
            "solution": solution,
            "grade": grade,
            "locked": not solution,
        }
    return cell


@pytest.fixture
def master() -> NotebookNode:
    return nbformat.v4.new_notebook(
        cells=[
            master_cell("", "# Title", kind="markdown"),
            master_cell("setup", "import rclpy"),
            master_cell("Talker", "# TODO", solution=True),
            master_cell("check-talker", "check(Talker)", grade=True),
            master_cell("Listener", "# TODO too", solution=True),
            master_cell("check-listener", "check(Listener)", grade=True),
        ]
    )


def as_submitted(master: NotebookNode, **answers: str) -> list[SubmittedCell]:
    cells = []
    for cell in master.cells:
        name = cell.metadata.get("nbgrader", {}).get("grade_id", "")
        cells.append(SubmittedCell(CellType(cell.cell_type), answers.get(name, cell.source), name))
    return cells


def sources(notebook: NotebookNode) -> list[str]:
    return [cell.source for cell in notebook.cells]


ANSWERS = {"Talker": "class Talker: ...", "Listener": "class Listener: ..."}
WHOLE = [*cases(__file__, "WHOLE")]


def test_an_honest_submission_comes_back_as_it_is_without_remarks(master: NotebookNode) -> None:
    rebuilt = rebuild(master, as_submitted(master, **ANSWERS))
    assert sources(rebuilt) == WHOLE
    assert rebuilt.metadata.autograder.remarks == []


def test_a_deleted_check_cell_is_put_back_behind_the_students_own_cells(master: NotebookNode) -> None:
    cells = [cell for cell in as_submitted(master, **ANSWERS) if cell.grade_id != "check-talker"]
    cells.insert(3, SubmittedCell(CellType.CODE, "helper = 1"))
    rebuilt = rebuild(master, cells)
    found = sources(rebuilt)
    assert found.index("helper = 1") < found.index("check(Talker)") < found.index("class Listener: ...")
    assert "`check-talker` was missing" in " ".join(rebuilt.metadata.autograder.remarks)


def test_of_a_duplicated_answer_the_last_changed_one_counts_and_all_run(master: NotebookNode) -> None:
    cells = as_submitted(master, **ANSWERS)
    cells[2:3] = [
        SubmittedCell(CellType.CODE, "class Talker: 'first try'", "Talker"),
        SubmittedCell(CellType.CODE, "class Talker: 'second try'", "Talker"),
        SubmittedCell(CellType.CODE, "# TODO", "Talker"),
    ]
    rebuilt = rebuild(master, cells)
    named = {
        cell.metadata.nbgrader.grade_id: cell.source for cell in rebuilt.cells if "nbgrader" in cell.metadata
    }
    assert named["Talker"] == "class Talker: 'second try'"
    assert "class Talker: 'first try'" in sources(rebuilt)
    assert "3 times" in " ".join(rebuilt.metadata.autograder.remarks)


def test_a_copy_behind_its_check_is_an_experiment_and_stays_there(master: NotebookNode) -> None:
    cells = as_submitted(master, **ANSWERS)
    copy = SubmittedCell(CellType.CODE, "class Talker: 'an experiment'", "Talker")
    cells += [copy, SubmittedCell(CellType.CODE, "while True: ...")]
    assert sources(rebuild(master, cells))[1:] == [*WHOLE, copy.source, "while True: ..."]


def test_a_copy_with_a_copy_of_its_check_behind_it_counts(master: NotebookNode) -> None:
    cells = as_submitted(master, **ANSWERS)
    cells.append(SubmittedCell(CellType.CODE, "class Talker: 'better'", "Talker"))
    cells.append(SubmittedCell(CellType.CODE, "check(Talker)", "check-talker"))
    found = sources(rebuild(master, cells))
    assert found.index("class Talker: 'better'") < found.index("check(Talker)")


def test_an_answer_that_is_only_behind_its_check_counts(master: NotebookNode) -> None:
    cells = as_submitted(master, **ANSWERS)
    cells.append(cells.pop(2))
    found = sources(rebuild(master, cells))
    assert found.index("class Talker: ...") < found.index("check(Talker)")


def test_cells_that_changed_places_are_in_order_again_with_their_neighbours(master: NotebookNode) -> None:
    cells = as_submitted(master, **ANSWERS)
    cells = [*cells[4:], SubmittedCell(CellType.CODE, "after listener's check"), *cells[:4]]
    rebuilt = rebuild(master, cells)
    found = [source for source in sources(rebuilt) if source in WHOLE[1:]]
    assert found == WHOLE[1:]
    assert "changed places" in " ".join(rebuilt.metadata.autograder.remarks)


@pytest.mark.parametrize("kind", [CellType.MARKDOWN, CellType.RAW])
def test_a_retyped_answer_is_code_again(master: NotebookNode, kind: CellType) -> None:
    cells = as_submitted(master, **ANSWERS)
    cells[2] = SubmittedCell(kind, "class Talker: ...", "Talker")
    rebuilt = rebuild(master, cells)
    assert [cell.cell_type for cell in rebuilt.cells if cell.source == "class Talker: ..."] == ["code"]
    assert f"had become a {kind} cell" in " ".join(rebuilt.metadata.autograder.remarks)


def test_a_cell_that_claims_a_name_nobody_gave_is_the_students_own(master: NotebookNode) -> None:
    cells = [*as_submitted(master, **ANSWERS), SubmittedCell(CellType.CODE, "99", "bonus")]
    rebuilt = rebuild(master, cells)
    assert "nbgrader" not in rebuilt.cells[-1].metadata
    assert "no graded cell `bonus`" in " ".join(rebuilt.metadata.autograder.remarks)


def test_an_unreadable_submission_is_the_master_with_the_reason(master: NotebookNode) -> None:
    rebuilt = rebuild_unreadable(master, "It is not JSON.")
    assert "It is not JSON." in rebuilt.cells[0].source
    assert sources(rebuilt)[1:] == sources(master)


def test_a_remark_cannot_carry_markup(master: NotebookNode) -> None:
    cells = [*as_submitted(master), SubmittedCell(CellType.CODE, "1", "<script>alert(1)</script>")]
    text = rebuild(master, cells).cells[0].source
    assert "<script" not in text
    assert "<img" not in rebuild_unreadable(master, "<img src=x onerror=alert(1)>").cells[0].source


def test_the_same_submission_gives_the_same_bytes_and_a_valid_notebook(master: NotebookNode) -> None:
    cells = [*as_submitted(master, **ANSWERS), SubmittedCell(CellType.RAW, "notes")]
    first, second = (nbformat.writes(rebuild(master, cells)) for _ in range(2))
    assert first == second
    nbformat.validate(nbformat.reads(first, as_version=4))


def test_the_courses_own_prose_is_nobodys_work_where_its_cells_are_not_locked(master: NotebookNode) -> None:
    del master.cells[1:]
    texts = ("# Title", "# Title, and my notes")
    submitted = [SubmittedCell(kind, text) for kind in (CellType.MARKDOWN, CellType.CODE) for text in texts]
    submitted.append(SubmittedCell(CellType.MARKDOWN, "# Title"))
    cells = cells_of(rebuild(master, submitted), prose=["# Title"])
    assert [(cell.kind, cell.source) for cell in cells if cell.own] == [
        (CellType.MARKDOWN, "# Title, and my notes"),
        (CellType.CODE, "# Title"),
        (CellType.CODE, "# Title, and my notes"),
        (CellType.MARKDOWN, "# Title"),  # the second one is a copy
    ]
