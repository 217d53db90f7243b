"""Executes a rebuilt notebook cell by cell. The judge watches each check cell.

The notebook's output, errors and values decide nothing. The result of a check cell is what the judge reports after
the cell. Without a report, the result is zero points, with the reason.

If a student's function has an endless loop, each cell that uses the function hangs, and each would take its whole time
limit. So only the first such cell gets its full limit, later ones a short one. A function is blamed for a hang only if
the cell that hung is a cell of the master (which ends with every right answer) and uses nothing else that the student
defined. A check is never left out: if it reaches its verdict within the short limit, the verdict counts as usual.
"""

from __future__ import annotations

import contextlib
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import re2

from autograder.boxes.run_limits import Ended, Patient, first_of, wall_time
from autograder.execution.executed_cells import Cell, CellCheck, CellRun, CellType, Execution, NotebookOutputs
from autograder.execution.jupyter_kernel import Kernel, KernelFailed
from autograder.execution.verdicts_without_judge import (
    LIMITS,
    grader_trouble,
    verdict_by_tests,
    with_endless_cell,
    without_verdict,
)
from autograder.verdict import State, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from autograder.boxes.run_limits import Limits
    from autograder.execution.notebook_processes import NotebookProcesses


class Unfinished(RuntimeError):
    """The judge did not finish the check within its time limit."""


class Judge(Protocol):
    """The methods of the judge that this module uses."""

    def open(self, exercise_id: str) -> None:
        """Allow a check of this exercise from now on."""
        ...

    def close(self) -> Verdict | None:
        """End the exercise's check. Return the verdict; None if no check was requested.

        Raises:
            Unfinished: The check was not finished. Any other exception also means that the judge failed.
        """
        ...


def run_notebook(
    cells: Sequence[Cell],
    *,
    judge: contextlib.AbstractContextManager[Judge],
    processes: NotebookProcesses,
    patient: Patient = wall_time,
) -> Execution:
    """Execute a notebook in a separate kernel.

    Args:
        cells: The cells of the rebuilt notebook.
        judge: The judge, a context manager. It starts while the kernel starts, and ends before this function returns.
        processes: Starts the processes of the kernel and its desk, within the notebook's limits.
        patient: Turns a cell's time limit into a deadline, which may stretch while the machine is busy.

    Returns:
        The execution. Nothing in the notebook can make this function raise an error. If the grader itself fails,
        ``trouble`` says why, and the checks that this affects are "not checked".
    """
    began = time.monotonic()
    run = _Run(cells, processes.limits, patient)
    try:
        with (
            contextlib.closing(Kernel(processes, run.outputs)) as kernel,
            judge as ready,
        ):
            kernel.await_ready()
            start_seconds = time.monotonic() - began
            run.all_cells(kernel, ready)
            if kernel.lost:
                raise KernelFailed("the process that watches over the kernel is gone")
    except KernelFailed as error:
        return run.failed(str(error), time.monotonic() - began)
    except Exception as error:  # a judge that cannot start or end must not stop the whole batch
        return run.failed(f"the judge failed: {type(error).__name__}: {error}", time.monotonic() - began)
    return run.result(time.monotonic() - began, start_seconds)


class _Run:
    """The execution of a notebook, while it is in progress."""

    def __init__(self, cells: Sequence[Cell], limits: Limits, patient: Patient = wall_time) -> None:
        self._cells = cells
        self._patient = patient
        self._limits = limits
        self.outputs = NotebookOutputs(len(cells), limits.cell_output_bytes, limits.notebook_output_bytes)
        self._ended = [Ended.NOT_RUN for _ in cells]
        self._seconds = [0.0 for _ in cells]
        self._verdicts: dict[int, Verdict] = {}
        self._trouble = ""
        self._hangs = _Hangs.of(cells)
        self._allowed = [self._limit(cell) for cell in cells]
        self._hung_before: dict[int, tuple[str, str]] = {}

    def all_cells(self, kernel: Kernel, judge: Judge) -> None:
        """Run every cell that has to run, as long as the kernel is alive and time is left."""
        of_notebook = wall_time(self._limits.notebook_seconds)
        for index, cell in enumerate(self._cells):
            if cell.kind is not CellType.CODE:
                self._ended[index] = Ended.DONE
                continue
            if not kernel.alive or of_notebook() <= 0:
                continue
            with self._watched(index, cell, judge):
                began = time.monotonic()
                if (before := self._hangs.before(cell)) is not None:
                    self._hung_before[index] = before
                    self._allowed[index] = _seconds_again(cell, self._allowed[index], self._limits)
                of_cell = self._patient(self._allowed[index])
                self._ended[index] = kernel.execute(index, cell.source, first_of(of_cell, of_notebook))
                self._seconds[index] = time.monotonic() - began
                if self._ended[index] is Ended.TIMED_OUT:
                    self._hangs.note(cell, _title(cell))

    def result(self, seconds: float, start_seconds: float) -> Execution:
        """Return the execution, with a verdict for every check cell."""
        runs = [self._cell_run(index) for index in range(len(self._cells))]
        for index, cell in enumerate(self._cells):
            if cell.check is None:
                continue
            if (judged := self._verdicts.get(index)) is not None:
                self._verdicts[index] = with_endless_cell(judged, self._endless_cell(index))
                continue
            by_tests = verdict_by_tests(cell.check, runs[index]) if cell.check.asserts else None
            self._verdicts[index] = by_tests or without_verdict(
                cell.check,
                runs[index],
                self._what_led_to(index, runs),
                self._allowed[index],
                self._hung_before.get(index),
            )
        return Execution(tuple(runs), self._verdicts, self._trouble, seconds, start_seconds)

    def _endless_cell(self, check: int) -> str:
        """Return the title of a student's cell, since the previous check, that was stopped; empty if there is none."""
        endless = ""
        for cell, ended in zip(self._cells[:check], self._ended, strict=False):
            if cell.check is not None:
                endless = ""
            elif cell.own and ended is Ended.TIMED_OUT:
                endless = _title(cell)
        return endless

    def _what_led_to(self, check: int, runs: list[CellRun]) -> list[tuple[str, CellRun]]:
        """Return the code cells that may have kept a check from beginning, each with its title.

        The cells are those since the previous check. If none of them failed, return all earlier cells, but of the
        checks only those in which the kernel ended.
        """
        usually_end_the_kernel = (Ended.KERNEL_DIED, *LIMITS)
        code = [index for index in range(check) if self._cells[index].kind is CellType.CODE]
        checks = [index for index in code if self._cells[index].check is not None]
        recent = [index for index in code if index > (checks[-1] if checks else -1)]
        if all(runs[index].ended is Ended.DONE or runs[index].ended is Ended.NOT_RUN for index in recent):
            recent = [
                index for index in code if index not in checks or runs[index].ended in usually_end_the_kernel
            ]
        return [(_title(self._cells[index]), runs[index]) for index in recent]

    def failed(self, reason: str, seconds: float) -> Execution:
        """Return the execution after a failure of the grader itself. No check in it counts."""
        runs = tuple(self._cell_run(index) for index in range(len(self._cells)))
        verdicts = {i: grader_trouble(cell.check, reason) for i, cell in enumerate(self._cells) if cell.check}
        return Execution(runs, verdicts, reason, seconds)

    @contextlib.contextmanager
    def _watched(self, index: int, cell: Cell, judge: Judge) -> Iterator[None]:
        """Let the judge watch a check cell. Any other cell runs without the judge."""
        if cell.check is None or cell.check.asserts:
            yield
            return
        try:
            judge.open(cell.check.exercise)
        except Exception as error:
            self._judge_failed(index, cell.check, error)
            yield
            return
        yield
        try:
            verdict = judge.close()
        except Unfinished as error:
            # If the cell reached its time limit, the judge was too slow. A cell that ended earlier did not wait for the
            # verdict: its check counts as failed, because otherwise a student could stop a check at a convenient
            # moment.
            if self._ended[index] is Ended.TIMED_OUT:
                self._judge_failed(index, cell.check, error)
            return
        except Exception as error:
            self._judge_failed(index, cell.check, error)
            return
        # Ignore a failed verdict on a cell that was stopped at a limit: it depends on how much the judge had seen by
        # then.
        if verdict is not None and (verdict.passed or self._ended[index] not in LIMITS):
            self._count(index, cell.check, verdict)

    def _count(self, index: int, check: CellCheck, verdict: Verdict) -> None:
        if verdict.exercise != check.exercise:
            self._judge_failed(index, check, ValueError(f"it judged {verdict.exercise} instead"))
            return
        self._verdicts[index] = verdict
        if verdict.state is State.NOT_CHECKED:
            self._trouble = verdict.diagnosis.text if verdict.diagnosis else "the judge could not check"

    def _judge_failed(self, index: int, check: CellCheck, error: Exception) -> None:
        self._trouble = f"the judge failed: {type(error).__name__}: {error}"
        self._verdicts[index] = grader_trouble(check, self._trouble)

    def _limit(self, cell: Cell) -> float:
        if cell.check is not None and not cell.check.asserts:
            return cell.check.limit + self._limits.check_margin
        is_terminal = cell.source.lstrip().startswith(("%%bash", "%%sh", "%%script"))
        return self._limits.cell_seconds * (self._limits.terminal_factor if is_terminal else 1.0)

    def _cell_run(self, index: int) -> CellRun:
        outputs = self.outputs.of(index)
        errors = [f"{o['ename']}: {o['evalue']}"[:500] for o in outputs if o["output_type"] == "error"]
        return CellRun(
            self._ended[index], outputs, errors[-1] if errors else "", round(self._seconds[index], 3)
        )


def _title(cell: Cell) -> str:
    """Return the title of a cell: its first line that is neither empty nor a comment."""
    lines = [line.strip() for line in cell.source.splitlines()]
    telling = [line for line in lines if line and not line.startswith("#")]
    return (telling or lines or [""])[0][:60]


_AGAIN_SECONDS = 10.0
"""Time limit in seconds for a cell without points that uses a function or class that hung before."""
_SHARE_OF_A_CHECK = 0.25
"""The fraction of the judge's time limit that a check gets if an earlier check of the same class or function hung. This
is enough, because a check normally takes a twentieth of the limit.
"""


@dataclass
class _Hangs:
    """The functions and classes of a student that have hung so far in a notebook.

    Args:
        written: The names of the classes and functions that the student defined.
    """

    written: frozenset[str]
    _hung: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, cells: Iterable[Cell]) -> _Hangs:
        """Return a record for the notebook with these cells, in which nothing has hung yet."""
        own = (cell.source for cell in cells if cell.kind is CellType.CODE and cell.own)
        return cls(frozenset(name for source in own for name in _DEFINED.findall(source)))

    def note(self, cell: Cell, title: str) -> None:
        """Record that the cell with this title in messages was stopped at its time limit."""
        used = [] if cell.own else self._used(cell)
        if len(used) == 1:
            self._hung.setdefault(used[0], title)

    def before(self, cell: Cell) -> tuple[str, str] | None:
        """Return the name of a function or class that hung before and that the cell uses; None if there is none.

        The second value is the title of the cell in which this function or class hung.
        """
        if not self._hung:
            return None  # nothing has hung, as in nearly every notebook, so no cell has to be read
        return next(((name, self._hung[name]) for name in self._used(cell) if name in self._hung), None)

    def _used(self, cell: Cell) -> list[str]:
        is_python = not cell.source.lstrip().startswith("%%")
        names = {part["name"] for part in _PART.finditer(cell.source)} if is_python else set()
        return sorted(names & self.written)


def _seconds_again(cell: Cell, usual: float, limits: Limits) -> float:
    """Return the time limit, in seconds of wall time, for a cell that uses a function or class that hung before.

    ``usual`` is the cell's limit if nothing has hung.
    """
    if cell.check is None or cell.check.asserts:
        return min(usual, _AGAIN_SECONDS)
    return min(usual, cell.check.limit * _SHARE_OF_A_CHECK + limits.check_margin)


# Python's parser takes quadratic time for some texts and cannot be interrupted, so code is only searched.
_NAME = r"[\pL_][\pL\pN_]*"
_DEFINED = re2.compile(rf"(?m)^(?:(?:async[ \t]+)?def|class)[ \t]+({_NAME})")
# Matches a string, a comment, a number, an attribute, or a name. A string without an end matches too, so that no part
# of the text is searched twice.
_PART = re2.compile(
    r'''(?s)""".*?(?:"""|\z)|'{3}.*?(?:'{3}|\z)|"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?|#[^\n]*'''
    rf"|\d[\pL\pN_.]*|\.\s*{_NAME}|(?P<name>{_NAME})"
)
