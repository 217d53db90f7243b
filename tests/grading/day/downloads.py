"""What learning management systems let an instructor download, made by this program for tests."""

from __future__ import annotations

import io
import tarfile
import unicodedata
import zipfile
from typing import TYPE_CHECKING, Literal

from autograder.grading.collecting.submitted_file_names import read_lms_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from autograder.grading.collecting.submitted_file_names import NameFacts

ROSTER = """\
id,first_name,last_name,email,canvas,github
ada,Ada,Lovelace,ada.love@uni.example,101,adalove
ben,Ben,Bär,ben@uni.example,102,
jose,José,Núñez,jose@uni.example,103,josen
eve,Eve,O'Neill,eve@uni.example,104,
zoe,Zoë,Zuse,zoe@uni.example,105,zz-top
"""


class Link(str):
    """What a file of a zip is that leads to another one."""

    __slots__ = ()


BOMB = b" " * 60_000_000
"""What unpacks to more than a notebook may have."""


def read_path(parts: Sequence[str], form: str) -> NameFacts | None:
    """The facts in a path of the form of one system, by its topmost name of that form."""
    parts = [unicodedata.normalize("NFC", part) for part in parts]
    ways = (read_lms_name(parts, place, form) for place in range(len(parts)))
    return next((way for way in ways if way is not None), None)


def zipped(files: Mapping[str, bytes | str]) -> bytes:
    """A zip with these files."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name)
            if isinstance(content, Link):
                entry.external_attr = 0o120777 << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
    return data.getvalue()


def tarred(files: Iterable[tuple[str, bytes]], mode: Literal["w", "w:gz"] = "w") -> bytes:
    """A tar with these files."""
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode=mode, format=tarfile.PAX_FORMAT) as archive:
        for name, content in files:
            entry = tarfile.TarInfo(name)
            entry.size = len(content)
            archive.addfile(entry, io.BytesIO(content))
    return data.getvalue()


def write_zip(path: Path, files: Mapping[str, bytes | str]) -> Path:
    """The same as a file."""
    path.write_bytes(zipped(files))
    return path
