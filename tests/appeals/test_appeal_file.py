"""Appeal files: a person reads them, and what is no whole one is named."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import msgspec
import pytest

from autograder.appeals import appeal_file
from autograder.appeals.appeal_file import Appeal, AppealedCell

if TYPE_CHECKING:
    from pathlib import Path


def test_what_was_written_is_read_back(file: Path, appeal: Appeal) -> None:
    assert appeal_file.read(file) == appeal


def test_a_file_says_that_it_proves_nothing_and_has_no_mark_that_could_be_taken_for_a_proof(
    file: Path,
) -> None:
    content = json.loads(file.read_text(encoding="utf-8"))
    assert "proves nothing by itself" in content["about"]
    assert "mark" not in content


def test_a_person_finds_each_thing_on_a_line(file: Path) -> None:
    lines = file.read_text(encoding="utf-8").splitlines()
    assert ' "student": "ada",' in lines
    assert any('"text": ["class TalkerNode(Node):", "    pass"]' in line for line in lines)
    messages = [line for line in lines if '"kind": "message"' in line]
    assert len(messages) > 3
    for line in messages:
        assert json.loads(line.rstrip(","))["name"] == "/chatter"


def test_nothing_in_it_turns_a_line_around_or_moves_the_cursor(appeal: Appeal, tmp_path: Path) -> None:
    evil = "# \u202e tset \x9b31m \u2028 \udc80 \U000e0001 \N{LATIN SMALL LETTER E WITH ACUTE}"
    odd = msgspec.structs.replace(appeal, solution=[AppealedCell("cell", [evil])])
    file = tmp_path / "odd.json"
    file.write_bytes(appeal_file.dump(odd))
    text = file.read_text(encoding="utf-8")
    assert all(map(str.isprintable, text.split("\n")))
    assert "\N{LATIN SMALL LETTER E WITH ACUTE}" in text
    assert appeal_file.read(file) == odd


def test_another_layout_and_a_mark_of_earlier_files_change_nothing(file: Path, appeal: Appeal) -> None:
    content = {"mark": "0" * 64, **json.loads(file.read_text(encoding="utf-8"))}
    file.write_text(json.dumps(content, indent=4), encoding="utf-8")
    assert appeal_file.read(file) == appeal


def test_a_cut_file_says_what_to_do(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-200])
    with pytest.raises(
        appeal_file.BadAppeal, match=r"only a part of one.*./course appeal CLASS STUDENT EXERCISE"
    ):
        appeal_file.read(file)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\x89MCAP0\r\n", "is not an appeal file"),
        (b"", "is not an appeal file"),
        (b"[" * 100_000, "is not an appeal file"),
        (b"[]", "is JSON, but not an appeal file"),
        (b'{"exercise": "lab_1_2.talker"}', "is JSON, but not an appeal file"),
        (b'{"format": "ros2-course-appeal-1"}', "is not a valid appeal file"),
        (b'{"format": "ros2-course-appeal-0"}', "not an appeal file of this version"),
    ],
)
def test_a_foreign_file_is_named(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "foreign"
    path.write_bytes(content)
    with pytest.raises(appeal_file.BadAppeal, match=words):
        appeal_file.read(path)


def test_no_file_and_a_file_without_end_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(appeal_file.BadAppeal, match="cannot be read: No such file"):
        appeal_file.read(tmp_path / "none.json")
    monkeypatch.setattr(appeal_file, "MAX_BYTES", 10)
    path = tmp_path / "large.json"
    path.write_bytes(b"x" * 11)
    with pytest.raises(appeal_file.BadAppeal, match="larger than any appeal file"):
        appeal_file.read(path)
