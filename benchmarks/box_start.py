"""What a box costs: one empty notebook after the other, in a box and out of it by turns."""

from __future__ import annotations

import contextlib
import statistics
from dataclasses import dataclass

import msgspec

from autograder.execution.executed_cells import Cell, Execution
from autograder.grading.grading_task import Task
from autograder.grading.running.order_executor import Executor
from autograder.grading.running.worker_messages import JUDGE, Order
from autograder.safe_files import HeldFolder


@dataclass(frozen=True)
class BoxStart:
    """Medians over some turns.

    Attributes:
        boxed: Wall seconds from the task to its result, in a box.
        unboxed: The same without one.
        turns: How many of each.
    """

    boxed: float
    unboxed: float
    turns: int

    @property
    def extra(self) -> float:
        """The extra time of the box, in seconds."""
        return self.boxed - self.unboxed


def measure_box_start(turns: int) -> BoxStart:
    """Measure with warm processes, as in the middle of a batch.

    Args:
        turns: How many notebooks of each kind.
    """
    spent: dict[bool, list[float]] = {True: [], False: []}
    with contextlib.ExitStack() as stack:
        executor = Executor(stack.enter_context(HeldFolder("autograder-bench-")).path)
        stack.callback(executor.stop)
        for turn in range(turns + 1):
            for boxed in spent:
                task = msgspec.Raw(msgspec.json.encode(_empty(boxed)))
                answer = executor.execute("empty", msgspec.json.encode(Order(task, JUDGE)))
                execution = msgspec.json.decode(answer, type=Execution)
                if execution.trouble:
                    raise RuntimeError(f"an empty notebook could not be run: {execution.trouble}")
                if turn:  # the first one starts the warm processes
                    spent[boxed].append(execution.seconds)
    return BoxStart(statistics.median(spent[True]), statistics.median(spent[False]), turns)


def _empty(boxed: bool) -> Task:
    return Task("nobody", "benchmark", "empty", (Cell("1"),), seed="0", course="benchmark", boxed=boxed)
