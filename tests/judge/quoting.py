"""Whether the traceback and the words that a card quotes are of what the card is about, told from a check's evidence.

For any check with its evidence: one just made, one out of an appeal file, or one that was kept.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import re2

from autograder import exercises
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import without_tracebacks
from autograder.kit.output.spoken_lines import spoken_by

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence, Part
    from autograder.verdict import Verdict


def objection(verdict: Verdict, evidence: Evidence) -> str:
    """What is wrong about what a card quotes; empty where nothing is."""
    return _of_the_traceback(verdict, evidence) or _of_the_words(verdict, evidence)


def _of_the_words(verdict: Verdict, evidence: Evidence) -> str:
    """The subject's words that a card quotes are in its picture."""
    missed = [criterion.seen for criterion in verdict.criteria if not criterion.passed]
    words = " ".join((verdict.diagnosis.text if verdict.diagnosis else "", *missed))
    said = [text for part in evidence for event in part.events if (text := spoken_by(event))]
    labels = " ".join(moment.label for moment in verdict.timeline)
    for quoted in re2.findall(r"“([^”…]*\w[^”…]*)", words):
        if any(text.startswith(quoted) for text in said) and quoted[:60] not in labels:
            return f"its card quotes “{quoted}”, which is not in its picture"
    return ""


def _of_the_traceback(verdict: Verdict, evidence: Evidence) -> str:
    """Where the traceback on a card is about something else.

    It must come from one run, and the diagnosis must follow from it: where the same is diagnosed without any traceback,
    the line that the card quotes has nothing to do with it.
    """
    if not verdict.detail or verdict.diagnosis is None:
        return ""
    if not any(part.traceback.endswith(verdict.detail) for part in evidence):
        return "the traceback on the card is of no single run"
    exercise = exercises.get(verdict.exercise)
    if deciding.judge(exercise, _without(evidence), verdict.seed).diagnosis != verdict.diagnosis:
        return ""
    return (
        f"{verdict.diagnosis.key} is found without the traceback, too, that the card quotes: {verdict.detail}"
    )


def _without(evidence: Evidence) -> Evidence:
    """The same evidence, with no traceback in it."""
    before = evidence.before and _without(evidence.before)
    return replace(evidence, parts=[_quiet(part) for part in evidence], before=before)


def _quiet(part: Part) -> Part:
    """The part without tracebacks."""
    return replace(part, events=[_told(event) for _, event in without_tracebacks(part.events)])


def _told(event: Event) -> Event:
    data: dict[str, Any] = {key: value for key, value in event.data.items() if key != "traceback"}
    return replace(event, data=data)
