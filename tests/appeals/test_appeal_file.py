"""Appeal files: a person reads them, what is no whole one is named, and none takes much memory."""

from __future__ import annotations

import io
import json
import resource
import subprocess
from typing import TYPE_CHECKING, Any
from zipfile import ZIP_DEFLATED, ZIP_LZMA, ZipFile

import pytest

from autograder.appeals import appeal_file
from autograder.appeals.appeal_file import AppealedCell, AppealedCheck
from autograder.judge import evidence_files
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

CHECK = AppealedCheck("ada", "a", "n", "Do it.", "course", [])
MEMORY = 700_000_000
"""Bytes of address space, with the 170 million of the interpreter and its modules; the first file took 1.6 billion."""


def test_what_was_written_is_read_back(file: Path, evidence: bytes) -> None:
    appeal = appeal_file.read(file)
    assert appeal.check.solution == [AppealedCell("TalkerNode", ["class TalkerNode(Node):", "    pass"])]
    assert appeal.seen == evidence_files.unpack(evidence)


def test_a_person_finds_the_check_each_event_on_a_line_and_the_page(file: Path) -> None:
    with ZipFile(file) as whole:
        files = {name: whole.read(name).decode() for name in whole.namelist()}
    assert "proves nothing by itself" in json.loads(files["check.json"])["about"]
    assert ' "student": "ada",' in files["check.json"].splitlines()
    messages = [row for row in map(json.loads, files["evidence.jsonl"].splitlines()) if "message" in row]
    assert len(messages) > 3
    assert {row[2] for row in messages} == {"/chatter"}
    assert files["page.html"] == "<p>a page"


def test_nothing_in_it_turns_a_line_around_or_moves_the_cursor(evidence: bytes, tmp_path: Path) -> None:
    evil = "# \u202e tset \x9b31m \u2028 \udc80 \U000e0001 \x1b[2J"
    check = AppealedCheck(evil, "a", "n", "Do it.", "course", [AppealedCell("cell", [evil])])
    file = tmp_path / "odd.zip"
    file.write_bytes(appeal_file.dump(check, evidence, {}))
    with ZipFile(file) as whole:
        assert all(map(str.isprintable, whole.read("check.json").decode().split("\n")))
    assert appeal_file.read(file).check == check


def zipped(**files: bytes) -> bytes:
    whole = io.BytesIO()
    with ZipFile(whole, "w", ZIP_DEFLATED) as file:
        for name, data in files.items():
            file.writestr(name.replace("_", "."), data)
    return whole.getvalue()


@pytest.mark.parametrize(
    "content",
    [
        b"\x89MCAP0\r\n",
        b"",
        b'{"format": "ros2-course-appeal-1"}',
        zipped(other=b""),
        zipped(check_json=b"{}", evidence_jsonl=b""),
        zipped(check_json=b"[" * 100_000, evidence_jsonl=b""),
        zipped(check_json=json.dumps({"student": 3}).encode(), evidence_jsonl=b"[]"),
    ],
)
def test_a_foreign_file_is_named_with_what_to_type(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "foreign"
    path.write_bytes(content)
    with pytest.raises(appeal_file.BadAppeal, match=r"not an appeal file.*appeal CLASS STUDENT EXERCISE"):
        appeal_file.read(path)


def test_a_cut_file_says_what_to_do(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-200])
    with pytest.raises(appeal_file.BadAppeal, match=r"only a part of one.*appeal CLASS STUDENT EXERCISE"):
        appeal_file.read(file)


def test_no_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(appeal_file.BadAppeal, match="cannot be read: No such file"):
        appeal_file.read(tmp_path / "none.zip")


def _wide(row: bytes) -> Callable[[bytes], bytes]:
    return lambda lines: lines.replace(
        b'"cut": ""', b'"x": [' + row * (100_000_000 // len(row)) + b'0], "cut": ""'
    )


def _widest(row: bytes) -> Callable[[bytes], bytes]:
    """As wide as evidence may be."""
    most = evidence_files.MAX_LINES_BYTES - 200_000
    return lambda lines: lines.replace(b'"cut": ""', b'"x": [' + row * (most // len(row)) + b'0], "cut": ""')


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("evidence.jsonl", _wide(b"[],")),
        ("evidence.jsonl", _widest(b"[],")),
        ("evidence.jsonl", _widest(b'{"":0},')),
        ("evidence.jsonl", _widest(b'"\xc3\xa4b",')),
        ("check.json", lambda _: b'{"x": [' + b"[]," * 20_000_000),
        (
            "check.json",
            lambda data: data.replace(
                b'"solution": [', b'"solution": [' + b'{"cell":"","text":[]},' * 180_000
            ),
        ),
    ],
)
def test_no_file_takes_much_memory(
    file: Path, edit: Any, name: str, change: Callable[[bytes], bytes]
) -> None:
    edit(name, change)
    child = python_child("-m", "autograder", "replay", str(file))
    done = subprocess.run(
        child.command,
        env=child.environment,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY)),
    )
    assert "MemoryError" not in done.stderr
    assert done.returncode in (0, 2), done.stderr


def test_a_larger_file_and_other_kinds_of_compression_are_not_opened(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = io.BytesIO()
    with ZipFile(whole, "w", ZIP_LZMA) as lzma:
        lzma.writestr("check.json", b"{}")
    (other := file.with_name("other.zip")).write_bytes(whole.getvalue())
    with pytest.raises(appeal_file.BadAppeal, match="compressed in another way"):
        appeal_file.read(other)
    monkeypatch.setattr(appeal_file, "MAX_BYTES", 10)
    with pytest.raises(appeal_file.BadAppeal, match="larger than any appeal file"):
        appeal_file.read(file)
