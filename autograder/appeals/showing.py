"""A replay as lines for a person."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.appeals.appeal_file import Opened
    from autograder.appeals.replaying import Replay
    from autograder.verdict import Verdict


def lines(opened: Opened, again: Replay) -> Iterator[str]:
    """What came of a replay, the answer first."""
    appeal, then = opened.appeal, again.then
    at = datetime.fromtimestamp(appeal.seen.at, tz=UTC)
    yield f"{then.exercise} by {appeal.student}, checked {at:%Y-%m-%d %H:%M:%S} UTC with course {appeal.course[:8]}"
    yield f"then: {_told(then)}"
    yield f"now:  {_told(again.now)}"
    if again.differences:
        yield "another verdict:"
        yield from (f"  {line}" for line in again.differences)
    else:
        yield "the same verdict, points and diagnosis"
    if opened.edited:
        yield "note: this file was changed after it was written; `./course appeal` writes the true one again"
    yield from (f"note: {note}" for note in again.notes)


def _told(verdict: Verdict) -> str:
    diagnosis = f", {verdict.diagnosis.key}" if verdict.diagnosis else ""
    return f"{verdict.state}, {verdict.score:g} of {verdict.max_score:g} points{diagnosis}"
