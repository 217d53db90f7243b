"""The program of a desk: it carries out one named request about one file of a student, and ends.

A fork server (:mod:`autograder.boxes.fork_server`) loads the readers and forks a process for each request. The process
has a filter of system calls (:func:`autograder.boxes.seccomp_filter.filter_for_readers`), so it can only read the file
and write the answer. A reader is a module with two functions:

* ``read`` gets the file and the words of the request, and yields the answer piece by piece.
* ``rehearse`` does everything once that a request may do, so that all modules and files that this needs are loaded.
"""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

REHEARSAL = "rehearsal"
"""The request to do what :func:`prepare` has done, with all limits of a desk. It has no answer."""
_readers: dict[str, Any] = {}


def prepare(*readers: str) -> None:
    """Load the readers.

    Args:
        readers: For each request ``NAME=MODULE``: its name, and the module that reads.
    """
    for name, _, module in (reader.partition("=") for reader in readers):
        _readers[name] = importlib.import_module(module)
    _rehearse()


def _rehearse() -> None:
    for reader in _readers.values():
        reader.rehearse()


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Carry out a request.

    Args:
        call: Contains ``request``, the name of the request, and ``words``, the further arguments of its reader.
        descriptors: The file, and an empty file for the answer.
    """
    source, answer = descriptors
    if call["request"] == REHEARSAL:
        _rehearse()
        return
    try:
        with open(source, "rb", closefd=False) as file, open(answer, "wb", closefd=False) as out:
            for data in _readers[call["request"]].read(file, **call["words"]):
                out.write(data)
    except OSError as error:  # the grader learns from the exit code why the answer could not be written
        os._exit(error.errno or 1)
