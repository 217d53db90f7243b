"""The desk: a process in a box that parses what one student handed in, and nothing else.

A fork of the fork server (:mod:`autograder.boxes.fork_server`), with the filter of readers. It gets the bytes of one
file, and answers with a document of typed cells, or with the reason why there are none. A file can be made to keep a
parser busy, or to use up memory: here the limits of the process end that. :mod:`autograder.grading.rebuilding.desk` is
the way in.
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
"""A notebook with everything that a desk loads at its first use."""
_PIECE = 1 << 20


def prepare() -> None:
    """Load what a desk needs: it can open no file itself."""
    gc.disable()  # nothing made here can be freed before the end, but the collector would check it again and again
    for data in (SAMPLE, b"[", b"\xff"):
        answer_to(data)


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Parse one file and write the answer.

    Args:
        call: Unused.
        descriptors: The submitted file, and an empty file for the answer.
    """
    del call
    source, answer = descriptors
    document = memoryview(answer_to(os.pread(source, os.lseek(source, 0, os.SEEK_END), 0)))
    while document:
        document = document[os.write(answer, document[:_PIECE]) :]


def answer_to(data: bytes) -> bytes:
    """Return the document about the bytes of a file, as JSON."""
    document: ReadNotebook | Unreadable
    try:
        cells, left_out = parse(data)
        document = ReadNotebook(tuple(cells), left_out)
    except UnreadableSubmission as error:
        document = Unreadable(str(error)[:LONGEST_REASON])
    except MemoryError:
        document = Unreadable("To read the file takes far more memory than to read a notebook.")
    return msgspec.json.encode(document)
