"""Each common pitfall that a notebook boxes has a card: a student who falls into it is told so."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
import re2

from autograder import course
from autograder.appeals.replaying import replay
from autograder.authoring.answer_bank import answers
from autograder.cards.text_rendering import card_text
from tests.measure import evidence

TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
BOXED = re2.compile(r"> \*\*Common pitfall\.\*\* (.*)")
ROWS = [tuple(row) for boxes in TABLE.values() for rows in boxes.values() for row in rows]


def test_each_pitfall_of_a_notebook_stands_in_the_table_and_each_of_the_table_in_a_notebook() -> None:
    missing = {
        lab.parent.name: left
        for lab in course.root().glob("solutions/*/*/lab.md")
        if (
            left := _unmatched(
                BOXED.findall(lab.read_text(encoding="utf-8")), list(TABLE.get(lab.parent.name, {}))
            )
        )
    }
    assert missing == {}


def _unmatched(boxes: list[str], beginnings: list[str]) -> list[str]:
    unlisted = [box for box in boxes if not any(box.startswith(beginning) for beginning in beginnings)]
    gone = [beginning for beginning in beginnings if not any(box.startswith(beginning) for box in boxes)]
    return unlisted + gone


@pytest.mark.parametrize(("wrong", "words"), ROWS)
def test_the_card_of_who_falls_into_a_pitfall_says_what_the_notebook_warned_of(
    wrong: str, words: str
) -> None:
    exercise, _, name = wrong.partition("/")
    (answer,) = (one for one in answers([exercise]) if one.diagnoses and one.file.stem == name)
    record = evidence.record_of(answer, evidence.kept(exercise).get(answer.name))
    assert words in " ".join(card_text(replay(record.seen).now).split())
