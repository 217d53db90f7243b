"""Shows the progress of grading: a bar or plain lines.

The bar is for terminals, the plain lines are for log files and Jupyter. The remaining time is estimated from the
finished notebooks. If a notebook still runs after the estimated time, the text names this notebook instead, with how
long it has been running.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Self

from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, TimeElapsedColumn
from rich.progress import TextColumn as Words
from rich.text import Text

from autograder.standard_output import printable

if TYPE_CHECKING:
    from collections.abc import Callable

    from rich.console import Console
    from rich.progress import Task


def plain_line(console: Console, text: str, style: str = "") -> None:
    """Print a text, which may contain a student's words, as one line: without markup, highlighting and line breaks."""
    console.print(printable(text), style=style, markup=False, highlight=False, soft_wrap=True)


_LINES = 20
"""The approximate number of lines that a large class gets in a log file, not counting a line for each failure."""


class BatchProgress:
    """Counts and shows the notebooks that are done, running, waiting or failed.

    One thread reports what begins and ends. Other threads only show it.

    Args:
        total: The number of notebooks to execute.
        doing: The word for the work in progress, such as "grading".
        did: The word for finished work, such as "graded".
        clock: Returns the current time in seconds.
    """

    def __init__(
        self,
        console: Console,
        total: int,
        *,
        doing: str = "grading",
        did: str = "graded",
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._console = console
        self._total = total
        self._did = did
        self._done = 0
        self._failed = 0
        self._running: dict[str, float] = {}
        self._clock = clock
        self._began = self._last = clock()
        # Jupyter gets plain lines like a log file: it would show the control characters that move a terminal's cursor.
        self._lively = console.is_terminal and not console.is_jupyter
        self._bar = Progress(
            Words(doing),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            _Now(lambda: ", ".join(self._now())),
            TimeElapsedColumn(),
            console=console,
            transient=True,
            refresh_per_second=4,
        )
        self._task = self._bar.add_task("", total=total)

    def __enter__(self) -> Self:
        if self._lively and self._total:
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar.live.is_started:
            self._bar.stop()

    def started(self, label: str) -> None:
        """Record that a notebook begins.

        Args:
            label: The name of the notebook.
        """
        self._running[label] = self._clock()

    def finished(self, label: str, failed: bool, note: str = "") -> None:
        """Record that a notebook is done.

        Args:
            label: The name of the notebook, as in :meth:`started`.
            failed: True if the grader itself failed on the notebook.
            note: A text to show after the notebook's name.
        """
        self._running.pop(label, None)
        self._done += 1
        self._failed += failed
        self._last = self._clock()
        self._bar.update(self._task, completed=self._done)
        step = max(1, self._total // _LINES)
        if not self._lively and (failed or self._done % step == 0 or self._done == self._total):
            rest = f" ({', '.join(self._now())})" if self._done < self._total else ""
            plain_line(self._console, f"{self._did} {self._done} of {self._total}: {label}{note}{rest}")

    def _now(self) -> list[str]:
        running = self._running.copy()  # another thread adds and removes notebooks
        waiting = max(0, self._total - self._done - len(running))
        words = [f"{len(running)} running", f"{waiting} waiting"]
        if self._failed:
            words.append(f"{self._failed} not checked")
        if running and self._is_late():
            label, since = min(running.items(), key=lambda one: one[1])
            seconds = self._clock() - since
            words.append(f"{label} for {_duration(seconds)} now")
        elif self._done:
            rate = 1 / self._each()
            words.append(f"{rate:.1f}/s" if rate >= 1 else f"{60 * rate:.1f}/min")
            words.append(f"about {_duration(self._last + self._rest_of_all() - self._clock())} left")
        return words

    def _each(self) -> float:
        """Return the average time in seconds between two finished notebooks."""
        return max(1e-3, self._last - self._began) / max(1, self._done)

    def _rest_of_all(self) -> float:
        return self._each() * (self._total - self._done)

    def _is_late(self) -> bool:
        """Return True if the estimated time has passed and a notebook is still running."""
        return bool(self._running and self._done) and self._clock() > self._last + self._rest_of_all()


class _Now(ProgressColumn):
    """A column of the progress bar with a text that is computed each time the bar is drawn."""

    def __init__(self, now: Callable[[], str]) -> None:
        super().__init__()
        self._now = now

    def render(self, task: Task) -> Text:
        """Return the text of the column. Rich calls this each time it draws the bar."""
        del task
        return Text(self._now())


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02} min"
    return f"{minutes} min {rest:02} s" if minutes else f"{rest} s"
