"""A kernel has a desk of its own: code that takes the desk over decides only what is said of this one notebook."""

from __future__ import annotations

import contextlib
import os
import signal
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import pytest

from autograder.boxes.fork_server import INSIDE, ForkServer
from autograder.boxes.run_limits import Ended, Limits
from autograder.execution.executed_cells import Cell, CellCheck, Execution, NotebookOutputs
from autograder.execution.kernel_desk_messages import admitted_answer
from autograder.execution.notebook_processes import BoxedProcesses, NotebookSetting, UnboxedProcesses
from autograder.execution.notebook_runner import run_notebook
from autograder.safe_files import scratch_folder
from autograder.verdict import State, Verdict
from tests.boxes.reach import mutated
from tests.execution.hostile_kernel_desk import CRAFTED, SCRIPT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.boxes.boxed_processes import ForkedProcess
    from autograder.boxes.fork_server import Addresses
    from autograder.execution.kernel_channels import Channels

ROOT = Path(__file__).resolve().parents[2]
CHECK = Cell("1", check=CellCheck("lab.one", "One", points=10, worth=10, limit=2))
PASSED = Verdict("lab.one", "One", State.PASSED, 7.0, 10.0)
FAILS = [
    *("crafted 1", "crafted 11", "crafted 13", "at_random 1", "endless_answer", "memory", "crash", "leave"),
]
"""The acts of a desk that end its kernel."""


@pytest.fixture(scope="module")
def hostile(boxed: Addresses, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Addresses]:
    """Fork servers with a program of desks that a notebook can choose."""
    address = tmp_path_factory.mktemp("f") / "k"
    server = ForkServer(
        INSIDE, "tests.execution.hostile_kernel_desk", address, extra={"PYTHONPATH": str(ROOT)}
    )
    yield replace(boxed, kernels=server.address)
    server.stop()


class SayingJudge:
    def open(self, exercise_id: str) -> None: ...

    def close(self) -> Verdict | None:
        return PASSED


def run(
    addresses: Addresses, folder: Path, *cells: Cell | str, boxed: bool = True, **changed: Any
) -> Execution:
    limits = Limits(**{"interrupt_grace": 1.0, "notebook_output_bytes": 300_000, **changed})
    kind = BoxedProcesses if boxed else UnboxedProcesses
    with (
        scratch_folder(folder) as made,
        kind(addresses, NotebookSetting(made, limits)) as place,
    ):
        return run_notebook(
            [Cell(cell) if isinstance(cell, str) else cell for cell in cells],
            judge=contextlib.nullcontext(SayingJudge()),
            processes=place,
        )


def honest(addresses: Addresses, folder: Path) -> Any:
    """Everything that another student gets, but for the seconds."""
    execution = run(addresses, folder, "print('hello')", "1 + 1", CHECK)
    cells = [replace(cell, seconds=0.0) for cell in execution.cells]
    return cells, execution.verdicts, execution.trouble


@pytest.mark.parametrize("act", FAILS)
def test_a_desk_that_says_what_is_impossible_ends_with_its_own_kernel(
    hostile: Addresses, tmp_path: Path, act: str
) -> None:
    execution = run(hostile, tmp_path, f"# hostile: {act}", "print('x')", CHECK)
    assert execution.trouble == ""
    ended = [cell.ended for cell in execution.cells]
    assert ended[1:] in ([Ended.NOT_RUN] * 2, [Ended.TOO_MUCH_OUTPUT, Ended.NOT_RUN])
    assert ended[0] in (Ended.DONE, Ended.TOO_MUCH_OUTPUT)
    verdict = execution.verdicts[2]
    assert (verdict.score, verdict.diagnosis and verdict.diagnosis.key) == (0, "too_much_output")


def test_a_desk_that_answers_twice_ends_with_its_own_kernel(hostile: Addresses, tmp_path: Path) -> None:
    execution = run(hostile, tmp_path, "# hostile: twice", "print('x')", CHECK)
    assert execution.cells[2].ended is Ended.NOT_RUN
    assert execution.trouble == ""


@pytest.mark.parametrize("act", ["late", "endless"])
def test_a_desk_that_does_not_answer_costs_the_time_of_its_cell(
    hostile: Addresses, tmp_path: Path, act: str
) -> None:
    execution = run(hostile, tmp_path, f"# hostile: {act}", CHECK, cell_seconds=1.0)
    assert [cell.ended for cell in execution.cells] == [Ended.TIMED_OUT, Ended.NOT_RUN]


def test_a_desk_that_uses_up_its_processor_time_is_no_trouble_of_the_grader(
    hostile: Addresses, tmp_path: Path
) -> None:
    execution = run(hostile, tmp_path, "# hostile: endless", CHECK, cpu_seconds=2.0)
    assert [cell.ended for cell in execution.cells] == [Ended.TOO_MUCH_OUTPUT, Ended.NOT_RUN]
    assert execution.trouble == ""


def test_script_in_every_text_is_text(hostile: Addresses, tmp_path: Path) -> None:
    execution = run(hostile, tmp_path, "# hostile: script", "x = 1")
    kinds = [output["output_type"] for output in execution.cells[0].outputs]
    assert kinds == ["stream", "display_data", "error"]
    assert execution.cells[0].outputs[1]["data"] == {"text/plain": SCRIPT}


def test_more_outputs_than_a_desk_may_keep_are_cut(hostile: Addresses, tmp_path: Path) -> None:
    execution = run(hostile, tmp_path, "# hostile: too_many_outputs", "x = 1")
    assert 1_000 < len(execution.cells[0].outputs) < 10_000


@pytest.mark.parametrize("in_a_box", [True, False])
def test_a_desk_reaches_nothing_not_even_without_a_box(
    hostile: Addresses, tmp_path: Path, in_a_box: bool
) -> None:
    execution = run(hostile, tmp_path, "# hostile: reach", boxed=in_a_box)
    assert execution.cells[0].outputs[0]["text"] == "reached: ."


def test_a_desk_that_the_system_has_killed_is_the_graders_trouble(boxed: Addresses, tmp_path: Path) -> None:
    class Killed(BoxedProcesses):
        def start_desk(self, channels: Channels) -> ForkedProcess:
            self.desk = super().start_desk(channels)
            return self.desk

    class KillingJudge(SayingJudge):
        def open(self, exercise_id: str) -> None:
            os.kill(place.desk.pid, signal.SIGKILL)

    with (
        scratch_folder(tmp_path) as folder,
        Killed(boxed, NotebookSetting(folder, Limits())) as place,
    ):
        judge = contextlib.nullcontext(KillingJudge())
        execution = run_notebook([CHECK], judge=judge, processes=place)
    assert "is gone" in execution.trouble
    assert execution.verdicts[0].state is State.NOT_CHECKED


def test_verdicts_and_other_students_are_out_of_its_reach(hostile: Addresses, tmp_path: Path) -> None:
    before = honest(hostile, tmp_path)
    assert before[1] == {2: PASSED}
    for act in ("endless_answer", "crash", "crafted 11", "script", "reach", "late"):
        judged = replace(CHECK, source=f"# hostile: {act}")
        execution = run(hostile, tmp_path, judged, check_margin=0.0)
        stopped = execution.cells[0].ended
        assert execution.verdicts[0] == PASSED, (act, stopped)
    assert honest(hostile, tmp_path) == before


@pytest.mark.parametrize("document", CRAFTED, ids=range(len(CRAFTED)))
def test_a_document_that_no_kernel_brings_about_is_refused(document: bytes) -> None:
    with pytest.raises(ValueError, match=r"."):
        admitted_answer(document, 1_000_000, range(1, 2), {0})


def test_ten_thousand_mutated_answers_are_refused_or_harmless() -> None:
    outputs = [
        {"output_type": "stream", "name": "stderr", "text": SCRIPT},
        {
            "output_type": "execute_result",
            "data": {"text/plain": "1"},
            "metadata": {},
            "execution_count": None,
        },
        {"output_type": "error", "ename": "E", "evalue": "e", "traceback": ["one", "two"]},
    ]
    whole = msgspec.json.encode({"number": 1, "said": "done", "outputs": {0: outputs}})
    refused = 0
    for document in mutated(whole, 10_000):
        try:
            answer = admitted_answer(document, 1_000_000, range(1, 2), {0})
        except ValueError:
            refused += 1
            continue
        kept = NotebookOutputs(1, 1_000, 1_000)
        for said in answer.outputs.values():
            kept.put(0, msgspec.to_builtins(said))
        assert len(str(kept.of(0))) < 3_000
    assert 5_000 < refused < 10_000
