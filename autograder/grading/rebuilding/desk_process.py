"""The desk: a process in a box that parses the file of one student, and does nothing else.

It is forked by the fork server (:mod:`autograder.boxes.fork_server`), with the system call filter for readers. It
gets the bytes of one file, and answers with a document of typed cells or with the reason why there are none. A file
can be crafted to keep a parser busy or to use up memory; the limits of this process then end it. Callers use
:mod:`autograder.grading.rebuilding.desk`.
"""

from __future__ import annotations

import gc
import os
from typing import TYPE_CHECKING, Any

import msgspec

from autograder.grading.rebuilding.parsing import parse
from autograder.grading.rebuilding.submission import (
    LONGEST_REASON,
    ReadNotebook,
    Unreadable,
    UnreadableSubmission,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

SAMPLE = (
    b'\xef\xbb\xbf{"nbformat": 4, "metadata": {}, "cells": [{"cell_type": "markdown", "source": ["\\ud800"], '
    b'"metadata": {"nbgrader": {"grade_id": "a", "grade": true}}, "attachments": {"a.png": {"image/png": "aa=="}}}]}'
)
"""A notebook that makes a desk load everything that it loads at first use."""
_PIECE = 1 << 20


def prepare() -> None:
    """Load everything that a desk needs, because the desk itself cannot open files."""
    # Garbage collection off: nothing made here can be freed before the end, and it would be checked again and again.
    gc.disable()
    for data in (SAMPLE, b"[", b"\xff"):
        answer_to(data)


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Parse one file, and write the answer.

    Args:
        call: Not used.
        descriptors: The submitted file, and an empty file for the answer.
    """
    del call
    source, answer = descriptors
    document = memoryview(answer_to(os.pread(source, os.lseek(source, 0, os.SEEK_END), 0)))
    while document:
        document = document[os.write(answer, document[:_PIECE]) :]


def answer_to(data: bytes) -> bytes:
    """Return the document about a file, as JSON."""
    document: ReadNotebook | Unreadable
    try:
        cells, left_out = parse(data)
        document = ReadNotebook(tuple(cells), left_out)
    except UnreadableSubmission as error:
        document = Unreadable(str(error)[:LONGEST_REASON])
    except MemoryError:
        document = Unreadable("Reading the file takes far more memory than reading a notebook.")
    return msgspec.json.encode(document)
