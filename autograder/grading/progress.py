"""What a person sees while a class is graded: a bar in a terminal, plain lines in a log file."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Self

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

if TYPE_CHECKING:
    from types import TracebackType

    from rich.console import Console

_LINES = 20
"""Lines at most that a whole batch puts into a log file."""


class BatchProgress:
    """Counts notebooks done, running and failed.

    Args:
        console: Where to show it.
        total: Notebooks to execute.
        doing: What is being done to them, as the bar says it.
        did: The same when it is done.
    """

    def __init__(self, console: Console, total: int, *, doing: str = "grading", did: str = "graded") -> None:
        self._console = console
        self._total = total
        self._did = did
        self._done = 0
        self._failed = 0
        self._running = 0
        self._began = time.monotonic()
        self._bar = Progress(
            TextColumn(doing),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[now]}"),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=console,
            transient=True,
        )
        self._task = self._bar.add_task("", total=total, now="")

    def __enter__(self) -> Self:
        if self._console.is_terminal and self._total:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar.live.is_started:
            self._bar.stop()

    def started(self) -> None:
        """A notebook is being executed now."""
        self._running += 1
        self._show()

    def finished(self, label: str, failed: bool) -> None:
        """A notebook is done.

        Args:
            label: What it is called.
            failed: Whether the grader itself had trouble with it.
        """
        self._running -= 1
        self._done += 1
        self._failed += failed
        self._bar.advance(self._task)
        self._show()
        step = max(1, self._total // _LINES)
        if not self._console.is_terminal and (failed or self._done % step == 0 or self._done == self._total):
            self._console.print(
                f"{self._did} {self._done} of {self._total}: {label}{self._left()}",
                markup=False,
                highlight=False,
            )

    def _show(self) -> None:
        failed = f", {self._failed} not checked" if self._failed else ""
        self._bar.update(self._task, now=f"{self._running} running{failed}")

    def _left(self) -> str:
        if self._done == self._total:
            return ""
        seconds = (time.monotonic() - self._began) / self._done * (self._total - self._done)
        return f" (about {seconds:.0f} s left)"
