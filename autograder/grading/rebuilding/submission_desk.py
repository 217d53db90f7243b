"""Reads the notebooks that students handed in. Each file is parsed by a desk, which is a separate process in a box.

.. code-block:: python

    cells, left_out = read_notebook(read_bytes(path), directory.state)

The document that a desk makes of a file is kept in the class, under a hash of the file. So `grade` and
`collect` parse a file once, also over several runs and after an update of the course.

Even if a file takes over its desk, it can only change what is read from this one file, because a document is checked
each time that it is used: it must be one that a desk could have made from a notebook. If the document is impossible, or
the desk fails on the file, the file counts as unreadable.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import inspect
import os
import signal
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder.boxes.admission import NotAdmitted, admitted
from autograder.boxes.box_connection import ChannelClosed
from autograder.cards.readable_text import paragraph
from autograder.execution import executed_cells
from autograder.grading.grading_errors import GradingError
from autograder.grading.rebuilding import submitted_notebook
from autograder.grading.rebuilding.file_desk import READERS, desk
from autograder.grading.rebuilding.submitted_notebook import (
    LONGEST_REASON,
    MAX_BYTES,
    ReadNotebook,
    Unreadable,
    UnreadableSubmission,
)
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from autograder.grading.rebuilding.submitted_notebook import SubmittedCell


_DOCUMENTS = "documents"
_PARTS = (importlib.import_module(READERS["submission"]), submitted_notebook, executed_cells)
_VERSION = hashlib.sha256("".join(map(inspect.getsource, _PARTS)).encode()).digest()
"""A hash of the code that makes a document from a file. Another version of this code makes each document again."""
CPU_SECONDS = 20
"""The maximum processor time of a desk process, in seconds. A file of 50 MB takes two seconds."""
LARGEST_DOCUMENT = MAX_BYTES + 14_000_000
"""The maximum size of a desk's document, in bytes. It is larger than the limit for a student's file, because the
document is JSON, in which a character of text takes up to 6 bytes. A picture is equally long in both.
"""
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
    kept = state / _DOCUMENTS / _name(hashlib.sha256(data).hexdigest())
    # A missing or damaged document is made again.
    with contextlib.suppress(OSError, zlib.error, NotAdmitted):
        again: ReadNotebook = admitted(zlib.decompress(kept.read_bytes()), ReadNotebook, LARGEST_DOCUMENT)
        return again.cells, again.left_out
    kinds = ReadNotebook | Unreadable
    try:
        read = desk.read("submission", data, kinds, most=LARGEST_DOCUMENT, seconds=CPU_SECONDS)
    except NotAdmitted as error:
        raise UnreadableSubmission(_TOO_LONG if error.code == -signal.SIGXCPU else _NOT_READ) from error
    except ChannelClosed as error:
        raise GradingError(
            f"No submitted file can be read on this machine: {error}. Usually the machine is short of memory: end "
            "other programs, and type the command again."
        ) from error
    if isinstance(read, Unreadable):
        raise UnreadableSubmission(paragraph(read.reason, LONGEST_REASON))
    with contextlib.suppress(OSError):  # for example, the class may only be read
        write_whole(kept, zlib.compress(msgspec.json.encode(read), 1))
    return read.cells, read.left_out


def forget_documents(state: Path, needed: Iterable[str]) -> None:
    """Remove the kept documents of a class, except those of some files.

    A document that another process needs nevertheless is made again.

    Args:
        state: The class's folder for the grader's own files.
        needed: The SHA-256 of each file, hexadecimal.
    """
    names = set(map(_name, needed))
    for document in (state / _DOCUMENTS).glob(
        "[!.]*"
    ):  # a process may be writing a file that begins with a dot
        if document.name not in names:
            with contextlib.suppress(OSError):
                document.unlink()


def _name(content: str) -> str:
    """Return the name of the document of a file with this SHA-256."""
    return hashlib.sha256(_VERSION + content.encode()).hexdigest()
