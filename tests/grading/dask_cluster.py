"""A scheduler and workers on loopback, each a process of its own, for as long as a test needs them."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Self

import psutil

from autograder.safe_files import remove_tree
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator

_SCHEDULER = cases(__file__, "_SCHEDULER")

_WORKER = cases(__file__, "_WORKER")

# What `dask worker` executes first, so that it has the same to offer.
_PRELOAD = cases(__file__, "_PRELOAD")

VERSION = "test"
UNBOXED = "this test has no boxes"


class DaskCluster:
    """A scheduler; workers are added.

    Args:
        protocol: ``tcp``, or ``tls`` where Dask's own settings name certificates.
    """

    def __init__(self, protocol: str = "tcp") -> None:
        self._protocol = protocol

    def __enter__(self) -> Self:
        self._processes: list[subprocess.Popen[str]] = []
        # What a killed worker cannot tidy up goes with this. A short name: sockets are in there.
        self._temporary = Path(tempfile.mkdtemp(prefix="dc-"))
        self.said = ""
        self.address = self._started([sys.executable, "-c", _SCHEDULER, self._protocol]).strip()
        self.scheduler = self._processes[0]
        return self

    def __exit__(self, *_: object) -> None:
        for process in reversed(self._processes):
            process.kill()
        for process in self._processes:
            process.wait()
            assert process.stdout
            process.stdout.close()
        remove_tree(self._temporary)

    @contextlib.contextmanager
    def worker(
        self, name: str, slots: int = 1, *, version: str = VERSION, obstacle: str = UNBOXED, before: str = ""
    ) -> Iterator[subprocess.Popen[str]]:
        """A worker, ready for work.

        Args:
            name: What it is called.
            slots: Notebooks at once.
            version: What it takes for its course's version.
            obstacle: Why it takes no sandbox to be possible.
            before: Code that it executes first.
        """
        arguments = [self.address, name, str(slots), version, obstacle, before]
        self._started([sys.executable, "-W", "ignore", "-c", _WORKER, *arguments], "waits for work")
        process = self._processes.pop()
        try:
            yield process
        finally:
            end(process)

    @contextlib.contextmanager
    def plain_worker(self, name: str, folder: Path) -> Iterator[subprocess.Popen[str]]:
        """A worker as Dask's own command makes it, under a nanny.

        Args:
            name: What it is called.
            folder: For its files.
        """
        preload = folder / "preload.py"
        preload.write_text(_PRELOAD.format(version=VERSION, obstacle=UNBOXED))
        command = [sys.executable, "-m", "distributed.cli.dask_worker", self.address, "--name", name]
        command += ["--nthreads", "2", "--no-dashboard", "--local-directory", str(folder)]
        command += ["--preload", str(preload)]
        self._started(command, "Registered to", log=subprocess.STDOUT)
        process = self._processes.pop()
        try:
            yield process
        finally:
            end(process)

    def _environment(self) -> dict[str, str]:
        fake_judge = str(Path(__file__).parent)
        return {**os.environ, "PYTHONPATH": fake_judge, "TMPDIR": str(self._temporary)}

    def _started(self, command: list[str], until: str = "", log: int = subprocess.DEVNULL) -> str:
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=log, text=True, env=self._environment()
        )
        self._processes.append(process)
        assert process.stdout
        for line in process.stdout:
            self.said += line
            if until in line:
                return line
        raise AssertionError(f"{command[-6:]} ended with {process.wait()}")


def end(process: subprocess.Popen[str]) -> None:
    """Kill a worker as a power cut does, and wait until nothing of it is left."""
    children = psutil.Process(process.pid).children(recursive=True) if process.poll() is None else []
    process.kill()
    process.wait()
    assert process.stdout
    process.stdout.close()
    _, alive = psutil.wait_procs(children, timeout=180)
    assert alive == []


def until(condition: object, within: float = 180.0) -> None:
    """Wait for something that another process does."""
    deadline = time.monotonic() + within
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < deadline
        time.sleep(0.02)
