"""Sentences of the course that were untrue once, and what every reader should find: a robot, a project, two links."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cases import cases

CHAPTER = Path(__file__).resolve().parents[2] / "solutions" / "01_ros2_fundamentals"


def text_of(lab: str) -> str:
    """The master of a lab as one line, without the marks of quotations."""
    return " ".join((CHAPTER / lab / "lab.md").read_text(encoding="utf-8").replace("\n> ", "\n").split())


@pytest.mark.parametrize(
    ("lab", "untrue", "true"),
    cases(__file__, "what_was_untrue_is_said_as_it_is"),
)
def test_what_was_untrue_is_said_as_it_is(lab: str, untrue: str, true: str) -> None:
    text = text_of(lab)
    assert true in text
    assert untrue not in text


@pytest.mark.parametrize(
    ("lab", "words"),
    [
        *cases(__file__, "what_a_reader_looks_for_is_there"),
        *((lab, "robot = start_robot()") for lab in ("exercise_1_1", "exercise_1_2", "exercise_1_3")),
    ],
)
def test_what_a_reader_looks_for_is_there(lab: str, words: str) -> None:
    assert words in text_of(lab)


def test_a_class_is_copied_by_hand_into_a_program_once_and_then_by_a_command() -> None:
    copies = [lab for lab in CHAPTER.glob("*/lab.md") if "TODO: copy" in lab.read_text(encoding="utf-8")]
    assert [lab.parent.name for lab in copies] == ["lab_1_2"]
    assert text_of("lab_1_2").count("TODO: copy") == 1
