"""An event that the judge did not see is "not observed": no exercise fails for want of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.authoring.answer_bank import answers
from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from tests.measure import evidence

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.kit.evidence import Event, Evidence


def _kind(event: Event) -> tuple[str, object, str]:
    return event.kind, event.data.get("goal"), event.name if event.kind == "subject" else ""


def _with_less(seen: Evidence) -> Iterator[tuple[str, Evidence]]:
    """The same evidence without a part, or without a kind of event in a part, and what is missing."""
    for place, part in enumerate(seen.parts):
        before, after = seen.parts[:place], seen.parts[place + 1 :]
        yield f"part {part.name}", replace(seen, parts=[*before, *after])
        for kind in dict.fromkeys(map(_kind, part.events)):
            left = replace(part, events=[event for event in part.events if _kind(event) != kind])
            yield f"{kind} in part {part.name}", replace(seen, parts=[*before, left, *after])


@pytest.mark.slow
@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_no_exercise_needs_an_event_to_come_to_a_verdict(exercise_id: str) -> None:
    exercise, expected = exercises.get(exercise_id), evidence_files.load_reference(exercise_id)
    kept = evidence.kept(exercise_id)
    right = [a for a in answers([exercise_id]) if a.file.parent.name == "right" and a.name in kept]
    for answer in right[:1]:
        seen = evidence_files.evidence_of(evidence.record_of(answer, kept[answer.name]).seen, expected)
        for missing, less in _with_less(seen):
            try:
                deciding.decide(exercise, less, "a seed")
            except Exception as error:
                pytest.fail(f"{answer.name} without {missing}: {type(error).__name__}: {error}")
