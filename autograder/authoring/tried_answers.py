"""What an author wants to know of one answer that was tried: what the judge saw of it, and what took long."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from autograder.authoring.answer_bank import Answer
from autograder.verdict import to_json

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from autograder.kit.evidence import Evidence

SLOW = 10.0
"""Seconds from which on a check is slow, so that its author is told which step took longest."""
LONG = 3.0
"""Seconds from which on a wait between two events is long enough to be named."""
SLOW_STEP = "the slowest step: "
"""The beginning of the remark that names it."""


@dataclass(frozen=True)
class TriedAnswer(Answer):
    """An answer that also tells its author what took long.

    Attributes:
        folder: The folder for the evidence, a file for each answer, such as ``wrong/topic_name.py.txt``, with a line
            for each event; None to write none.
    """

    folder: Path | None = None

    def verdict(self, seed: str) -> bytes:
        """Judge the answer in this process, and write its evidence into the file. Return the verdict as JSON.

        If the check was slow, the last remark says which step was.
        """
        verdict, found = self.checked(seed)
        if found is not None and self.folder is not None:
            file = self.folder / f"{self.short_name}.txt"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("".join(_transcript(found.evidence)), encoding="utf-8")
        is_slow = verdict.seconds > SLOW
        if found is not None and is_slow and (step := slowest_step(found.evidence, verdict.seconds)):
            verdict = replace(verdict, remarks=(*verdict.remarks, f"{SLOW_STEP}{step}"))
        return to_json(verdict)


def slowest_step(evidence: Evidence, seconds: float) -> str:
    """Return in words between which two events of a check most time passed; empty if no wait between two was long.

    Args:
        seconds: The duration of the check, with the build and the start of the subject, of which there are no events.
    """
    waits = [(0.0, "")]
    looks = [evidence.before, evidence] if evidence.before is not None else [evidence]
    for part, real_time in ((part, look.real_time) for look in looks for part in look):
        where = f"in “{part.name}”{', in real time' * real_time}"
        for one, other in itertools.pairwise(part.events):
            between = f"between {one.kind} {one.name} and {other.kind} {other.name}"
            waits.append((other.t - one.t, f"{where}, {between}"))
        seconds -= part.events[-1].t if part.events else 0.0
    longest, when = max(waits)
    return f"{longest:.1f} s {when}" if longest >= max(seconds, LONG) else ""


def _transcript(evidence: Evidence) -> Iterator[str]:
    if evidence.before is not None:
        yield from _transcript(evidence.before)
        yield "\n"
    for part in evidence:
        yield f"== {part.name} {'in real time ' * evidence.real_time}{dict(part.inputs)}\n"
        for event in part.events:
            stepped = f" sim {event.sim:.2f}" if event.sim is not None else ""
            yield f"{event.t:8.3f}{stepped}  {event.kind} {event.name} {dict(event.data)}\n"
