"""Unpacks one archive. It runs in a box, because only this process relies on what the archive says.

``python -I -S unpack.py ARCHIVE DEPTH FILES BYTES OF_ONE`` writes files to standard output, up to these limits. Each
file is a line of JSON followed by the file's bytes. The line contains the size and the names: one name for each
archive inside another. If a file is not taken, the line contains the reason. Nothing else of the package is imported
here.
"""

from __future__ import annotations

import io
import json
import os
import resource
import stat
import sys
import tarfile
import zipfile
from functools import partial
from typing import IO, TYPE_CHECKING, BinaryIO, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_MEMORY = 600_000_000
"""The memory limit in bytes. Some compression methods unpack a few hundred bytes to more than this in one step, which
then fails.
"""
_CPU_SECONDS = 200
_TARS = (".tar", ".tgz", ".tar.gz", ".tar.bz2", ".tar.xz")
_LEFT_BY_PROGRAMS = ("__MACOSX", ".git", ".ipynb_checkpoints", "__pycache__", ".DS_Store")
"""Files that operating systems and editors leave next to a student's work."""
EMPTY = "holds no file, or only what programs leave beside a work"
"""The reason why an archive or folder was not taken, if it contains nothing to take."""
LONGEST_NAME = 1_000
"""The maximum length of a path in characters. A zip may have paths of 65,535, too long to print."""
LONGEST_LINE = 50_000
"""The maximum length of the line about a file, in bytes. It has up to three names, each of which may exceed
:data:`LONGEST_NAME` when escaped.
"""


def is_archive(name: str, data: bytes) -> bool:
    """Return True if a file is an archive to be opened. Office documents, which are zips as well, are not opened."""
    lower = name.lower()
    plain = "." not in lower or lower.endswith((".txt", ".bin"))
    return ".zip" in lower or lower.endswith(_TARS) or (plain and data.startswith(b"PK\x03\x04"))


def is_left_by_a_program(name: str) -> bool:
    """Return True for a name that programs use and no student chose."""
    return name in _LEFT_BY_PROGRAMS or name.startswith("._")


class _Entry(NamedTuple):
    name: str
    size: int
    is_ordinary: bool
    open: Callable[[], IO[bytes]]


def _entries(file: BinaryIO) -> list[_Entry]:
    """Return the files that an archive lists."""
    if tarfile.is_tarfile(file):
        file.seek(0)
        tar = tarfile.open(fileobj=file)  # noqa: SIM115  (its files are read from it)
        return [
            _Entry(one.name, one.size, one.isreg(), partial(_opened, tar, one))
            for one in tar
            if not one.isdir()
        ]
    archive = zipfile.ZipFile(file)
    return [
        _Entry(_name_of(one), one.file_size, _is_ordinary(one), partial(archive.open, one))
        for one in archive.infolist()
        if not one.is_dir()
    ]


def _opened(tar: tarfile.TarFile, one: tarfile.TarInfo) -> IO[bytes]:
    return tar.extractfile(one) or io.BytesIO()


def _name_of(one: zipfile.ZipInfo) -> str:
    """Return the name as it was meant: many programs write UTF-8 without saying so."""
    try:
        return one.filename if one.flag_bits & 0x800 else one.filename.encode("cp437").decode("utf-8")
    except UnicodeError:
        return one.filename


def _is_ordinary(one: zipfile.ZipInfo) -> bool:
    return stat.S_IFMT(one.external_attr >> 16) in (0, stat.S_IFREG)


class _Unpacking:
    """Unpacks an archive, and the archives in it, within common limits.

    Args:
        depth: The maximum nesting of archives. With 1, archives inside this one are left packed.
        files: The number of files that may still be unpacked.
        unpacked: The number of bytes that may still be unpacked.
        of_one: The maximum size of one file in bytes.
    """

    def __init__(self, depth: int, files: int, unpacked: int, of_one: int) -> None:
        self.depth, self.files, self.unpacked, self.of_one = depth, files, unpacked, of_one

    def unpack(self, names: Sequence[str], file: BinaryIO) -> None:
        try:
            entries = _entries(file)
        except Exception as error:
            _tell(
                names,
                reason=f"it is not an archive that can be read: {error or type(error).__name__}; get it again",
            )
            return
        size = sum(one.size for one in entries)
        if len(entries) > self.files or size > self.unpacked:
            _tell(
                names,
                reason=f"it has {len(entries)} files that unpack to {size / 1e6:.0f} MB, and {self.files} files of "
                f"{self.unpacked / 1e6:.0f} MB may still be unpacked: ask for the notebook alone",
            )
            return
        self.files -= len(entries)
        self.unpacked -= size
        kept = [
            one
            for one in entries
            if not any(map(is_left_by_a_program, one.name.replace("\\", "/").split("/")))
        ]
        if not kept and self.depth > 1:  # if a whole download is empty, the folder is reported instead
            _tell(names, reason=f"it {EMPTY}")
        for one in kept:
            self._take([*names, one.name[: 2 * LONGEST_NAME]], one)

    def _take(self, names: Sequence[str], one: _Entry) -> None:
        if not one.is_ordinary:
            _tell(names, reason="it is a link, or not an ordinary file")
            return
        if one.size > self.of_one:
            megabytes = f"{one.size / 1e6:.0f} MB; the limit is {self.of_one / 1e6:.0f} MB"
            _tell(names, reason=f"it unpacks to {megabytes}")
            return
        try:
            with one.open() as file:
                data = file.read(one.size + 1)
        except Exception as error:
            _tell(names, reason=f"it cannot be unpacked: {error or type(error).__name__}")
            return
        if len(names) < self.depth and is_archive(one.name, data):
            self.unpack(names, io.BytesIO(data))
        else:
            _tell(names, data)


def _tell(names: Sequence[str], data: bytes = b"", reason: str = "") -> None:
    """Write a file, or the reason why it is not taken. If writing fails, end the process with the error's number."""
    out = sys.stdout.buffer
    try:
        out.write(json.dumps({"names": names, "size": len(data), "reason": reason}).encode() + b"\n" + data)
        out.flush()
    except OSError as error:
        os._exit(error.errno or 1)


def main() -> None:
    """Read the limits from the command line, and unpack."""
    path, *numbers = sys.argv[1:]
    unpacking = _Unpacking(*map(int, numbers))
    written = max(unpacking.unpacked, 0) + max(unpacking.files, 0) * LONGEST_LINE + LONGEST_LINE
    limits = {resource.RLIMIT_AS: _MEMORY, resource.RLIMIT_CPU: _CPU_SECONDS, resource.RLIMIT_FSIZE: written}
    for kind, most in limits.items():
        resource.setrlimit(kind, (most, most))
    with open(path, "rb") as file:  # noqa: PTH123  (nothing more is imported)
        unpacking.unpack([], file)


if __name__ == "__main__":
    main()
