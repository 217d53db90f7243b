"""An archive that ``collect`` does not open has a line that says what it is and what to do with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from downloads import tarred, write_zip, zipped
from test_collect import placed, why, work

from autograder.grading.collecting.collect import collect

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

NAMES = ("lovelaceada_101_9001_lab_1_2.ipynb", "barben_102_9002_lab_1_2.ipynb")


def download(klass: TinyClass) -> dict[str, str]:
    return {name: work(klass, points) for points, name in enumerate(NAMES)}


def encrypted(data: bytes) -> bytes:
    """A zip of which every file is marked as encrypted, in its own header and in the list."""
    changed = bytearray(data)
    for sign, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        place = changed.find(sign)
        while place >= 0:
            changed[place + flags] |= 1
            place = changed.find(sign, place + 1)
    return bytes(changed)


@pytest.mark.parametrize("form", ["zip in zip", "tar.gz", "7z", "rar", "encrypted", "tar in zip"])
def test_a_whole_download_that_is_not_opened_is_to_be_unpacked(
    klass: TinyClass, tmp_path: Path, form: str
) -> None:
    inner = zipped(download(klass))
    texts = [(file, text.encode()) for file, text in download(klass).items()]
    name, data = {
        "zip in zip": ("c.zip", zipped({"submissions.zip": inner})),
        "tar.gz": ("download.tar.gz", tarred(texts, "w:gz")),
        "7z": ("download.7z", b"7z\xbc\xaf\x27\x1c"),
        "rar": ("download.rar", b"Rar!\x1a\x07\x01\x00"),
        "encrypted": ("submissions.zip", encrypted(inner)),
        "tar in zip": ("c.zip", zipped({"Lab/submissions.tgz": tarred(texts, "w:gz")})),
    }[form]
    (tmp_path / name).write_bytes(data)
    report = collect(klass.path, [tmp_path / name])
    assert (placed(report), report.exit_code) == ({}, 2)
    (line,) = why(report).splitlines()
    assert "collect the folder" in line
    assert "under student" not in line
    assert "ZipInfo" not in line
    assert "STUDENT" not in line


def test_of_an_encrypted_archive_of_a_student_the_line_says_so(klass: TinyClass, tmp_path: Path) -> None:
    inner = encrypted(zipped({"lab_1_2.ipynb": work(klass, 3), "notes.txt": "x"}))
    report = collect(klass.path, [write_zip(tmp_path / "c.zip", {"ada/homework.zip": inner})])
    assert why(report) == (
        "c.zip/ada/homework.zip: it is encrypted: unpack the archive with its password, and collect the folder; "
        "to leave the file out, write no under use"
    )
