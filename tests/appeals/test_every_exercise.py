"""For each exercise: what the judge hands over brings the same verdict again, and all of it is in the MCAP."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from mcap.reader import make_reader
from rclpy.serialization import deserialize_message

from autograder import exercises
from autograder.appeals import appeal_file, replaying
from autograder.appeals.messages_seen import write_bag, write_messages
from autograder.judge.bench.interfaces import filled, interface, to_data
from autograder.judge.verdicts.keeping import plain, unpack
from autograder.verdict import from_json

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = [pytest.mark.ros, pytest.mark.slow]
NAMES = [f"{exercise}.{kind}" for exercise in exercises.all_ids() for kind in ("right", "wrong")]


@pytest.fixture(scope="module")
def judged(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder with the evidence and the verdict of each check that this session asks for."""
    folder = tmp_path_factory.mktemp("judged")
    asking = [item for item in request.session.items if "judged" in getattr(item, "fixturenames", ())]
    names = sorted({getattr(item, "callspec").params["name"] for item in asking})  # noqa: B009  (untyped in pytest)
    root = Path(__file__).parents[2]
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.appeals.checks_with_evidence", str(folder), *names],
        cwd=root,
        start_new_session=True,
        # Tests of notebooks switch the checks of message fields on; a terminal has them off.
        env={name: value for name, value in os.environ.items() if name != "ROS_PYTHON_CHECK_FIELDS"},
    )
    try:
        assert process.wait() == 0
        yield folder
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


@pytest.mark.parametrize("name", NAMES)
def test_the_evidence_brings_the_same_verdict_again(name: str, judged: Path, tmp_path: Path) -> None:
    verdict = from_json((judged / f"{name}.json").read_bytes())
    kept = unpack((judged / name).read_bytes())
    assert verdict.passed == name.endswith("right")
    file = tmp_path / "appeal.json"
    file.write_bytes(
        appeal_file.dump(appeal_file.Appeal("ada", "a", "n", "Do it.", "course", [], None, seen=kept))
    )
    again = replaying.replay(appeal_file.read(file).seen)
    assert (again.differences, again.notes) == ([], [])
    # The whole verdict, the words and the timeline included; a replay takes no time of its own to look.
    assert plain_words(again.now) == plain_words(verdict)


def plain_words(verdict: object) -> dict[str, object]:
    import msgspec

    words: dict[str, object] = msgspec.to_builtins(verdict)
    return {key: value for key, value in words.items() if key != "seconds"}


@pytest.mark.parametrize("name", NAMES)
def test_the_mcap_holds_the_messages_of_the_transcript(name: str, judged: Path, tmp_path: Path) -> None:
    kept = unpack((judged / name).read_bytes())
    path = tmp_path / "check.mcap"
    with path.open("wb") as stream:
        count = write_messages(kept, stream)
    with path.open("rb") as stream:
        read = [
            (channel.topic, schema.encoding if schema else "", json.loads(message.data))
            for schema, channel, message in make_reader(stream).iter_messages()
        ]
    events = [event for look in kept.looks for part in look.parts for event in part.events]
    assert count == len(read) == len(events)
    assert {encoding for _, encoding, _ in read} == {"jsonschema"}
    found = Counter(told(data["_judge"]["kind"], data["_judge"]["name"], without(data)) for *_, data in read)
    fields = [plain(event.data.get("fields", {})) for event in events]
    assert found == Counter(told(e.kind, e.name, f) for e, f in zip(events, fields, strict=True))
    for topic, _, data in read:
        if data["_judge"]["kind"] in ("message", "sent"):
            assert topic == data["_judge"]["name"]


@pytest.mark.parametrize("name", NAMES)
def test_the_bag_holds_the_messages_of_topics_as_ros_writes_them(
    name: str, judged: Path, tmp_path: Path
) -> None:
    kept = unpack((judged / name).read_bytes())
    path = tmp_path / "bag.mcap"
    with path.open("wb") as stream:
        written, left_out = write_bag(kept, stream)
    events = [event for look in kept.looks for part in look.parts for event in part.events]
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
