"""Whatever the files in an archive are called, each comes out once, with its bytes and a path that leads nowhere."""

from __future__ import annotations

import io
import os
import zipfile
from collections import Counter

import pytest
from downloads import tarred
from hypothesis import example, given
from hypothesis import strategies as st

from autograder.boxes.reading_desks import in_memory
from autograder.grading.collecting import archive_unpacking
from autograder.grading.collecting.archive_unpacking import LONGEST_NAME, is_archive, is_left_by_a_program
from autograder.grading.collecting.downloaded_files import _lines, _path
from tests.drawn import drawn

PARTS = st.sampled_from(
    ["..", ".", "", "C:", "a", "b.ipynb", "ä", "e\u0301", ".git", "~$x", "a\\b", "ab" * 40, "\n"]
)
NAMES = st.lists(PARTS | st.text(max_size=5), min_size=1, max_size=5).map("/".join)
FILES = st.lists(st.tuples(NAMES, st.binary(max_size=3)), max_size=6)


def zipped(files: list[tuple[str, bytes]]) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as made:
        for name, content in files:
            info = zipfile.ZipInfo()
            info.filename = name  # as it is: what the constructor takes out, another program writes
            made.writestr(info, content)
    return data.getvalue()


def unpacked(archive: bytes) -> list[tuple[tuple[str, ...], bytes]]:
    """What a desk writes about an archive, and what the grader reads of it."""
    with in_memory(archive) as source, in_memory() as answer:
        file = open(source, "rb", closefd=False)  # noqa: SIM115
        os.write(answer, b"".join(archive_unpacking.read(file, 1, 100, 10_000, 10_000)))
        with open(answer, "rb", closefd=False) as out:
            lines = [*_lines(out)]
            assert not [line.reason for line, _ in lines if line.reason]
            return [(line.names, os.pread(answer, line.size, place)) for line, place in lines]


def taken(files: list[tuple[str, bytes]]) -> list[tuple[str, bytes]]:
    """The files that are neither folders nor archives nor left by a program. A name ends at a NUL."""
    return [
        (name, content)
        for name, content in files
        if name.strip("/") and "\0" not in name and not name.endswith("/") and not is_archive(name, content)
        if not any(map(is_left_by_a_program, name.replace("\\", "/").split("/")))
    ]


@pytest.mark.filterwarnings("ignore:Duplicate name")
@drawn(40)
@given(FILES)
@example(
    [("../../etc/passwd", b"1"), ("/etc/passwd", b"2"), ("a/../../b", b"3"), ("..\\b", b"4"), ("..", b"5")]
)
@example([("b.ipynb", b"1"), ("b.ipynb", b"2")])
def test_each_file_comes_out_once_and_its_path_leads_nowhere(files: list[tuple[str, bytes]]) -> None:
    for pack in (zipped, tarred):
        found = unpacked(pack(taken(files)))
        assert Counter(found) == Counter(((name,), content) for name, content in taken(files))
        for (name,), _ in found:
            path = _path(name)
            assert path
            assert sum(map(len, path)) <= LONGEST_NAME
            assert path == (name,) or not {"", ".", ".."} & set(path)
            assert path == (name,) or not any("/" in part or "\\" in part for part in path)
