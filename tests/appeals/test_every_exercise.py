"""For each exercise: an appeal file of what the judge has seen brings the same verdict, and all is in the MCAP."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING

import msgspec
import pytest
from mcap.reader import make_reader
from rclpy.serialization import deserialize_message

from autograder import exercises
from autograder.appeals import appeal_file
from autograder.appeals.evidence_as_mcap import write_bag, write_messages
from autograder.appeals.replaying import replay
from autograder.authoring.answer_bank import answers
from autograder.judge.bench.ros_interfaces import filled, interface, to_data
from autograder.judge.evidence_files import Kept, plain
from tests.measure import evidence

if TYPE_CHECKING:
    from pathlib import Path

ANSWERS = [
    next(
        answer
        for answer in answers([exercise_id])
        if answer.short_name.startswith(kind) and "syntax_error" not in answer.diagnoses
    )
    for exercise_id in exercises.all_ids()
    for kind in ("right", "wrong")
]


@pytest.fixture(scope="module", params=ANSWERS, ids=lambda answer: answer.name)
def seen(request: pytest.FixtureRequest) -> Kept:
    """What the judge saw of a right and of a wrong answer to each exercise, with what it says of that today."""
    answer = request.param
    seen = evidence.record_of(answer, evidence.kept(answer.exercise).get(answer.name)).seen
    return msgspec.structs.replace(seen, verdict=replay(seen).now)


def test_an_appeal_file_brings_the_same_verdict_again(seen: Kept, tmp_path: Path) -> None:
    file = tmp_path / "appeal.json"
    file.write_bytes(
        appeal_file.dump(appeal_file.Appeal("ada", "a", "n", "Do it.", "course", [], None, seen=seen))
    )
    again = replay(appeal_file.read(file).seen)
    assert (again.differences, again.notes) == ([], [])
    # The whole verdict, the words and the timeline included.
    assert again.now == seen.verdict


def test_the_mcap_holds_the_messages_of_the_transcript(seen: Kept, tmp_path: Path) -> None:
    path = tmp_path / "check.mcap"
    with path.open("wb") as stream:
        count = write_messages(seen, stream)
    with path.open("rb") as stream:
        read = [
            (channel.topic, schema.encoding if schema else "", json.loads(message.data))
            for schema, channel, message in make_reader(stream).iter_messages()
        ]
    events = [event for look in seen.looks for part in look.parts for event in part.events]
    assert count == len(read) == len(events)
    assert {encoding for _, encoding, _ in read} == {"jsonschema"}
    found = Counter(told(data["_judge"]["kind"], data["_judge"]["name"], without(data)) for *_, data in read)
    fields = [plain(event.data.get("fields", {})) for event in events]
    assert found == Counter(told(e.kind, e.name, f) for e, f in zip(events, fields, strict=True))
    for topic, _, data in read:
        if data["_judge"]["kind"] in ("message", "sent"):
            assert topic == data["_judge"]["name"]


def test_the_bag_holds_the_messages_of_topics_as_ros_writes_them(seen: Kept, tmp_path: Path) -> None:
    path = tmp_path / "bag.mcap"
    with path.open("wb") as stream:
        written, left_out = write_bag(seen, stream)
    events = [event for look in seen.looks for part in look.parts for event in part.events]
    on_topics = [event for event in events if event.kind in ("message", "sent")]
    assert (written, left_out) == (len(on_topics), 0)
    with path.open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        read = [(schema, channel, message) for schema, channel, message in reader.iter_messages() if schema]
    assert {(schema.encoding, channel.message_encoding) for schema, channel, _ in read} <= {
        ("ros2msg", "cdr")
    }
    # As ROS itself reads them. What the judge sent has only the fields that it has filled in.
    heard = Counter(
        (
            channel.topic,
            json.dumps(to_data(deserialize_message(message.data, interface(schema.name))), sort_keys=True),
        )
        for schema, channel, message in read
    )
    types = {channel.topic: schema.name for schema, channel, _ in read}
    assert heard == Counter(
        (
            event.name,
            json.dumps(to_data(filled(interface(types[event.name])(), event.data["fields"])), sort_keys=True),
        )
        for event in on_topics
    )


def without(data: dict[str, object]) -> dict[str, object]:
    return {key: value for key, value in data.items() if key != "_judge"}


def told(kind: str, name: str, fields: object) -> tuple[str, str, str]:
    return kind, name, json.dumps(fields, sort_keys=True)
