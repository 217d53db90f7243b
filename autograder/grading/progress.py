"""What a person sees while a class is graded: a bar in a terminal, plain lines in a log file or in a notebook."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Self

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

if TYPE_CHECKING:
    from types import TracebackType

    from rich.console import Console

_LINES = 20
"""Lines at most that a whole batch puts into a log file."""


class BatchProgress:
    """Counts notebooks done, running, waiting and failed. Safe to call from any thread.

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
        self._lock = threading.Lock()
        # A notebook is no terminal: what moves the cursor there is shown as it is.
        self._lively = console.is_terminal and not console.is_jupyter
        self._bar = Progress(
            TextColumn(doing),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TextColumn("{task.fields[now]}"),
            TimeElapsedColumn(),
            console=console,
            transient=True,
            refresh_per_second=4,
        )
        self._task = self._bar.add_task("", total=total, now="")

    def __enter__(self) -> Self:
        if self._lively and self._total:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar.live.is_started:
            self._bar.stop()

    def started(self) -> None:
        """A notebook is being executed now."""
        with self._lock:
            self._running += 1
            self._show()

    def finished(self, label: str, failed: bool) -> None:
        """A notebook is done.

        Args:
            label: What it is called.
            failed: Whether the grader itself had trouble with it.
        """
        with self._lock:
            self._running -= 1
            self._done += 1
            self._failed += failed
            self._show()
            step = max(1, self._total // _LINES)
            line = failed or self._done % step == 0 or self._done == self._total
            text = f"{self._did} {self._done} of {self._total}: {label}{self._rest()}"
        if line and not self._lively:
            self._console.print(text, markup=False, highlight=False, soft_wrap=True)

    def _show(self) -> None:
        self._bar.update(self._task, completed=self._done, now=", ".join(self._now()))

    def _rest(self) -> str:
        """What stands in brackets behind a line of a log file; nothing behind the last one."""
        return f" ({', '.join(self._now())})" if self._done < self._total else ""

    def _now(self) -> list[str]:
        waiting = max(0, self._total - self._done - self._running)
        words = [f"{self._running} running", f"{waiting} waiting"]
        if self._failed:
            words.append(f"{self._failed} not checked")
        if self._done:
            seconds = max(1e-3, time.monotonic() - self._began)
            words.append(_rate(self._done / seconds))
            words.append(f"about {_duration(seconds / self._done * (self._total - self._done))} left")
        return words


def _rate(per_second: float) -> str:
    return f"{per_second:.1f}/s" if per_second >= 1 else f"{60 * per_second:.1f}/min"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02} min"
    return f"{minutes} min {rest:02} s" if minutes else f"{rest} s"
