"""Judges the light at the dark door: the lamp of Exercise 1.2, by a node that stays in its namespace."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from exercise_1_2 import lamp

from autograder.kit import Criterion, Finding

if TYPE_CHECKING:
    from autograder.kit import Evidence

HALL = "/hall/"


def stays(evidence: Evidence) -> Finding:
    """Decide whether a node was in the namespace of the hall."""
    surveys = evidence.main.of("interface", "graph")
    nodes = list(dict.fromkeys(name for survey in surveys for name in survey.data["nodes"]))
    return Finding(
        any(name.startswith(HALL) for name in nodes), f"a node in {HALL}", ", ".join(nodes) or "no node"
    )


EXERCISE = replace(
    lamp.EXERCISE,
    id="bugs_1._door",
    criteria=[*lamp.EXERCISE.criteria, Criterion("hall", "Stays in the namespace /hall", 2.0, stays)],
    text={},
    counts={},
)
