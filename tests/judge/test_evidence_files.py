"""Reference outputs on disk, and the evidence of a check as bytes: what comes back is what was seen."""

from __future__ import annotations

import json
import math
import random
import zlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from autograder import exercises
from autograder.judge import evidence_files
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.verdict import State, Verdict

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


VERDICT = Verdict("lab_1_2.talker", "Talker", State.PASSED, 10.0, 10.0, seed="s")
EXPECTED = Reference("lab_1_2.talker", {})


def packed(*events: Event, before: Evidence | None = None) -> bytes:
    seen = Evidence([Part("talking", {"order": 4}, events)], EXPECTED, before is not None, before)
    return evidence_files.pack(VERDICT, seen, "abc", at=1.5)


def back(data: bytes) -> Evidence:
    return evidence_files.evidence_of(evidence_files.unpack(data), EXPECTED)


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_what_is_expected_of_each_exercise_comes_back_as_it_is(exercise_id: str) -> None:
    stored = evidence_files.load_reference(exercise_id)
    seen = Evidence(stored.parts, stored)
    kept = evidence_files.unpack(
        evidence_files.pack(VERDICT, seen, evidence_files.reference_digest(exercise_id), at=1.5)
    )
    found = evidence_files.evidence_of(kept, stored)
    assert [(part.name, part.inputs, list(part.events)) for part in found] == [
        (part.name, part.inputs, list(part.events)) for part in seen
    ]
    assert (kept.at, kept.verdict, kept.cut) == (1.5, VERDICT, "")
    assert kept.reference == evidence_files.reference_digest(exercise_id)


def test_the_record_of_the_solution_in_a_class_s_drawing_comes_back() -> None:
    practice = replace(EXPECTED, parts=[Part("drawing 0")])
    drawn = Part("drawing 0f1e", {}, [Event(0.0, "noted", "/level", {"values": [[1]]})])
    seen = Evidence([Part("drawing 0f1e", {}, [Event(0.1, "noted", "/level", {"values": [[2]]})])], practice)
    evidence = Evidence(seen.parts, practice, real_time=True, before=seen)
    found = evidence_files.evidence_of(
        evidence_files.unpack(evidence_files.pack(VERDICT, evidence, "abc", at=1.5, expected=[drawn])),
        practice,
    )
    assert found.reference.parts == [drawn]
    assert found.before is not None
    assert found.before.reference.parts == [drawn]
    assert [list(look.parts) for look in (found.before, found)] == [list(seen.parts)] * 2


def test_evidence_of_an_earlier_course_is_judged_with_the_practice_drawings() -> None:
    practice = replace(EXPECTED, parts=[Part("drawing 0"), Part("drawing 1")])
    data = evidence_files.pack(VERDICT, Evidence([Part("drawing 1")], practice), "abc", at=1.5)
    assert b"the solution" not in evidence_files.lines_of(data)
    found = evidence_files.evidence_of(evidence_files.unpack(data), practice)
    assert found.reference is practice


def test_both_looks_come_back() -> None:
    first = Evidence([Part("talking", {}, [Event(0.1, "log", "n", {"text": "first"})])], EXPECTED)
    found = back(packed(Event(0.25, "log", "n", {"text": "second"}, 100.5), before=first))
    assert found.real_time
    assert found.before is not None
    assert not found.before.real_time
    assert [e.data["text"] for e in (*found.before.main.events, *found.main.events)] == ["first", "second"]
    assert (found.main.events[0].sim, found.main.inputs) == (100.5, {"order": 4})


@pytest.mark.parametrize(
    "data",
    [
        {"text": "a lone surrogate \ud800 and ü"},
        {"fields": {"data": math.inf, "more": [-math.inf, 1e300, 5e-324, 0.1 + 0.2]}},
        {"fields": {"big": 2**63 - 1, "none": None, "yes": True}},
        {},
    ],
)
def test_whatever_is_in_an_event_comes_back(data: dict[str, Any]) -> None:
    assert list(back(packed(Event(0.1, "message", "/chatter", data))).main.events) == [
        Event(0.1, "message", "/chatter", data)
    ]


def test_a_number_that_is_none_comes_back() -> None:
    found = back(packed(Event(0.1, "message", "/scan", {"fields": {"range": math.nan}})))
    assert math.isnan(found.main.events[0].data["fields"]["range"])


def test_what_is_no_json_at_all_costs_no_evidence() -> None:
    found = back(packed(Event(0.1, "message", "/x", {"odd": {1, 2}})))
    assert found.main.events[0].data == {"odd": "{1, 2}"}


@pytest.mark.parametrize("text", ["the same again and again " * 40, ""])
def test_a_flood_is_cut_and_says_so(text: str) -> None:
    chance = random.Random(1)
    flood = [
        Event(i / 10, "log", "talker", {"text": text or chance.randbytes(400).hex(), "number": i})
        for i in range(20_000)
    ]
    data = packed(*flood)
    assert len(data) <= evidence_files.MAX_BYTES + 1000
    assert len(zlib.decompress(data, 31)) <= evidence_files.MAX_RAW_BYTES + 1000
    kept = evidence_files.unpack(data)
    seen = kept.looks[0].parts[0].events
    assert 100 < len(seen) < 20_000
    assert [event.data["number"] for event in seen] == list(range(len(seen)))
    assert f"the last {20_000 - len(seen)} of 20003 lines are missing" in kept.cut
    assert kept.verdict == VERDICT


def test_a_single_event_that_is_too_large_is_left_out() -> None:
    large = Event(0.1, "log", "talker", {"text": random.Random(1).randbytes(evidence_files.MAX_BYTES).hex()})
    kept = evidence_files.unpack(packed(Event(0.0, "log", "talker", {"text": "small"}), large))
    assert [event.data["text"] for event in kept.looks[0].parts[0].events] == ["small"]
    assert kept.cut


@pytest.mark.parametrize(
    "spoilt",
    [
        lambda data: b"",
        lambda data: b"not gzip at all",
        lambda data: data[:-20],
        lambda data: data[:-4],
        lambda data: data[:40] + b"xxxx" + data[44:],
        lambda data: zlib.compress(b"{}", wbits=31),
        lambda data: zlib.compress(b"[1]\n[2]\n[3]", wbits=31),
        lambda data: zlib.compress(b"[" * 100_000, wbits=31),
        lambda data: zlib.compress(bytes(3 * evidence_files.MAX_RAW_BYTES), wbits=31),
    ],
)
def test_what_is_no_evidence_is_named(spoilt: Any) -> None:
    with pytest.raises(evidence_files.NoEvidence):
        evidence_files.unpack(spoilt(packed(Event(0.1, "log", "talker", {"text": "x"}))))


def test_where_nothing_was_seen_there_is_nothing_to_decide() -> None:
    empty = evidence_files.Kept(1.5, "abc", VERDICT, [])
    with pytest.raises(evidence_files.NoEvidence):
        evidence_files.evidence_of(empty, EXPECTED)


def test_what_mutants_do_is_unpacked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    exercise_id = next(one for one in exercises.all_ids() if exercises.mutants_path(one).exists())
    first = evidence_files.load_reference(exercise_id)

    def fails(_: object) -> str:
        raise AssertionError("hashed again")

    monkeypatch.setattr(evidence_files, "parts_digest", fails)
    assert first.mutants is not None
    assert evidence_files.load_reference(exercise_id) == first
    assert evidence_files.load_reference(exercise_id, mutants=False) == replace(first, mutants=None)
