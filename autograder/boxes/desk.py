"""Desks: processes in a box, each of which parses one file of a student, so that no trusted process has to.

.. code-block:: python

    desk = KeptDesk("autograder.grading.rebuilding.desk_process")
    with in_memory(data) as source, in_memory() as answer:
        code = desk.ask(source, answer, most=1_000_000, seconds=20)

All desks of one :class:`Desk` enter the same box. A desk can open no file, start no process and reach nothing
(:func:`autograder.boxes.seccomp_filter.filter_for_readers`), so no data of one student is left for the next. On a
machine on which no box can be made, a desk is still a separate process with limits and a filter of system calls.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import signal
import threading
from typing import TYPE_CHECKING, Any

from autograder.boxes.boxed_processes import ForkedProcess
from autograder.boxes.channel import ChannelClosed
from autograder.boxes.enter_box import Entrance
from autograder.boxes.environment import base_environment
from autograder.boxes.fork_server import BESIDE, FOLDER_PREFIX, INSIDE, SUPERVISOR_MODULE, ForkServer
from autograder.boxes.sandbox import Enclosure, NoSandbox
from autograder.temporary_folders import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from autograder.boxes.box import Box

MEMORY_BYTES = 700_000_000
"""The maximum address space of a desk process, in bytes. A notebook of 50 MB with a picture and an emoji takes two
thirds of it.
"""
_WALL_SECONDS = 600.0
"""Time limit in seconds of wall time. A desk cannot sleep, so this is reached only if the whole machine was stopped."""


class Desk:
    """The fork server of desk processes, and the box that they enter.

    The server and the box end when :meth:`close` is called or this process ends.

    Args:
        module: The module that a desk process runs.
        extra: More environment variables.

    """

    def __init__(self, module: str, extra: Mapping[str, str] | None = None) -> None:
        self._open = contextlib.ExitStack()
        folder = HeldFolder(FOLDER_PREFIX)
        self._open.callback(folder.remove)
        server = ForkServer(INSIDE, module, folder.path / "desks", extra=extra)
        self._open.callback(server.stop)
        self._address = server.address
        self._box = self._box_in(folder.path)

    @property
    def is_boxed(self) -> bool:
        """True if a box could be made here."""
        return self._box is not None

    def ask(
        self, source: int, answer: int, most: int, seconds: int, call: Mapping[str, Any] | None = None
    ) -> int:
        """Start a desk process that reads a file and writes an answer into another file. Return its exit code.

        Args:
            source: The descriptor of the file to read.
            answer: The descriptor of an empty file for the answer.
            most: The limit in bytes of the answer.
            seconds: The limit in seconds of the processor time. A process that reaches it ends with ``-SIGXCPU``.
            call: The argument for the function ``run`` of the module.

        Raises:
            ChannelClosed: The desk process was lost or killed, and the file is not the reason.
        """
        entrance = Entrance(
            cwd="/",
            environment=base_environment(),
            boxed=self.is_boxed,
            rlimits={"RLIMIT_AS": MEMORY_BYTES, "RLIMIT_FSIZE": most, "RLIMIT_CORE": 1},
            call=call or {},
            reader_seconds=seconds,
        )
        place = [self._box.pidfd] if self._box else []
        process = ForkedProcess(self._address, entrance, [*place, source, answer])
        try:
            if not process.wait(_WALL_SECONDS) or process.status is None:
                raise ChannelClosed("the process that reads files was lost")
            code = os.waitstatus_to_exitcode(process.status)
            if code == -signal.SIGKILL:
                # A desk cannot kill itself, so the system has killed it, usually because memory is short.
                raise ChannelClosed("the process that reads files was killed")
            return code
        finally:
            process.end()

    def close(self) -> None:
        """End all desk processes. This may be called twice."""
        self._open.close()

    def _box_in(self, folder: Path) -> Box | None:
        if shutil.which("bwrap") is None:
            return None
        supervisors = ForkServer(BESIDE, SUPERVISOR_MODULE, folder / "supervisors")
        self._open.callback(supervisors.stop)
        with contextlib.suppress(NoSandbox):
            return self._open.enter_context(Enclosure(supervisors.address, folder / "box")).box(
                "desk", scratch=False
            )
        return None


class KeptDesk:
    """A desk that is started when it is first needed, and kept until this process ends. Any thread may use it.

    Args:
        module: The module that a desk process runs.
        attempts: The maximum number of desks that are started for one question, because a desk may be lost.
        rehearse: Called with a new desk before its first question.
    """

    def __init__(
        self, module: str, *, attempts: int = 3, rehearse: Callable[[Desk], None] = lambda _: None
    ) -> None:
        self._module, self._attempts, self._rehearse = module, attempts, rehearse
        self._changing = threading.Lock()
        self._desk: Desk | None = None
        atexit.register(self.close)

    @property
    def is_unboxed(self) -> bool:
        """True if a desk was started, and no box could be made for it."""
        return self._desk is not None and not self._desk.is_boxed

    def ask(
        self, source: int, answer: int, most: int, seconds: int, call: Mapping[str, Any] | None = None
    ) -> int:
        """Ask the desk; see :meth:`Desk.ask`. If the desk is lost, start another one and ask again.

        Raises:
            ChannelClosed: Every attempt was lost, and the file is not the reason. The message gives the reason of the
                last one.
        """
        reason = ""
        for _ in range(self._attempts):
            desk = None
            try:
                desk = self._started()
                os.ftruncate(answer, 0)
                return desk.ask(source, answer, most, seconds, call)
            except (ChannelClosed, NoSandbox, OSError) as error:
                reason = str(error)
                self._forget(desk)
        raise ChannelClosed(reason)

    def close(self) -> None:
        """End the desk, if there is one. The next question starts another one."""
        self._forget(self._desk)

    def _started(self) -> Desk:
        with self._changing:
            if self._desk is None:
                desk = Desk(self._module)
                try:
                    self._rehearse(desk)
                except BaseException:
                    desk.close()
                    raise
                self._desk = desk
            return self._desk

    def _forget(self, desk: Desk | None) -> None:
        with self._changing:
            if desk is not None and desk is self._desk:
                self._desk = None
                desk.close()


@contextlib.contextmanager
def in_memory(data: bytes = b"") -> Iterator[int]:
    """Make a file in memory with these bytes for a ``with`` block, and yield its descriptor.

    Raises:
        ChannelClosed: The bytes do not fit into memory.
    """
    descriptor = os.memfd_create("desk")
    try:
        if os.pwrite(descriptor, data, 0) < len(data):
            raise ChannelClosed("the file does not fit into memory")
        yield descriptor
    finally:
        os.close(descriptor)


def answer_in(descriptor: int, most: int) -> bytes:
    """Return what a desk wrote into the file for its answer, at most ``most`` bytes."""
    return os.pread(descriptor, min(os.fstat(descriptor).st_size, most), 0)
