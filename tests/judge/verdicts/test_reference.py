"""Reference outputs on disk."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.judge import evidence_files
from autograder.kit.evidence import Event, Part, Reference

if TYPE_CHECKING:
    from pathlib import Path

REFERENCE = Reference(
    "lab_1_2.talker",
    {"publisher": {"/chatter": "std_msgs/msg/String"}, "client": {}},
    [
        Part(
            "talking",
            {},
            [
                Event(0.31, "matched", "/chatter", {"count": 1}),
                Event(
                    0.5, "message", "/chatter", {"fields": {"data": "ä 0"}, "number": 1, "sent": 1.5}, 100.5
                ),
                Event(0.6, "log", "talker_7", {"text": "ä 0"}, 100.5),
                Event(
                    0.7, "message", "/chatter", {"fields": {"data": "ä 1"}, "number": 2, "sent": 2.0}, 101.0
                ),
            ],
        )
    ],
)


def test_what_the_machine_decides_is_left_out() -> None:
    text = evidence_files.dump_reference(REFERENCE)
    assert json.loads(text)["parts"][0]["events"] == [
        {"kind": "message", "name": "/chatter", "sim": 0.0, "data": {"fields": {"data": "ä 0"}}},
        {"kind": "message", "name": "/chatter", "sim": 0.5, "data": {"fields": {"data": "ä 1"}}},
    ]
    assert "client" not in json.loads(text)["interface"]


def test_reading_and_writing_give_the_same_text() -> None:
    text = evidence_files.dump_reference(REFERENCE)
    assert evidence_files.dump_reference(evidence_files.parse_reference(json.loads(text))) == text


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_every_exercise_has_one(exercise_id: str) -> None:
    stored = evidence_files.load_reference(exercise_id)
    assert stored.exercise == exercise_id
    assert evidence_files.dump_reference(stored) == exercises.reference_path(exercise_id).read_text(
        encoding="utf-8"
    )


@pytest.mark.parametrize("content", [None, "{", "{}", '{"parts": [{"name": 1}]}'])
def test_a_missing_or_broken_one_says_what_to_do(
    content: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "talker.reference.json"
    monkeypatch.setattr(evidence_files, "reference_path", lambda _: file)
    if content is not None:
        file.write_text(content, encoding="utf-8")
    with pytest.raises(evidence_files.NoReference, match=r"./course record lab_1_2\.talker"):
        evidence_files.load_reference("lab_1_2.talker")
