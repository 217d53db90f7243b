"""Lets a desk, a process in a box, read an archive or a list, so that this process parses none of their bytes."""

from __future__ import annotations

import functools
import signal

import msgspec

from autograder.boxes.channel import ChannelClosed
from autograder.boxes.desk import KeptDesk, answer_in, in_memory
from autograder.boxes.sandbox import why_impossible
from autograder.grading.collecting.reading.lists import ListEntry

desk = KeptDesk("autograder.grading.collecting.reading.desk_program", attempts=1)
_CPU_SECONDS = 200
"""The limit in seconds of the processor time for one archive, or one list."""
_LARGEST_LIST = 50_000_000
"""The limit in bytes of the answer about a list."""


def without_sandbox() -> str:
    """Return why archives or lists were read without a sandbox; empty if nothing was read without a sandbox."""
    return why_impossible() if desk.is_unboxed else ""


def unpack(source: int, answer: int, limits: tuple[int, int, int, int], most: int) -> int:
    """Unpack an archive; see :class:`autograder.grading.collecting.reading.unpack.Unpacking`.

    Args:
        source: The descriptor of the archive.
        answer: The descriptor of an empty file.
        limits: The limits of :class:`autograder.grading.collecting.reading.unpack.Unpacking`.
        most: The limit in bytes of the answer.

    Returns:
        The exit code: the number of the error if the answer could not be written; negative or 1 if a limit was
        exceeded.
    """
    return _ask(source, answer, most, limits=limits)


@functools.lru_cache(maxsize=16)  # one command needs each list several times
def read_list(name: str, data: bytes) -> list[ListEntry] | None:
    """Return the entries of a list; None if its form is unknown, or if a limit was exceeded.

    Args:
        name: The file's name.
        data: The bytes of the file.
    """
    with in_memory(data) as source, in_memory() as answer:
        if _ask(source, answer, _LARGEST_LIST, name=name):
            return None
        document = answer_in(answer, _LARGEST_LIST)
    try:
        return msgspec.json.decode(document, type=list[ListEntry] | None)
    except msgspec.MsgspecError:
        return None


def _ask(source: int, answer: int, most: int, **call: object) -> int:
    try:
        return desk.ask(source, answer, most, _CPU_SECONDS, call)
    except ChannelClosed:  # the system has killed the desk, usually because memory is short
        return -signal.SIGKILL
