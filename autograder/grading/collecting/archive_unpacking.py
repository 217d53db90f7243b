"""Unpacks an archive in a desk, a process in a box, because an archive may be made to do harm.

The answer contains, for each file, a line of JSON and then the bytes of the file. The line has the size of the file,
and the paths that lead to the file: ``["src.zip", "lab_1_2.ipynb"]`` for a file in an archive inside the archive. If a
file is not taken, the line has the reason.
"""

from __future__ import annotations

import bz2  # noqa: F401  (tarfile imports these three when it needs them, and a desk can open no file)
import gzip  # noqa: F401
import io
import json
import lzma  # noqa: F401
import stat
import tarfile
import zipfile
from dataclasses import dataclass
from functools import partial
from typing import IO, TYPE_CHECKING, NamedTuple

import re2

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence


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


def rehearse() -> None:
    """Load everything that :func:`read` needs, because a desk itself cannot open files."""
    "".encode("cp437")


def read(file: IO[bytes], depth: int, files: int, unpacked: int, of_one: int) -> Iterator[bytes]:
    """Unpack an archive, and the archives in it. The limits hold for all of them together.

    Args:
        file: The archive.
        depth: The maximum number of archives inside one another; 1 to leave archives inside the archive packed.
        files: The maximum number of files.
        unpacked: The maximum size of all files together, in bytes.
        of_one: The maximum size of one file, in bytes.
    """
    return _Unpacking(depth, files, unpacked, of_one).unpack([], file)


@dataclass
class _Unpacking:
    depth: int
    files: int
    unpacked: int
    of_one: int

    def unpack(self, names: Sequence[str], file: IO[bytes]) -> Iterator[bytes]:
        try:
            entries = _entries(file)
        except Exception as error:
            yield _refused(names, f"the archive cannot be read: {_told(error)}; get the archive again")
            return
        size = sum(one.size for one in entries)
        if len(entries) > self.files or size > self.unpacked:
            yield _refused(
                names,
                f"the archive has {len(entries)} files of {size / 1e6:.0f} MB, but only {self.files} files of "
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
            yield _refused(names, f"the archive {EMPTY}")
        if kept and all(one.is_encrypted for one in kept):
            yield _refused(names, ENCRYPTED)
            return
        for one in kept:
            yield from self._take([*names, one.name[: 2 * LONGEST_NAME]], one)

    def _take(self, names: Sequence[str], one: _Entry) -> Iterator[bytes]:
        if reason := self._reason_against(one):
            yield _refused(names, reason)
            return
        try:
            with one.open() as file:
                data = file.read(one.size + 1)
        except Exception as error:
            yield _refused(names, f"it cannot be unpacked: {_told(error)}")
            return
        if len(names) < self.depth and is_archive(one.name, data):
            yield from self.unpack(names, io.BytesIO(data))
        else:
            yield _line(names, len(data))
            yield data

    def _reason_against(self, one: _Entry) -> str:
        if not one.is_ordinary:
            return "the file is a link, or not an ordinary file"
        if one.is_encrypted:
            return ENCRYPTED
        if one.size > self.of_one:
            return f"it unpacks to {one.size / 1e6:.0f} MB; the limit is {self.of_one / 1e6:.0f} MB"
        return ""


def _refused(names: Sequence[str], reason: str) -> bytes:
    return _line(names, 0, reason)


def _line(names: Sequence[str], size: int, reason: str = "") -> bytes:
    line = json.dumps({"names": names, "size": size, "reason": reason}, ensure_ascii=False)
    # A name in a tar may be in any encoding; its unknown bytes are lone surrogates, which the reader would refuse.
    return line.encode("utf-8", "replace") + b"\n"


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
