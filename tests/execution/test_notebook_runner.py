"""Notebooks in a real kernel, with a judge that says what the test wants."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import psutil
import pytest

from autograder.boxes.box_connection import NoSandbox
from autograder.boxes.fork_server import Addresses
from autograder.boxes.run_limits import Ended, Left, Limits, Patient, wall_time
from autograder.execution.executed_cells import Cell, CellCheck, CellType, Execution
from autograder.execution.notebook_processes import BoxedProcesses, NotebookSetting, UnboxedProcesses
from autograder.execution.notebook_runner import Unfinished, run_notebook
from autograder.grading.rebuilding.submitted_notebook import MAX_CELL_CHARACTERS
from autograder.safe_files import scratch_folder
from autograder.verdict import Diagnosis, State, Verdict, failed
from tests.cases import cases

if TYPE_CHECKING:
    from autograder.execution.kernel_channels import Channels

CHECK = CellCheck("lab.one", "One", points=10, worth=10, limit=2)


class SayingJudge:
    """Says what it was told to say, whatever happens."""

    def __init__(self, says: Verdict | Exception | None) -> None:
        self._says = says
        self.asked: list[str] = []

    def open(self, exercise_id: str) -> None:
        self.asked.append(exercise_id)

    def close(self) -> Verdict | None:
        if isinstance(self._says, Exception):
            raise self._says
        return self._says


Run = Callable[..., Execution]


BOTH = pytest.mark.parametrize("run", ["in a box", "beside one"], indirect=True)
"""For what depends on how a kernel's process is made; all else is the same code, and is asked in a box."""


@pytest.fixture
def run(request: pytest.FixtureRequest, tmp_path: Path, boxed: Addresses, unboxed: Addresses) -> Run:
    is_boxed = getattr(request, "param", "in a box") == "in a box"
    addresses, kind = (boxed, BoxedProcesses) if is_boxed else (unboxed, UnboxedProcesses)

    def go(
        cells: Sequence[Cell | str],
        says: Verdict | Exception | None = None,
        patient: Patient = wall_time,
        **limits: float,
    ) -> Execution:
        @contextlib.contextmanager
        def judge() -> Iterator[SayingJudge]:
            yield SayingJudge(says)

        with (
            scratch_folder(tmp_path) as folder,
            kind(addresses, NotebookSetting(folder, Limits(**limits))) as place,  # type: ignore[arg-type]
        ):
            return run_notebook(
                [Cell(cell) if isinstance(cell, str) else cell for cell in cells],
                judge=judge(),
                processes=place,
                patient=patient,
            )

    return go


def passed(score: float = 10.0, exercise: str = "lab.one") -> Verdict:
    return Verdict(exercise, "One", State.PASSED, score, 10.0)


def check(source: str = "1") -> Cell:
    return Cell(source, check=CHECK, name="lab-one")


def key(execution: Execution, index: int = -1) -> str:
    verdicts = list(execution.verdicts.values())
    diagnosis = verdicts[index].diagnosis
    return diagnosis.key if diagnosis else ""


@BOTH
def test_only_the_judge_gives_points_whatever_cells_do_besides(run: Run) -> None:
    execution = run(
        [
            Cell("raise SystemExit", CellType.MARKDOWN),
            "import sys; print('[INFO] up', file=sys.stderr)",
            "sys.exit()",
            "input('name? ')",
            check("raise SystemError('but the judge has seen enough')"),
        ],
        passed(7),
    )
    ended = [cell.ended for cell in execution.cells]
    assert ended == [Ended.DONE, Ended.DONE, Ended.RAISED, Ended.RAISED, Ended.RAISED]
    assert execution.cells[1].outputs[0]["name"] == "stderr"
    assert "StdinNotImplementedError" in execution.cells[3].error
    assert execution.verdicts[4].score == 7
    assert execution.trouble == ""


def test_what_the_cell_says_is_worth_nothing(run: Run) -> None:
    execution = run([check("print(10.0); 10.0")])
    assert execution.verdicts[0].score == 0
    assert key(execution) == "not_asked"


def test_an_error_before_the_check_is_named_as_the_cause(run: Run) -> None:
    execution = run(["class Talker:\n    def", "print('on it goes')", check("check(Talker)")])
    verdict = execution.verdicts[2]
    assert key(execution) == "syntax_error"
    assert verdict.state is State.FAILED
    assert "class Talker:" in verdict.diagnosis.text  # type: ignore[union-attr]
    assert execution.cells[1].ended is Ended.DONE


def test_an_endless_loop_is_stopped_and_the_rest_still_runs(run: Run) -> None:
    execution = run(["while True:\n    pass", "print('alive')", check("talker")], cell_seconds=2.0)
    assert [cell.ended for cell in execution.cells[:2]] == [Ended.TIMED_OUT, Ended.DONE]
    assert key(execution) == "cell_timed_out"


@pytest.mark.parametrize("own", [True, False])
def test_a_judge_that_met_the_rest_of_an_endless_cell_says_so(run: Run, own: bool) -> None:
    seen = failed("lab.one", "One", 10.0, Diagnosis("never_published", "No message came.", "Write a timer."))
    execution = run([Cell("while True:\n    pass", own=own), check(), check()], seen, cell_seconds=2.0)
    assert key(execution, 0) == ("cell_timed_out" if own else "never_published")
    assert key(execution, 1) == "never_published", "the loop is before another check"


@BOTH
def test_a_loop_that_will_not_be_interrupted_costs_the_kernel(run: Run) -> None:
    stubborn = cases(__file__, "a_loop_that_will_not_be_interrupted_costs_the_kernel")
    execution = run([stubborn, check()], passed(), cell_seconds=0.5, interrupt_grace=0.5)
    assert [cell.ended for cell in execution.cells] == [Ended.TIMED_OUT, Ended.NOT_RUN]
    assert key(execution) == "notebook_timed_out"
    assert execution.verdicts[1].score == 0


@BOTH
@pytest.mark.parametrize("end", ["exit()", "import os; os._exit(0)", "import os; os.kill(os.getpid(), 9)"])
def test_a_kernel_that_ends_is_named_with_its_cell(run: Run, end: str) -> None:
    execution = run(["x = 1", end, check()], passed())
    assert [cell.ended for cell in execution.cells] == [Ended.DONE, Ended.KERNEL_DIED, Ended.NOT_RUN]
    assert key(execution) == "kernel_died"
    assert end in execution.verdicts[2].diagnosis.text  # type: ignore[union-attr]


def test_a_kernel_that_ends_in_one_check_is_named_in_the_next(run: Run) -> None:
    execution = run(["x = 1", check("exit()  # in a check"), check()])
    assert key(execution) == "kernel_died"
    assert "exit()  # in a check" in execution.verdicts[2].diagnosis.text  # type: ignore[union-attr]


def test_a_cells_seconds_last_as_long_as_the_machine_makes_them(run: Run) -> None:
    def crowded(seconds: float) -> Left:
        asked.append(seconds)
        return lambda: 1.0  # nobody had the processor, so none of it is used up

    asked: list[float] = []
    execution = run(["import time; time.sleep(0.5)", check()], passed(), patient=crowded, cell_seconds=0.01)
    assert [cell.ended for cell in execution.cells] == [Ended.DONE, Ended.DONE]
    assert asked == [0.01, CHECK.limit + Limits().check_margin]


def test_the_notebooks_limit_is_wall_time_however_crowded_the_machine_is(run: Run) -> None:
    cells = ["1", "import time; time.sleep(600)", "2", check()]
    execution = run(cells, passed(), patient=lambda _: lambda: 1.0, notebook_seconds=2.0)
    ended = [Ended.DONE, Ended.TIMED_OUT, Ended.NOT_RUN, Ended.NOT_RUN]
    assert [cell.ended for cell in execution.cells] == ended
    assert key(execution) == "notebook_timed_out"
    assert execution.verdicts[3].score == 0


def test_output_of_a_thread_is_not_lost(run: Run) -> None:
    thread = cases(__file__, "output_of_a_thread_is_not_lost")
    execution = run([thread, "go.set(); t.join(); print('now')"])
    texts = ["".join(o.get("text", "") for o in cell.outputs) for cell in execution.cells]
    assert "late" in "".join(texts)
    assert "now" in texts[1]


def test_a_message_larger_than_allowed_is_dropped_and_the_next_cell_is_heard(run: Run) -> None:
    execution = run(["print('x' * 3_000_000)", "print('small')"], message_bytes=1_000_000)
    assert "too large" in execution.cells[0].outputs[0]["text"]
    assert execution.cells[1].outputs[0]["text"] == "small\n"


def test_a_cell_as_long_as_a_cell_may_be_is_run(run: Run) -> None:
    numbers = f"numbers = [{'1, ' * (MAX_CELL_CHARACTERS // 3 - 10)}]"
    execution = run([numbers, "print(len(numbers))"])
    assert [cell.ended for cell in execution.cells] == [Ended.DONE, Ended.DONE]
    assert "".join(str(output["text"]) for output in execution.cells[1].outputs) == "33323\n"


@BOTH
def test_no_process_of_the_notebook_survives(run: Run) -> None:
    token = f"600.{secrets.randbelow(10**12)}"
    execution = run(
        [
            f"import subprocess\nsubprocess.Popen(['sleep', '{token}'], start_new_session=True)",
            f"subprocess.run(['setsid', '--fork', 'sleep', '{token}'])",
            # setsid has ended before its child is called sleep.
            "while int(subprocess.run(['pgrep', '-fc', '^sleep'], capture_output=True).stdout) < 2: pass",
        ]
    )
    assert execution.cells[2].ended is Ended.DONE
    assert [p.pid for p in psutil.process_iter(["cmdline"]) if token in (p.info["cmdline"] or [])] == []


def test_a_judge_that_dies_is_the_graders_trouble(run: Run) -> None:
    execution = run([check(), "print('goes on')"], RuntimeError("the judge is gone"))
    verdict = execution.verdicts[0]
    assert verdict.state is State.NOT_CHECKED
    assert verdict.score == 0
    assert "the judge is gone" in execution.trouble
    assert execution.cells[1].ended is Ended.DONE


def test_a_cell_that_leaves_its_check_behind_gets_no_points(run: Run) -> None:
    execution = run([check("print('gone')")], Unfinished("the judge did not finish in time"))
    assert execution.trouble == ""
    assert key(execution) == "not_asked"


def test_a_check_that_lasts_as_long_as_its_cell_may_is_the_graders_trouble(run: Run) -> None:
    late = Unfinished("the judge did not finish in time")
    execution = run([check("import time; time.sleep(60)")], late, check_margin=0.0)
    assert execution.verdicts[0].state is State.NOT_CHECKED


def test_a_verdict_on_another_exercise_does_not_count(run: Run) -> None:
    execution = run([check()], passed(exercise="lab.easy"))
    assert execution.verdicts[0].state is State.NOT_CHECKED
    assert execution.verdicts[0].score == 0


def test_a_check_that_is_stopped_at_a_limit_earns_nothing_whatever_the_judge_had_seen(run: Run) -> None:
    flood = check("while True:\n    print('x' * 1000)")
    half = Verdict("lab.one", "One", State.FAILED, 5.0, 10.0)
    for says, score, why in ((half, 0.0, "too_much_output"), (passed(), 10.0, "")):
        execution = run([flood], says, flood_bytes=100_000)
        assert execution.cells[0].ended is Ended.TOO_MUCH_OUTPUT
        assert (execution.verdicts[0].score, key(execution)) == (score, why)


@BOTH
def test_the_kernel_knows_nothing_of_the_hosts_variables(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_TOKEN", "secret")
    execution = run(["import os; print(os.environ.get('COURSE_TOKEN'), os.environ['HOME'], os.getcwd())"])
    token, home, cwd = execution.cells[0].outputs[0]["text"].split()
    assert token == "None"
    assert home != os.environ.get("HOME")
    assert cwd != str(Path.cwd())


def test_a_kernel_that_cannot_start_is_the_graders_trouble(tmp_path: Path) -> None:
    nobody = Addresses("", str(tmp_path / "nobody"), "")
    place = UnboxedProcesses(nobody, NotebookSetting(tmp_path, Limits()))
    execution = run_notebook([check()], judge=contextlib.nullcontext(SayingJudge(passed())), processes=place)
    assert "could not be started" in execution.trouble
    assert execution.verdicts[0].state is State.NOT_CHECKED


def test_a_kernel_without_a_box_is_no_fault_of_the_judge(tmp_path: Path) -> None:
    class NoKernel(UnboxedProcesses):
        def start_kernel(self, channels: Channels) -> NoReturn:
            raise NoSandbox("no room for a box")

    place = NoKernel(Addresses("", "", ""), NotebookSetting(tmp_path, Limits()))
    execution = run_notebook([check()], judge=contextlib.nullcontext(SayingJudge(passed())), processes=place)
    assert execution.trouble == "the kernel could not be started: no room for a box"


@BOTH
def test_two_kernels_of_one_fork_server_have_nothing_in_common(run: Run) -> None:
    draw = cases(__file__, "two_kernels_of_one_fork_server_have_nothing_in_common")
    first, second = (run([draw]).cells[0].outputs[0]["text"].split() for _ in range(2))
    assert len(first) == 5
    assert [a for a, b in zip(first, second, strict=True) if a == b] == []


@BOTH
def test_a_kernel_begins_as_a_fresh_one_does(run: Run) -> None:
    look = cases(__file__, "a_kernel_begins_as_a_fresh_one_does")
    text = run([look]).cells[0].outputs[0]["text"].strip()
    # Programs that look at sys.argv meet in a cell of JupyterLab what its kernels were started with.
    assert text == "2 [] ['-f', 'kernel.json'] __main__ 0 []"


@BOTH
def test_a_crash_leaves_no_core(run: Run) -> None:
    crash = "import os, subprocess\nsubprocess.run(['sh', '-c', 'kill -SEGV $$'])\nprint(os.listdir('.'))"
    assert run([crash]).cells[0].outputs[0]["text"] == "[]\n"


@BOTH
def test_ros_works_in_a_kernel_and_among_its_children(run: Run) -> None:
    talk = cases(__file__, "ros_works_in_a_kernel_and_among_its_children")
    assert run([talk]).cells[0].outputs[0]["text"] == "x\n"
