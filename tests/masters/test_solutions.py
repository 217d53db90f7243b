"""The reference solution of an exercise, taken out of its master: to be read with its reason, and as a program."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.masters.master_files import MasterError
from autograder.masters.reference_solutions import reference_source, solution_files
from autograder.masters.source_notebooks import Points, named_cells
from tests.cases import cases, named_cases

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).resolve().parents[2]
LAB = cases(__file__, "LAB")
PROGRAM = cases(__file__, "PROGRAM")


def made(folder: Path, why: str | None) -> dict[str, dict[str, object]]:
    master = folder / "lab_9_1" / "lab.md"
    master.parent.mkdir()
    head = (ROOT / "solutions/01_ros2_fundamentals/lab_1_2/lab.md").read_text().partition("# Lab")[0]
    master.write_text(head + LAB)
    if why is not None:
        master.with_name("half.why.md").write_text(why)
    files = solution_files(master, named_cells(master, points=lambda _: 10))
    return {path.name: json.loads(text) for path, text in files.items()}


def test_it_has_the_cells_since_the_check_before_and_the_reason(tmp_path: Path) -> None:
    why = "Whole numbers\nstay whole.\n\n## Another way\n\nAs a shift:\n\n```python\nnumber >> 1\n```\n"
    assert made(tmp_path, why) == {
        "half.solution.json": {
            "exercise": "lab_9_1.half",
            "code": ['def half(number: int) -> int:\n    """Half the number."""\n    return number // 2'],
            "why": "Whole numbers stay whole.",
            "other_way": "As a shift:",
            "other_code": "number >> 1",
        }
    }


def test_a_repair_has_the_broken_code_and_needs_no_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    todo = "    # TODO: return half the number."
    assert todo in LAB
    broken = f"{todo}\n    #- return 2 * number"
    monkeypatch.setitem(globals(), "LAB", LAB.replace(todo, broken))
    ((name, fields),) = made(tmp_path, None).items()
    assert name == "half.solution.json"
    head = 'def half(number: int) -> int:\n    """Half the number."""\n'
    assert fields == {
        "exercise": "lab_9_1.half",
        "code": [f"{head}    return number // 2"],
        "broken": [f"{head}{todo}\n    return 2 * number"],
    }


def test_an_exercise_without_a_reason_has_none(tmp_path: Path) -> None:
    assert made(tmp_path, None) == {}


@pytest.mark.parametrize("why", named_cases(__file__, "a_reason_of_another_form_is_refused"))
def test_a_reason_of_another_form_is_refused(tmp_path: Path, why: str) -> None:
    with pytest.raises(MasterError, match=r"half\.why\.md"):
        made(tmp_path, why)


def test_it_defines_the_subject_and_demonstrates_nothing(
    write_master: Callable[[str], Path], ten_points: Points, capsys: pytest.CaptureFixture[str]
) -> None:
    reference = reference_source(write_master(PROGRAM), "lab_9_1.double", points=ten_points)
    namespace: dict[str, object] = {}
    exec(reference.source, namespace)
    assert reference.subject == "double"
    assert namespace["double"](21) == 42  # type: ignore[operator]
    assert "math" in namespace
    assert namespace["HALF"] == 0.5
    assert "noise" not in reference.source
    assert "mood" not in reference.source
    assert "later" not in reference.source
    assert capsys.readouterr().out == ""


def test_a_changed_solution_changes_it(write_master: Callable[[str], Path], ten_points: Points) -> None:
    path = write_master(PROGRAM.replace("2 * number", "3 * number"))
    assert "3 * number" in reference_source(path, "lab_9_1.double", points=ten_points).source


def test_its_own_cells_are_those_since_the_check_before(
    write_master: Callable[[str], Path], ten_points: Points
) -> None:
    (own,) = reference_source(write_master(LAB), "lab_9_1.half", points=ten_points).own
    assert own.startswith("def half")


def test_an_exercise_that_is_not_checked(write_master: Callable[[str], Path], ten_points: Points) -> None:
    with pytest.raises(MasterError, match=r"No cell checks 'lab_9_1\.triple'"):
        reference_source(write_master(PROGRAM), "lab_9_1.triple", points=ten_points)
