"""A replay as lines for a person."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.appeals.appeal_file import Appeal
    from autograder.appeals.replaying import Replay
    from autograder.verdict import Verdict


def lines(appeal: Appeal, again: Replay) -> Iterator[str]:
    """What came of a replay, the answer first."""
    then = again.then
    at = datetime.fromtimestamp(appeal.seen.at, tz=UTC)
    yield f"{then.exercise} by {appeal.student}, checked {at:%Y-%m-%d %H:%M:%S} UTC with course {appeal.course[:8]}"
    yield f"then: {_told(then)}"
    yield f"now:  {_told(again.now)}"
    if again.differences:
        yield "another verdict:"
        yield from (f"  {line}" for line in again.differences)
    else:
        yield "the same verdict, points and diagnosis"
    yield from (f"note: {note}" for note in again.notes)
    yield "note: the file proves nothing by itself, anybody can write one; `./course appeal` writes it from the class"


def _told(verdict: Verdict) -> str:
    diagnosis = f", {verdict.diagnosis.key}" if verdict.diagnosis else ""
    return f"{verdict.state}, {verdict.score:g} of {verdict.max_score:g} points{diagnosis}"
