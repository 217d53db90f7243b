"""Looks at one answer that come out differently are found in what git keeps."""

from __future__ import annotations

import json

from tests.measure import evidence, history
from tests.measure.bank import answer_named

ANSWER = answer_named("lab_1_2.talker/right/usual.py")
LINE = evidence.kept(ANSWER.exercise)[ANSWER.name]
OTHER = LINE.replace("Hello, world! 3", "Hello, world! 4")


def looks(*lines: str) -> history.Looks:
    return history.looks_at({ANSWER.name: ANSWER}, lines)[ANSWER.name]


def test_two_looks_by_one_scenario_that_differ_are_chance() -> None:
    assert OTHER != LINE
    assert not history.by_chance(looks(LINE, LINE))
    assert history.by_chance(looks(LINE, OTHER))


def test_a_look_by_another_scenario_is_no_chance() -> None:
    digest = json.loads(LINE)["stimulus"]
    found = looks(LINE, OTHER.replace(digest, "0" * len(digest)))
    assert sorted(len(outcomes) for outcomes in found.values()) == [1, 1]
    assert not history.by_chance(found)


def test_a_look_at_another_program_is_left_out() -> None:
    other = LINE.replace(json.loads(LINE)["program"], "another")
    assert not history.looks_at({ANSWER.name: ANSWER}, [other])
