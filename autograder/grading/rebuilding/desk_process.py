"""The desk: a process in a box that parses the file of one student, and does nothing else.

The grader starts the desk with :mod:`autograder.grading.rebuilding.desk`, and a fork server
(:mod:`autograder.boxes.fork_server`) forks it with the system call filter for readers. The desk gets the bytes of one
file, and writes a document: the cells, or the reason why the file cannot be read. If a student has crafted a file that
keeps a parser busy or uses up memory, the limits of this process end it.
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
"""A notebook that makes the parser load everything that it would otherwise load when it is first needed."""
_PIECE = 1 << 20


def prepare() -> None:
    """Load everything that a desk needs, because the desk itself cannot open files."""
    # No garbage collection: a desk process frees nothing before it ends, so searches for garbage only take time.
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
    """Return the document about a file as JSON: the cells, or the reason why the file cannot be read."""
    document: ReadNotebook | Unreadable
    try:
        cells, left_out = parse(data)
        document = ReadNotebook(tuple(cells), left_out)
    except UnreadableSubmission as error:
        document = Unreadable(str(error)[:LONGEST_REASON])
    except MemoryError:
        document = Unreadable("Reading the file takes far more memory than reading a notebook.")
    return msgspec.json.encode(document)
