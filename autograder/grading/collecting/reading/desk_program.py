"""A desk of ``collect`` is a process in a box that reads one archive, or one list from an LMS, and nothing else.

The process is forked like that of :mod:`autograder.grading.rebuilding.desk_process`, with the same filter of system
calls.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec

from autograder.grading.collecting.reading.lists import GRADESCOPE, parse_list
from autograder.grading.collecting.reading.unpack import Unpacking, write

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_SAMPLES = {
    "a.csv": b"identifier,grade,full name,last modified (submission)\nParticipant 1,,Ada,3 October 2025\n",
    GRADESCOPE: b"submission_1:\n  :created_at: 2025-10-03\n  :submitters:\n  - :name: Ada\n",
}
"""One small list of each format. Reading them once loads everything that a desk otherwise loads at its first use."""


def prepare() -> None:
    """Load everything that a desk needs, because a desk itself cannot open files."""
    for name, data in _SAMPLES.items():
        msgspec.json.encode(parse_list(name, data))
    "".encode("cp437")


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Read one file and write the answer.

    Args:
        call: For an archive, the ``limits`` for :class:`Unpacking`; for a list, the ``name`` of its file.
        descriptors: The file, and an empty file for the answer.
    """
    source, answer = descriptors
    file = open(source, "rb", closefd=False)  # noqa: SIM115  (a descriptor, until the process ends)
    if "limits" in call:
        Unpacking(answer, *call["limits"]).unpack([], file)
    else:
        write(answer, msgspec.json.encode(parse_list(call["name"], file.read())))
