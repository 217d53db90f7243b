"""Memory while a class is graded: of all together, and of each box by itself."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Self

import psutil

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_EVERY_SECONDS = 2.0
_WAITING = {"bwrap", "cat"}
"""The processes of a box in which no program runs."""


@dataclass(frozen=True)
class MemorySample:
    """One look.

    Attributes:
        seconds: Since the first look.
        grader: Resident bytes of the grader's own process.
        together: Bytes of all processes of the run, each page counted once (PSS).
        boxes: Bytes of each process namespace that is not the grader's (PSS): what each box has for itself. A box that
            waits for its first or next program is left out.
    """

    seconds: float
    grader: int
    together: int
    boxes: tuple[int, ...]


@dataclass
class MemoryWatch:
    """Looks at a process and all that it has started, every two seconds.

    Args:
        pid: The grader.
    """

    pid: int
    samples: list[MemorySample] = field(default_factory=list)

    def __enter__(self) -> Self:
        self._stop = threading.Event()
        self._began = time.monotonic()
        self._thread = threading.Thread(target=self._look, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def _look(self) -> None:
        while not self._stop.wait(_EVERY_SECONDS):
            try:
                sample = _sample(self.pid, time.monotonic() - self._began)
                if sample.grader:  # a process that is ending has no memory any more
                    self.samples.append(sample)
            except psutil.Error:  # the grader is gone
                return


def _sample(pid: int, seconds: float) -> MemorySample:
    grader = psutil.Process(pid)
    own = _namespace(pid)
    together = _pss(pid)
    boxed: dict[int, list[tuple[str, int]]] = {}
    for process in grader.children(recursive=True):
        size = _pss(process.pid)
        together += size
        space = _namespace(process.pid)
        with contextlib.suppress(psutil.NoSuchProcess):  # it has just ended
            if space and space != own:
                boxed.setdefault(space, []).append((process.name(), size))
    return MemorySample(seconds, grader.memory_info().rss, together, own_memory(boxed.values()))


def own_memory(boxes: Iterable[Sequence[tuple[str, int]]]) -> tuple[int, ...]:
    """The bytes of each box in which a program runs.

    Args:
        boxes: For each box, the name and the bytes of each of its processes.
    """
    return tuple(
        sum(size for _, size in processes)
        for processes in boxes
        if not _WAITING.issuperset(name for name, _ in processes)
    )


def _namespace(pid: int) -> int:
    """Return the number of the process namespace; 0 if the process is gone."""
    try:
        return os.stat(f"/proc/{pid}/ns/pid").st_ino  # noqa: PTH116  (Path.stat resolves less plainly)
    except OSError:
        return 0


def _pss(pid: int) -> int:
    """Proportional set size (proc_pid_smaps(5)): shared pages are divided among those who share them."""
    try:
        for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    return 0
