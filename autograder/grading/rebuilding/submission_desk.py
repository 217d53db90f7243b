"""Reads the notebooks that students handed in. Each file is parsed by a desk, which is a separate process in a box.

.. code-block:: python

    cells, left_out = read_notebook(read_bytes(path), directory.state)

The document that a desk makes of a file is kept in the class, under a hash of the file. So `grade`, `collect` and
`similar` parse a file once, also over several runs and after an update of the course.

Even if a file takes over its desk, it can only change what is read from this one file, because the desk's document is
checked each time that it is used: it must be one that a desk could have made from a notebook. If the document is
impossible, or the desk fails on the file, the file counts as unreadable.
"""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import os
import signal
import sys
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.box_connection import ChannelClosed
from autograder.boxes.reading_desks import KeptDesk, answer_in, in_memory
from autograder.cards.readable_text import paragraph
from autograder.execution import executed_cells
from autograder.execution.executed_cells import IMAGES
from autograder.grading.grading_errors import GradingError
from autograder.grading.rebuilding import submitted_notebook
from autograder.grading.rebuilding.notebook_parsing import BASE64
from autograder.grading.rebuilding.submitted_notebook import (
    LONGEST_REASON,
    MAX_BYTES,
    MAX_CHARACTERS,
    ReadNotebook,
    Unreadable,
    UnreadableSubmission,
)
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.boxes.reading_desks import Desk
    from autograder.grading.rebuilding.submitted_notebook import SubmittedCell


_PARSER = "autograder.grading.rebuilding.notebook_parsing"
_DOCUMENTS = "documents"
_PARTS = (sys.modules[_PARSER], submitted_notebook, executed_cells)
_VERSION = hashlib.sha256("".join(map(inspect.getsource, _PARTS)).encode()).digest()
"""A hash of the code that makes a document from a file. Another version of this code makes each document again."""
CPU_SECONDS = 20
"""The maximum processor time of a desk process, in seconds. A file of 50 MB takes two seconds."""
_LARGEST_DOCUMENT = MAX_BYTES + 14_000_000
"""The maximum size of a desk's document, in bytes. It is larger than the limit for a student's file, because the
document is JSON, in which a character of text takes up to 6 bytes. A picture is equally long in both.
"""
_SAMPLE = b'{"nbformat": 4, "metadata": {}, "cells": [{"cell_type": "code", "source": "x"}]}'
_AS_SAVED = "Save the notebook in JupyterLab and hand in that file."
_TOO_LONG = f"Reading the file takes far more time than reading a notebook. {_AS_SAVED}"
_NOT_READ = f"The file is not a notebook: the program that reads notebooks failed on it. {_AS_SAVED}"


def read_notebook(data: bytes, state: Path = Path(os.devnull)) -> tuple[Sequence[SubmittedCell], int]:
    """Return the valid cells of a submitted file, and the number of invalid cells that were left out.

    Args:
        data: The bytes of the file.
        state: The class's folder for the grader's own files, in which the document of a file that can be read is kept;
            by default no document is kept.

    Raises:
        UnreadableSubmission: The file is not a notebook. The message is a sentence for the student.
        GradingError: No file can be read on this machine.
    """
    kept = state / _DOCUMENTS / hashlib.sha256(_VERSION + data).hexdigest()
    # A missing or damaged document is made again.
    with contextlib.suppress(OSError, zlib.error, UnreadableSubmission):
        return checked(zlib.decompress(kept.read_bytes()))
    try:
        document = document_of(_desk, data)
        read = checked(document)
    except ChannelClosed as error:
        raise GradingError(
            f"No submitted file can be read on this machine: {error}. Usually the machine is short of memory: end "
            "other programs, and type the command again."
        ) from error
    with contextlib.suppress(OSError):  # for example, the class may only be read
        write_whole(kept, zlib.compress(document, 1))
    return read


def document_of(desk: Desk | KeptDesk, data: bytes) -> bytes:
    """Let a desk process read the bytes of a file, and return the desk's document, which is not checked yet.

    Raises:
        UnreadableSubmission: The desk process failed because of the file.
        ChannelClosed: No answer came, for a reason other than the file.
    """
    with in_memory(data) as source, in_memory() as answer:
        code = desk.ask(source, answer, _LARGEST_DOCUMENT + 1, CPU_SECONDS)
        if code:
            raise UnreadableSubmission(_TOO_LONG if code == -signal.SIGXCPU else _NOT_READ)
        return answer_in(answer, _LARGEST_DOCUMENT + 1)


def checked(document: bytes) -> tuple[Sequence[SubmittedCell], int]:
    """Check a desk's document, and return its cells and the number of invalid cells that the desk left out.

    Raises:
        UnreadableSubmission: The file is not a notebook, or no unmodified desk would make this document.
    """
    if len(document) > _LARGEST_DOCUMENT:
        raise UnreadableSubmission(_NOT_READ)
    try:
        read = msgspec.json.decode(document, type=ReadNotebook | Unreadable)
    except (msgspec.MsgspecError, RecursionError, UnicodeError) as error:
        raise UnreadableSubmission(_NOT_READ) from error
    if isinstance(read, Unreadable):
        raise UnreadableSubmission(paragraph(read.reason, LONGEST_REASON))
    pictures = (picture for cell in read.cells for picture in cell.pictures)
    if sum(len(cell.source) for cell in read.cells) > MAX_CHARACTERS or not all(
        kind in IMAGES and BASE64.fullmatch(data) for _, kind, data in pictures
    ):
        raise UnreadableSubmission(_NOT_READ)
    return read.cells, read.left_out


def _rehearse(desk: Desk) -> None:
    """Let a new desk read a sample, to find out whether this machine, and not a student's file, causes failures."""
    try:
        checked(document_of(desk, _SAMPLE))
    except UnreadableSubmission as error:
        raise ChannelClosed(f"not even a sample ({error})") from error


_desk = KeptDesk(_PARSER, rehearse=_rehearse)
