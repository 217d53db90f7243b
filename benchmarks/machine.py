"""The machine and how busy others keep it: without that, no figure means anything."""

from __future__ import annotations

import contextlib
import os
import platform
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import psutil


@dataclass(frozen=True)
class Machine:
    """The machine on which the figures were measured.

    Attributes:
        cores: Processors.
        memory_gib: Memory in GiB.
        python: Version of the interpreter.
        system: Operating system.
    """

    cores: int
    memory_gib: float
    python: str
    system: str


def machine() -> Machine:
    """This machine."""
    return Machine(
        cores=os.cpu_count() or 1,
        memory_gib=round(psutil.virtual_memory().total / 2**30, 1),
        python=platform.python_version(),
        system=f"{platform.system()} {platform.machine()}",
    )


@dataclass(frozen=True)
class Usage:
    """The load while something was measured.

    Attributes:
        seconds: Wall time.
        busy: Share of all cores that was busy with anything, 0 to 1.
        own_cpu: CPU seconds of the measured processes; None if this system does not count them in a group.
        load: The system's load average of one minute, at the end.
        others: Share of all cores that processes other than the measured ones took; None like ``own_cpu``.
    """

    seconds: float
    busy: float
    own_cpu: float | None
    load: float
    others: float | None


@dataclass
class Watch:
    """Measures a block: ``with Watch() as watch: ...``, then ``watch.usage``.

    Processes started through :attr:`prepare` (a ``preexec_fn``) are counted with all that they start, daemons
    included.
    """

    usage: Usage | None = None
    busy_by_second: list[float] = field(default_factory=list)
    """The share of all cores that was busy, second by second."""

    def __enter__(self) -> Self:
        self._group = CpuGroup.make()
        self._began = time.monotonic()
        self._times = _busy_and_total()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._sample, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        seconds = time.monotonic() - self._began
        busy, total = (now - then for now, then in zip(_busy_and_total(), self._times, strict=True))
        own = self._group.seconds() if self._group else None
        cores = os.cpu_count() or 1
        self.usage = Usage(
            seconds=seconds,
            busy=busy / total if total else 0.0,
            own_cpu=own,
            load=os.getloadavg()[0],
            others=None if own is None else max(0.0, busy - own) / (seconds * cores),
        )
        if self._group:
            self._group.remove()

    def prepare(self) -> None:
        """Count this process from here on; called in the child, before it becomes the program."""
        if self._group:
            self._group.join()

    def _sample(self) -> None:
        before = _busy_and_total()
        while not self._stop.wait(1.0):
            now = _busy_and_total()
            total = now[1] - before[1]
            self.busy_by_second.append((now[0] - before[0]) / total if total else 0.0)
            before = now


@dataclass(frozen=True)
class CpuGroup:
    """A control group that counts CPU time.

    Counting by ``wait`` would miss what a sandbox's process namespace ends on its way down. In the hierarchy of both
    versions (``unified``), the grader makes no groups of its own, so every process stays in the group into which the
    benchmark has put it. In that of ``cpuacct``, a group also counts the groups that the grader makes in it.
    """

    folder: Path

    @classmethod
    def make(cls) -> CpuGroup | None:
        """Return a new group; None if this system has none of these kinds, or does not allow it."""
        for place in ("unified", "cpuacct"):
            folder = Path("/sys/fs/cgroup", place, f"benchmark-{os.getpid()}-{time.monotonic_ns()}")
            with contextlib.suppress(OSError):
                folder.mkdir()
                return cls(folder)
        return None

    def join(self) -> None:
        """Count this process from now on."""
        self.take(0)

    def take(self, pid: int) -> None:
        """Count process ``pid`` from now on."""
        (self.folder / "cgroup.procs").write_text(str(pid))

    def seconds(self) -> float:
        """CPU seconds so far."""
        if self.folder.parent.name == "unified":
            return int((self.folder / "cpu.stat").read_text().split()[1]) / 1e6
        return int((self.folder / "cpuacct.usage").read_text()) / 1e9

    def remove(self) -> None:
        """Give the group back."""
        with contextlib.suppress(OSError):  # something of the measured run may still live
            self.folder.rmdir()


def _busy_and_total() -> tuple[float, float]:
    """CPU seconds of all cores since the start of the machine: those at work, and all."""
    times = psutil.cpu_times()
    total = sum(times[:8])  # guest times are within user times
    return total - times.idle - getattr(times, "iowait", 0.0), total
