"""Measures how long each step of a batch takes."""

from __future__ import annotations

import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.execution.cells import Cell, Execution


@dataclass
class Timings:
    """Wall time of each step of a batch, in seconds. The times of notebooks that run in parallel are added up.

    Attributes:
        boxes: Starting and ending the boxes, kernels and judges.
        students: Executing the cells that contain no check by the judge.
        judge: Executing the cells that contain a check by the judge. This includes the time of the subject.
        rebuild: Reading submissions, and building the notebooks that are executed.
        gradebook: Converting notebooks and entering grades.
        feedback: Making feedback pages.
        first_started: The start of the first notebook, in seconds since the start of the batch.
        last_ended: The end of the last notebook, in seconds since the start of the batch.
    """

    boxes: float = 0.0
    students: float = 0.0
    judge: float = 0.0
    rebuild: float = 0.0
    gradebook: float = 0.0
    feedback: float = 0.0
    first_started: float = 0.0
    last_ended: float = 0.0

    def count(self, cells: Sequence[Cell], execution: Execution) -> None:
        """Add the times of one executed notebook."""
        spent = [run.seconds for run in execution.cells]
        checks = sum(
            seconds
            for cell, seconds in zip(cells, spent, strict=False)
            if cell.check and not cell.check.asserts
        )
        self.judge += checks
        self.students += sum(spent) - checks
        self.boxes += max(0.0, execution.seconds - sum(spent))

    @contextmanager
    def measure(self, part: str) -> Iterator[None]:
        """Measure how long the ``with`` block takes, and add the time to the attribute named ``part``."""
        began = time.monotonic()
        try:
            yield
        finally:
            setattr(self, part, getattr(self, part) + time.monotonic() - began)

    def line(self) -> str:
        """Return the times as a line of text; empty if they add up to almost nothing."""
        parts = (
            ("boxes and kernels", self.boxes),
            ("students' code", self.students),
            ("judge", self.judge),
            ("rebuilding", self.rebuild),
            ("gradebook", self.gradebook),
            ("feedback", self.feedback),
        )
        total = sum(seconds for _, seconds in parts)
        if total < 0.05:
            return ""
        return "time went into " + ", ".join(f"{name} {seconds:.1f} s" for name, seconds in parts)
