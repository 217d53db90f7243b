"""Desks: processes in a box, each of which reads one file of a student, so that no trusted process has to parse it.

.. code-block:: python

    desk = KeptDesk({"list": "autograder.grading.collecting.lms_lists"})
    entries = desk.read("list", data, list[ListEntry], most=1_000_000, seconds=20, name="scores.csv")

All desk processes of one :class:`Desk` enter the same box. This is safe because a desk process cannot open files, start
processes or use a network (:func:`autograder.boxes.seccomp_filter.filter_for_readers`), so it leaves no data of one
student for the next. If no box can be made on this machine, a desk is still a separate process with limits and a filter
of system calls.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import signal
import threading
from typing import TYPE_CHECKING, Any

from autograder.boxes import desk_program
from autograder.boxes.admission import NotAdmitted, admitted
from autograder.boxes.box_connection import ChannelClosed, NoSandbox
from autograder.boxes.boxed_processes import ForkedProcess
from autograder.boxes.fork_server import FOLDER_PREFIX, INSIDE, ForkServer
from autograder.boxes.process_isolation import Entrance
from autograder.boxes.sandbox import lone_enclosure
from autograder.boxes.visible_host import base_environment
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from autograder.boxes.box_connection import Box


MEMORY_BYTES = 700_000_000
"""The maximum address space of a desk process, in bytes. The worst notebook of 50 MB takes two thirds of it: a large
picture in text form and one emoji, which makes Python store each character of the text in four bytes.
"""
_WALL_SECONDS = 600.0
"""Time limit in seconds of wall time. A desk cannot sleep, so the limit of processor time usually ends it earlier."""
_REHEARSAL_SECONDS = 20
_ATTEMPTS = 3
"""The maximum number of desks that a request tries, each after the loss of the one before."""


class Desk:
    """The fork server of desk processes, and the box that they enter.

    The server and the box end when :meth:`close` is called or this process ends.

    Args:
        readers: For the name of each request, the module that reads (:mod:`autograder.boxes.desk_program`).
        program: The module that a desk process runs.
        extra: Additional environment variables of the desk processes.

    Raises:
        ChannelClosed: The readers cannot even do what they have rehearsed, which no student's file can cause.
    """

    def __init__(
        self,
        readers: Mapping[str, str],
        program: str = desk_program.__name__,
        extra: Mapping[str, str] | None = None,
    ) -> None:
        with contextlib.ExitStack() as started:
            folder = HeldFolder(FOLDER_PREFIX)
            started.callback(folder.remove)
            words = ["=".join(reader) for reader in readers.items()]
            server = ForkServer(INSIDE, program, folder.path / "desks", extra, words)
            started.callback(server.stop)
            self._address = server.address
            self._box = _box_in(folder.path, started)
            self.is_boxed = self._box is not None
            """True if a box could be made here."""
            with in_memory() as nothing:
                try:
                    self.ask(desk_program.REHEARSAL, nothing, nothing, most=0, seconds=_REHEARSAL_SECONDS)
                except NotAdmitted as error:
                    raise ChannelClosed(f"not even a sample ({error})") from error
            self._open = started.pop_all()

    def ask(self, request: str, source: int, answer: int, *, most: int, seconds: int, **words: Any) -> None:
        """Let a desk process read a file and write its answer into another file. The answer is not checked here.

        Args:
            request: The name of the request.
            source: The descriptor of the file to read.
            answer: The descriptor of an empty file for the answer.
            most: The maximum size of the answer in bytes.
            seconds: The maximum processor time in seconds. If it is exceeded, the exit code is ``-SIGXCPU``.
            words: The further arguments of the reader.

        Raises:
            NotAdmitted: The desk process failed because of the file.
            ChannelClosed: The desk process was lost or killed for a reason other than the file.
        """
        entrance = Entrance(
            cwd="/",
            environment=base_environment(),
            boxed=self.is_boxed,
            rlimits={"RLIMIT_AS": MEMORY_BYTES, "RLIMIT_FSIZE": most, "RLIMIT_CORE": 1},
            call={"request": request, "words": words},
            reader_seconds=seconds,
        )
        place = [self._box.pidfd] if self._box else []
        process = ForkedProcess(self._address, entrance, [*place, source, answer])
        try:
            if not process.wait(_WALL_SECONDS) or process.status is None:
                raise ChannelClosed("the process that reads files was lost")
            code = os.waitstatus_to_exitcode(process.status)
        finally:
            process.end()
        if code == -signal.SIGKILL:
            # A desk cannot kill itself, so Linux has killed it, usually because the machine is short of memory.
            raise ChannelClosed("the process that reads files was killed")
        if code:
            raise NotAdmitted(f"the process that reads files ended with exit code {code}", code)

    def close(self) -> None:
        """End all desk processes. This may be called twice."""
        self._open.close()


def _box_in(folder: Path, started: contextlib.ExitStack) -> Box | None:
    """Return the box for desk processes, or None if none can be made here. The box ends when ``started`` is closed."""
    if shutil.which("bwrap") is None:
        return None
    with contextlib.suppress(NoSandbox):
        return started.enter_context(lone_enclosure(folder)).box("desk", scratch=False)
    return None


class KeptDesk:
    """A desk that is started when it is first needed, and kept until this process ends. Any thread may use it.

    Args:
        readers: As for :class:`Desk`.
    """

    def __init__(self, readers: Mapping[str, str]) -> None:
        self._readers = readers
        self._changing = threading.Lock()
        self._desk: Desk | None = None
        atexit.register(self.close)

    @property
    def is_unboxed(self) -> bool:
        """True if a desk was started, and no box could be made for it."""
        return self._desk is not None and not self._desk.is_boxed

    def read(self, request: str, data: bytes, kind: Any, *, most: int, seconds: int, **words: Any) -> Any:
        """Let a desk process read the bytes of a file, and return its answer.

        Args:
            kind: The only type that the answer may have.

        Raises:
            NotAdmitted: The desk process failed because of the file, or gave another answer.
            ChannelClosed: As for :meth:`ask`.
        """
        with in_memory(data) as source, in_memory() as answer:
            self.ask(request, source, answer, most=most + 1, seconds=seconds, **words)
            # os.pread allocates as many bytes as are asked for, so do not ask for more than there are.
            size = min(os.fstat(answer).st_size, most + 1)
            return admitted(os.pread(answer, size, 0), kind, most)

    def ask(self, request: str, source: int, answer: int, *, most: int, seconds: int, **words: Any) -> None:
        """Do the same as :meth:`Desk.ask`. If the desk is lost, start another desk and try again.

        Raises:
            NotAdmitted: The desk process failed because of the file.
            ChannelClosed: All attempts failed for a reason other than the file. The message is about the last attempt.
        """
        reason = ""
        for _ in range(_ATTEMPTS):
            desk = None
            try:
                desk = self._started()
                os.ftruncate(answer, 0)
                # A lost desk has moved the positions, which all desks share.
                for descriptor in (source, answer):
                    os.lseek(descriptor, 0, os.SEEK_SET)
                return desk.ask(request, source, answer, most=most, seconds=seconds, **words)
            except (ChannelClosed, NoSandbox, OSError) as error:
                reason = str(error)
                self._forget(desk)
        raise ChannelClosed(reason)

    def close(self) -> None:
        """End the desk if it was started. The next request starts another desk."""
        self._forget(self._desk)

    def _started(self) -> Desk:
        with self._changing:
            if self._desk is None:
                self._desk = Desk(self._readers)
            return self._desk

    def _forget(self, desk: Desk | None) -> None:
        with self._changing:
            if desk is not None and desk is self._desk:
                self._desk = None
                desk.close()


@contextlib.contextmanager
def in_memory(data: bytes = b"") -> Iterator[int]:
    """Make a file in memory that contains ``data``, and yield its descriptor. The ``with`` block closes the file.

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
