"""Jobs without boxes, for a grader that was told to go on without a sandbox.

Reports are made as with boxes, but nothing keeps a build or a program away from who makes them.
"""

from __future__ import annotations

import contextlib
import io
import os
import select
import signal
import subprocess
import tarfile
import tempfile
import time
from typing import TYPE_CHECKING

from autograder.workspaces.jobs import BUILD_SECONDS, MAX_LOG_BYTES, Built
from autograder.workspaces.processes import descendants

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path


class PlainJobs:
    """Implements :class:`autograder.workspaces.jobs.Jobs`.

    Args:
        environment: The whole environment of what is run.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._environment = dict(environment)

    @property
    def environment(self) -> Mapping[str, str]:
        """What was given."""
        return self._environment

    def place(self, name: str, entry: Path) -> Path:
        """The entry itself."""
        del name
        return entry

    def tree(self, sources: Path) -> Path:
        """The sources themselves."""
        return sources

    def build(
        self,
        name: str,
        entry: Path,
        command: Sequence[str],
        variables: Mapping[str, str],
        cancelled: Callable[[], bool],
        hidden: Sequence[Path],
    ) -> Built:
        """Build in the entry, pack what came of it and remove that again."""
        del name, hidden
        environment = {**self._environment, "COLCON_DEFAULTS_FILE": os.devnull, **variables}
        program = PlainProgram(command, environment, entry)
        output = bytearray()
        deadline = time.monotonic() + BUILD_SECONDS
        try:
            while (data := program.read(0.5)) != b"":
                output += (data or b"")[: MAX_LOG_BYTES - len(output)]
                if (late := time.monotonic() > deadline) or cancelled():
                    return Built(None, bytes(output), late=late)
        finally:
            program.end()
        if program.exit_code() != 0:
            return Built(program.exit_code(), bytes(output))
        archive = io.BytesIO()
        with tarfile.open(fileobj=archive, mode="w") as tar:
            tar.add(entry / "install", arcname=".")
        for made in ("install", "build", "log"):
            subprocess.run(["rm", "-rf", str(entry / made)], check=True)
        return Built(0, bytes(output), archive.getvalue())

    def start(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        *,
        sources: Path,
        entries: Mapping[str, Path],
        hidden: Sequence[Path],
    ) -> PlainProgram:
        """Start it as a process."""
        del entries, hidden
        return PlainProgram(command, environment, sources)

    @contextlib.contextmanager
    def standstill(self) -> Iterator[None]:
        """Nothing: where there are no boxes, nobody can say which processes are the student's."""
        yield


class PlainProgram:
    """Implements :class:`autograder.workspaces.jobs.Program`."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str], cwd: Path) -> None:
        # Its home and temporary files are its own.
        self._home = tempfile.TemporaryDirectory(prefix="job-", ignore_cleanup_errors=True)
        folders = dict.fromkeys(("HOME", "TMPDIR", "ROS_LOG_DIR"), self._home.name)
        self._process = subprocess.Popen(
            list(command),
            cwd=cwd,
            env={**environment, **folders},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        self.pid = self._process.pid

    def read(self, within: float) -> bytes | None:
        """Its output, stdout and stderr in one."""
        assert self._process.stdout is not None
        if self._process.stdout.closed:
            return b""
        if not select.select([self._process.stdout], [], [], within)[0]:
            return None
        data = os.read(self._process.stdout.fileno(), 1 << 16)
        if not data:
            self._process.wait()
        return data

    def exit_code(self) -> int | None:
        """Of the process that was started."""
        return self._process.poll()

    def end(self) -> None:
        """Kill its session, and what has left it as far as it is still below it."""
        family = [*descendants(self.pid), self.pid] if self._process.poll() is None else []
        for pid in family:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(pid, signal.SIGKILL)
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, signal.SIGKILL)
        self._process.wait()
        assert self._process.stdout is not None
        self._process.stdout.close()
        self._home.cleanup()
