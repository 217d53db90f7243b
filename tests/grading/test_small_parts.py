"""Seeds, names, points, CSV."""

from __future__ import annotations

import errno
import re
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import Cell, CellCheck, CellRun, Execution
from autograder.grading.classes.class_secret import create_secret, read_secret
from autograder.grading.grading_errors import DiskFull, NotAClass, is_disk_full
from autograder.grading.grading_task import Task, points
from autograder.grading.new_classes.new_class import NewClass
from autograder.grading.tasks.task_making import seed_for
from autograder.safe_files import write_whole
from autograder.verdict import State, Verdict

CHECK = CellCheck("lab.one", "One", points=10, worth=4, limit=2)
TASK = Task("ada", "lab", "lab", (Cell("1"), Cell("check()", check=CHECK, name="lab-one")), "seed", "v1")


def verdict(score: float, most: float = 10) -> Verdict:
    return Verdict("lab.one", "One", State.FAILED, score, most)


DONE = Execution(
    (CellRun(Ended.DONE, ({"output_type": "stream", "name": "stdout", "text": "ü"},)),), {1: verdict(5)}
)


def test_a_task_and_an_execution_travel_as_json() -> None:
    task = replace(TASK, files={"map.png": b"\x00\xff"})
    assert msgspec.json.decode(msgspec.json.encode(task), type=Task) == task
    assert msgspec.json.decode(msgspec.json.encode(DONE), type=Execution) == DONE
    assert b"\n" not in msgspec.json.encode(replace(TASK, cells=(Cell("a\nb"),)))


def test_a_file_is_replaced_whole_or_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "grades.csv"
    write_whole(path, b"old")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", full)
        with pytest.raises(OSError, match="No space"):
            write_whole(path, b"new")
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["grades.csv"]


def test_a_full_disk_is_found_at_the_bottom_of_a_chain() -> None:
    failed = RuntimeError("nbgrader failed")
    failed.__cause__ = OSError(errno.EDQUOT, "quota")
    assert is_disk_full(failed)
    assert not is_disk_full(ValueError("disk is full, says the student"))
    assert "Free some space" in str(DiskFull(Path("class")))


def test_the_score_is_the_judges_share_of_what_the_cell_carries() -> None:
    assert points(CHECK, verdict(10)) == 4
    assert points(CHECK, verdict(2.5)) == 1
    assert points(CHECK, verdict(0)) == 0


@pytest.mark.parametrize("score", [1e9, -3, float("nan"), float("inf")])
def test_no_verdict_is_worth_more_than_the_cell_or_less_than_nothing(score: float) -> None:
    assert 0 <= points(CHECK, verdict(score)) <= 4
    assert points(CHECK, verdict(5, most=0)) == 0


def test_a_seed_is_a_secret_and_never_shared(tmp_path: Path) -> None:
    create_secret(tmp_path / "secret")
    secret = read_secret(tmp_path / "secret")
    seeds = {
        seed_for(secret, *names)
        for names in [
            ("ada", "lab", "lab", "work"),
            ("ben", "lab", "lab", "work"),
            ("ad", "alab", "lab", "work"),
            ("ada", "lab", "two", "work"),
            ("ada", "lab", "lab", "other work"),
        ]
    }
    assert len(seeds) == 5
    assert seed_for(secret, "ada", "lab", "lab", "work") in seeds
    assert seed_for(b"x" * 32, "ada", "lab", "lab", "work") not in seeds
    with pytest.raises(FileExistsError):
        create_secret(tmp_path / "secret")
    (tmp_path / "secret").write_text("00ff")
    with pytest.raises(ValueError, match="32 bytes"):
        read_secret(tmp_path / "secret")


def test_a_class_without_new_work_waits_for_no_import_of_nbgrader() -> None:
    asked = "import sys, autograder.grading.batch; print(*{'nbgrader', 'jupytext', 'nbconvert'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_a_printed_command_can_be_typed_for_a_class_in_a_folder_with_blanks() -> None:
    path = Path("/classes/Ada's robots 2026")
    missing = str(NotAClass(path, "no gradebook")).rpartition(": ")[2]
    assert shlex.split(missing) == ["./course", "new-class", str(path)]
    made = NewClass(path, (), "UTC").summary()[-1].removeprefix("Then ")
    assert shlex.split(made) == ["./course", "grade", str(path)]


def test_no_message_puts_a_path_into_a_command_by_itself() -> None:
    grading = Path(sys.modules[NotAClass.__module__].__file__ or "").parent
    by_hand = [
        file.name for file in grading.rglob("*.py") if re.search(r"\./course [a-z-]+ \{", file.read_text())
    ]
    assert not by_hand
