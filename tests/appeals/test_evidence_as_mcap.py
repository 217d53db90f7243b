"""The events of a check as MCAP, each on its topic and at its time."""

from __future__ import annotations

import io
import json
import math
from typing import Any

from mcap.reader import make_reader
from rclpy.serialization import deserialize_message
from std_msgs.msg import String

from autograder.appeals.evidence_as_mcap import write_bag, write_messages
from autograder.judge.evidence_files import Kept, KeptLook
from autograder.kit.evidence import Event, Part
from autograder.verdict import State, Verdict

VERDICT = Verdict("lab_1_2.talker", "Talker", State.FAILED, 3.0, 10.0, seconds=2.0)


def written(*parts: list[Event]) -> list[tuple[Any, Any, Any]]:
    looks = [KeptLook(False, [Part(f"part {place}", {}, list(part)) for place, part in enumerate(parts)])]
    stream = io.BytesIO()
    assert write_messages(Kept(100.0, "", VERDICT, looks), stream) == sum(map(len, parts))
    stream.seek(0)
    return list(make_reader(stream).iter_messages(log_time_order=False))


def test_parts_stand_one_after_the_other_from_the_beginning_of_the_check() -> None:
    found = written(
        [Event(0.5, "log", "n", {"text": "a"}), Event(1.5, "log", "n", {"text": "b"})],
        [Event(0.25, "log", "n", {"text": "c"}, 7.5)],
    )
    assert [message.log_time / 1e9 for _, _, message in found] == [98.5, 99.5, 99.75]
    judges = [json.loads(message.data)["_judge"] for _, _, message in found]
    assert [(one["part"], one["t"], one["sim"], one["look"]) for one in judges] == [
        ("part 0", 0.5, None, "quick"),
        ("part 0", 1.5, None, "quick"),
        ("part 1", 0.25, 7.5, "quick"),
    ]


def test_each_thing_has_its_topic_and_its_type() -> None:
    graph = {
        "publisher": {"/chatter": "std_msgs/msg/String"},
        "subscription": {"/chatter": "std_msgs/msg/Int32"},
    }
    found = written(
        [
            Event(0.1, "interface", "graph", graph),
            Event(0.2, "message", "/chatter", {"fields": {"data": "a"}, "number": 1}),
            Event(0.3, "sent", "/chatter", {"fields": {"data": 1}}),
            Event(0.4, "asked", "/add", {"call": 0, "fields": {"a": 1}}),
            Event(0.5, "goal_answer", "/count", {"goal": 0, "accepted": True}),
            Event(0.6, "log", "talker", {"text": "x", "level": 20}),
            Event(0.7, "subject", "exited", {"code": 1}),
        ]
    )
    assert [(channel.topic, schema.name) for schema, channel, _ in found] == [
        ("/judge/interface", "interface"),
        ("/chatter", "std_msgs/msg/String"),
        ("/chatter", "std_msgs/msg/Int32"),
        ("/add/asked", "asked"),
        ("/count/goal_answer", "goal_answer"),
        ("/rosout", "log"),
        ("/judge/subject", "subject"),
    ]
    message = json.loads(found[1][2].data)
    assert (message["data"], message["_judge"]["number"]) == ("a", 1)


def test_a_schema_says_what_is_in_all_messages_of_a_topic() -> None:
    fields = [
        {"x": 1, "names": []},
        {"x": 0.5, "names": ["a"], "odd": None},
        {"inner": {"y": True}, "odd": 1},
    ]
    found = written([Event(0.1, "message", "/t", {"fields": one}) for one in [*fields, {"odd": "text"}]])
    schema = json.loads(found[0][0].data)
    assert schema["type"] == "object"
    del schema["properties"]["_judge"]
    assert schema["properties"] == {
        "x": {"type": "number"},
        "names": {"type": "array", "items": {"type": "string"}},
        "inner": {"type": "object", "properties": {"y": {"type": "boolean"}}},
        "odd": {"type": "string"},
    }


def test_a_bag_has_the_messages_of_topics_alone_and_counts_those_of_unknown_types() -> None:
    graph = {"publisher": {"/chatter": "std_msgs/msg/String", "/odd": "no_such_msgs/msg/Odd"}}
    events = [
        Event(0.1, "interface", "graph", graph),
        Event(0.2, "message", "/chatter", {"fields": {"data": "a"}, "number": 1}),
        Event(0.3, "message", "/odd", {"fields": {"data": 1}}),
        Event(0.4, "message", "/nowhere", {"fields": {"data": 1}}),
        Event(0.5, "message", "/chatter", {"fields": {"dta": "a type that has changed since"}}),
        Event(0.6, "log", "talker", {"text": "x", "level": 20}),
    ]
    stream = io.BytesIO()
    kept = Kept(100.0, "", VERDICT, [KeptLook(False, [Part("", {}, events)])])
    assert write_bag(kept, stream) == (1, 3)
    stream.seek(0)
    ((schema, channel, message),) = make_reader(stream).iter_messages()
    assert (channel.topic, channel.message_encoding, message.log_time) == ("/chatter", "cdr", 98_200_000_000)
    assert schema is not None
    assert (schema.name, schema.encoding) == ("std_msgs/msg/String", "ros2msg")
    assert deserialize_message(message.data, String).data == "a"


def test_a_number_that_is_none_is_still_json() -> None:
    ((_, _, message),) = written([Event(0.1, "message", "/scan", {"fields": {"range": math.inf}})])
    assert json.loads(message.data, parse_constant=lambda _: 1 / 0)["range"] == {"$float": "inf"}
