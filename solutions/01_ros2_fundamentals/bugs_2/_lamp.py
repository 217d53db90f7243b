"""Judges the doorkeeper: the lamp of Exercise 1.2, each answer of which the doorkeeper also logs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from exercise_1_2 import lamp

from autograder.kit import Criterion, Finding

if TYPE_CHECKING:
    from autograder.kit import Evidence


def logs(evidence: Evidence) -> Finding:
    """Decide whether each answer of the lamp was logged, with any words around it."""
    part = evidence.main
    answers = [event.data["fields"]["message"] for event in part.of("response", "/lamp")]
    # A program's logger also prints the line.
    told = [[str(event.data["text"]) for event in part.of(kind)] for kind in ("log", "output")]
    found = [[answer for text in texts for answer in set(answers) if answer in text] for texts in told]
    logged = max(found, key=len)
    return Finding(
        bool(answers) and all(logged.count(answer) >= answers.count(answer) for answer in answers),
        ", ".join(answers) or "the answers of the lamp",
        ", ".join(logged) or "no answer",
    )


# The first answer comes at once, so that a callback that waits for it in vain is proven to wait.
JUDGED = lamp.LAMP(late={"/lamp": lambda random: [0.0, *lamp.delays(random)[1:]]}).exercise()
EXERCISE = replace(
    JUDGED,
    id="bugs_2._lamp",
    criteria=[*JUDGED.criteria, Criterion("logged", "Logs each answer of the lamp", 2.0, logs)],
    text={},
    counts={},
)
