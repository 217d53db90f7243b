"""A desk of ``collect`` is a process in a box that unpacks one archive, or parses one list from an LMS.

Archives and lists are read in a box because they may be made to do harm. The process is forked like that of
:mod:`autograder.grading.rebuilding.notebook_parsing`, with the same filter of system calls.

The answer about an archive contains, for each file, a line of JSON and then the bytes of the file. The line has the
size of the file, and the paths that lead to the file: ``["src.zip", "lab_1_2.ipynb"]`` for a file in an archive inside
the archive. If a file is not taken, the line has the reason.
"""

from __future__ import annotations

import bz2  # noqa: F401  (tarfile imports these three when it needs them, and a desk can open no file)
import gzip  # noqa: F401
import io
import json
import lzma  # noqa: F401
import os
import stat
import tarfile
import zipfile
from functools import partial
from typing import IO, TYPE_CHECKING, Any, NamedTuple

import msgspec
import re2

from autograder.grading.collecting.lms_lists import parse_list
from autograder.grading.collecting.systems import GRADESCOPE

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


EMPTY = "contains no file, or only files that programs leave there"
"""The reason why an archive or folder was not taken, if it contains nothing to take."""
ENCRYPTED = "it is encrypted: unpack the archive with its password, and collect the folder"
"""The reason why an encrypted archive, or an encrypted file in an archive, was not taken."""
LONGEST_NAME = 1_000
"""The maximum length of a path in characters. It is needed because a zip may have paths of 65,535, too long to print.
"""
LONGEST_LINE = 50_000
"""The maximum length in bytes of the line of JSON about a file. It is several times :data:`LONGEST_NAME`, because the
line has up to three names, and escapes make a name longer.
"""
_TARS = (".tar", ".tgz", ".tar.gz", ".tar.bz2", ".tar.xz")


def is_archive(name: str, data: bytes) -> bool:
    """Return True if a file is an archive to be opened; False for Office documents, although they are zips as well."""
    lower = name.lower()
    plain = "." not in lower or lower.endswith((".txt", ".bin"))
    return ".zip" in lower or lower.endswith(_TARS) or (plain and data.startswith(b"PK\x03\x04"))


_LEFT_BY_PROGRAMS = re2.compile(
    rb"(?i)^(?:__MACOSX|\._.*|\.DS_Store|\.Spotlight-V100|\.Trashes|\.fseventsd|(?:eh)?thumbs\.db|desktop\.ini|"
    rb"\$RECYCLE\.BIN|~\$.*|\.~lock\..*|\.directory|@eaDir|\.git|\.ipynb_checkpoints|__pycache__)$"
)
"""The names of files that operating systems and editors leave next to a student's work."""


def is_left_by_a_program(name: str) -> bool:
    """Return True for the name of a file or folder that a program made, not the student, such as ``.git``."""
    return bool(_LEFT_BY_PROGRAMS.match(name.encode("utf-8", "replace")))


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
        call: For an archive, the ``limits`` for :class:`_Unpacking`; for a list, the ``name`` of its file.
        descriptors: The file, and an empty file for the answer.
    """
    source, answer = descriptors
    file = open(source, "rb", closefd=False)  # noqa: SIM115  (a descriptor, until the process ends)
    if "limits" in call:
        _Unpacking(answer, *call["limits"]).unpack([], file)
    else:
        _write(answer, msgspec.json.encode(parse_list(call["name"], file.read())))


class _Unpacking:
    """Unpacks an archive, and the archives in it. The limits hold for all of them together.

    Args:
        answer: The descriptor of the file to which the answer is written.
        depth: The maximum number of archives inside one another; 1 to leave archives inside the archive packed.
        files: The maximum number of files.
        unpacked: The maximum size of all files together, in bytes.
        of_one: The maximum size of one file, in bytes.
    """

    def __init__(self, answer: int, depth: int, files: int, unpacked: int, of_one: int) -> None:
        self._answer = answer
        self.depth, self.files, self.unpacked, self.of_one = depth, files, unpacked, of_one

    def unpack(self, names: Sequence[str], file: IO[bytes]) -> None:
        try:
            entries = _entries(file)
        except Exception as error:
            self._tell(
                names,
                reason=f"the archive cannot be read: {_told(error)}; get the archive again",
            )
            return
        size = sum(one.size for one in entries)
        if len(entries) > self.files or size > self.unpacked:
            self._tell(
                names,
                reason=f"the archive has {len(entries)} files of {size / 1e6:.0f} MB, but only {self.files} files of "
                f"{self.unpacked / 1e6:.0f} MB may still be unpacked: ask the student for the notebook alone",
            )
            return
        self.files -= len(entries)
        self.unpacked -= size
        kept = [
            one
            for one in entries
            if not any(map(is_left_by_a_program, one.name.replace("\\", "/").split("/")))
        ]
        # At depth 1 the archive is a whole download; if that is empty, a later step reports it.
        if not kept and self.depth > 1:
            self._tell(names, reason=f"the archive {EMPTY}")
        if kept and all(one.is_encrypted for one in kept):
            self._tell(names, reason=ENCRYPTED)
            return
        for one in kept:
            self._take([*names, one.name[: 2 * LONGEST_NAME]], one)

    def _take(self, names: Sequence[str], one: _Entry) -> None:
        if not one.is_ordinary:
            self._tell(names, reason="the file is a link, or not an ordinary file")
            return
        if one.is_encrypted:
            self._tell(names, reason=ENCRYPTED)
            return
        if one.size > self.of_one:
            megabytes = f"{one.size / 1e6:.0f} MB; the limit is {self.of_one / 1e6:.0f} MB"
            self._tell(names, reason=f"it unpacks to {megabytes}")
            return
        try:
            with one.open() as file:
                data = file.read(one.size + 1)
        except Exception as error:
            self._tell(names, reason=f"it cannot be unpacked: {_told(error)}")
            return
        if len(names) < self.depth and is_archive(one.name, data):
            self.unpack(names, io.BytesIO(data))
        else:
            self._tell(names, data)

    def _tell(self, names: Sequence[str], data: bytes = b"", reason: str = "") -> None:
        """Write a file, or the reason why it is not taken."""
        line = json.dumps({"names": names, "size": len(data), "reason": reason}, ensure_ascii=False)
        # A name in a tar may be in any encoding; its unknown bytes are lone surrogates, which the reader would refuse.
        _write(self._answer, line.encode("utf-8", "replace") + b"\n" + data)


class _Entry(NamedTuple):
    name: str
    size: int
    is_ordinary: bool
    is_encrypted: bool
    open: Callable[[], IO[bytes]]


def _entries(file: IO[bytes]) -> list[_Entry]:
    """Return the files that an archive lists."""
    if tarfile.is_tarfile(file):
        file.seek(0)
        tar = tarfile.open(fileobj=file)  # noqa: SIM115  (its files are read from it)
        return [
            _Entry(one.name, one.size, one.isreg(), False, partial(_opened, tar, one))
            for one in tar
            if not one.isdir()
        ]
    archive = zipfile.ZipFile(file)
    return [
        _Entry(
            _name_of(one),
            one.file_size,
            stat.S_IFMT(one.external_attr >> 16) in (0, stat.S_IFREG),
            bool(one.flag_bits & 0x1),
            partial(archive.open, one),
        )
        for one in archive.infolist()
        if not one.is_dir()
    ]


def _opened(tar: tarfile.TarFile, one: tarfile.TarInfo) -> IO[bytes]:
    return tar.extractfile(one) or io.BytesIO()


def _name_of(one: zipfile.ZipInfo) -> str:
    """Return the name of a file in a zip. Try UTF-8 even without the flag for UTF-8, which many programs do not set."""
    try:
        return one.filename if one.flag_bits & 0x800 else one.filename.encode("cp437").decode("utf-8")
    except UnicodeError:
        return one.filename


def _told(error: Exception) -> str:
    """Return the text of an error, cut because it may contain two names of a file, or the type if it has no text."""
    return str(error)[:LONGEST_NAME] or type(error).__name__


def _write(answer: int, data: bytes) -> None:
    """Write an answer. If writing fails, end the process with the error's number."""
    left = memoryview(data)
    while left:
        try:
            left = left[os.write(answer, left) :]
        except OSError as error:
            os._exit(error.errno or 1)
