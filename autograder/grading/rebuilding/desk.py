"""Reads what students handed in. Each file is parsed by a desk: a separate process in a box.

.. code-block:: python

    cells, left_out = read_notebook(read_bytes(path))

Code that has taken over a desk decides only what is reported about this one file. The document that comes out is
checked (:func:`autograder.grading.running.admission.admitted_notebook`). An impossible document, or a desk that fails,
counts as the file's fault. On a machine that cannot make namespaces for a box, there are still the process, its limits
and its filter of system calls.
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
from autograder.grading.errors import GradingError
from autograder.grading.rebuilding.submission import Unreadable, UnreadableSubmission
from autograder.grading.running.admission import LARGEST_DOCUMENT, Forged, admitted_notebook
from autograder.temporary_folders import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from autograder.boxes.box import Box
    from autograder.grading.rebuilding.submission import SubmittedCell

MODULE = "autograder.grading.rebuilding.desk_process"
MEMORY_BYTES = 700_000_000
"""The maximum address space of a desk process, in bytes. A file of 50 MB with a picture and an emoji takes two thirds
of it.
"""
CPU_SECONDS = 20
"""The maximum processor time of a desk process, in seconds. A file of 50 MB takes two seconds."""
_SAMPLE = b'{"nbformat": 4, "metadata": {}, "cells": [{"cell_type": "code", "source": "x"}]}'
_WALL_SECONDS = 600.0
"""Time limit in seconds of wall time. A desk cannot sleep, so this is reached only if the whole machine was stopped."""
_ATTEMPTS = 3
_AS_SAVED = "Save the notebook in JupyterLab and hand in that file."
_TOO_LONG = f"To read the file takes far more time than to read a notebook. {_AS_SAVED}"
_NOT_READ = f"The file is not a notebook: the program that reads notebooks failed on it. {_AS_SAVED}"


class DeskFailed(GradingError):
    """No file can be read on this machine, so the files are not at fault. The message says what to do."""


class Desk:
    """The fork server of desk processes, and the box that they enter.

    The server and the box end with this object, or with this process.

    Args:
        module: The module that a desk process runs.
        extra: More environment variables.

    """

    def __init__(self, module: str = MODULE, extra: Mapping[str, str] | None = None) -> None:
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

    def answer(self, data: bytes) -> bytes:
        """Let a new desk process read the bytes of a file, and return its document, which is not yet checked.

        Raises:
            UnreadableSubmission: The desk process failed because of the file.
            ChannelClosed: No answer came, for a reason other than the file.
        """
        with in_memory(data) as source, in_memory() as answer:
            code = self.ask(source, answer, LARGEST_DOCUMENT + 1)
            if code:
                raise UnreadableSubmission(_TOO_LONG if code == -signal.SIGXCPU else _NOT_READ)
            return os.pread(answer, min(os.fstat(answer).st_size, LARGEST_DOCUMENT + 1), 0)

    def ask(
        self, source: int, answer: int, most: int, seconds: int = 0, call: Mapping[str, Any] | None = None
    ) -> int:
        """Let a new desk read one file and write into another, and return its exit code.

        Args:
            source: The descriptor of the file.
            answer: The descriptor of an empty file.
            most: The limit in bytes of the answer.
            seconds: The limit in seconds of the processor time; that of a notebook by default.
            call: What the program of the desk is told.

        Raises:
            ChannelClosed: The desk was lost or killed, and the file is not the reason.
        """
        entrance = Entrance(
            cwd="/",
            environment=base_environment(),
            boxed=self.is_boxed,
            rlimits={"RLIMIT_AS": MEMORY_BYTES, "RLIMIT_FSIZE": most, "RLIMIT_CORE": 1},
            call=call or {},
            reader_seconds=seconds or CPU_SECONDS,
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


@contextlib.contextmanager
def in_memory(data: bytes = b"") -> Iterator[int]:
    """Give the descriptor of a file in memory with these bytes.

    Raises:
        ChannelClosed: They do not fit into memory.
    """
    descriptor = os.memfd_create("desk")
    try:
        if os.pwrite(descriptor, data, 0) < len(data):
            raise ChannelClosed("the file does not fit into memory")
        yield descriptor
    finally:
        os.close(descriptor)


_changing = threading.Lock()
_desks: list[Desk] = []


def read_notebook(data: bytes) -> tuple[Sequence[SubmittedCell], int]:
    """Return the cells of a file that was handed in, and the number of cells that were left out.

    Raises:
        UnreadableSubmission: The file is not a notebook. The message is a sentence for the student.
        DeskFailed: No file can be read on this machine.
    """
    return checked(_answer(data))


def checked(document: bytes) -> tuple[Sequence[SubmittedCell], int]:
    """Return the cells in a desk's document, and the number left out. Raises the same errors as read_notebook."""
    try:
        read = admitted_notebook(document)
    except Forged as error:
        raise UnreadableSubmission(_NOT_READ) from error
    if isinstance(read, Unreadable):
        raise UnreadableSubmission(read.reason)
    return read.cells, read.left_out


def why_unreadable(data: bytes) -> str:
    """Return why a file cannot be read as a notebook, in words for the student; empty if it can be read."""
    try:
        read_notebook(data)
    except UnreadableSubmission as error:
        return str(error)
    return ""


def _answer(data: bytes) -> bytes:
    reason = ""
    for _ in range(_ATTEMPTS):
        desk = None
        try:
            desk = _desk()
            return desk.answer(data)
        except (ChannelClosed, NoSandbox, OSError) as error:
            reason = str(error)
            _forget(desk)
    raise DeskFailed(
        f"No file that was handed in can be read here: {reason}. Mostly the machine is short of memory: end other "
        "programs, and type the command again."
    )


def _desk() -> Desk:
    """Return the desk of this process, which is started when it is first needed."""
    with _changing:
        if not _desks:
            desk = Desk()
            try:
                # Tried before the first student's file, so that a failure here is not blamed on a file.
                checked(desk.answer(_SAMPLE))
            except UnreadableSubmission as error:
                desk.close()
                raise ChannelClosed(f"not even a sample ({error})") from error
            _desks.append(desk)
        return _desks[0]


def _forget(desk: Desk | None) -> None:
    with _changing:
        if desk in _desks:
            _desks.remove(desk)
            desk.close()


@atexit.register
def _close() -> None:
    """End the desks that were started."""
    for desk in _desks:
        desk.close()
