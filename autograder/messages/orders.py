"""Between the grader and its judge process: one JSON line each way, on a socket or pipe that no notebook has."""

from __future__ import annotations

import msgspec

from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)


class Open(msgspec.Struct, tag="open", frozen=True):
    """From now on one check of this exercise is answered.

    Attributes:
        exercise: The exercise's id.
        seed: What its random inputs are drawn from.
        record: Record a reference output instead of judging against one.
        workspaces: The socket of the grader's side of checks of workspaces, as the judge sees it; empty where there is
            none.
    """

    exercise: str
    seed: str
    record: bool = False
    workspaces: str = ""


class Close(msgspec.Struct, tag="close", frozen=True):
    """No check is answered any more; report what the last one brought."""


class Report(msgspec.Struct, frozen=True):
    """What a check brought.

    Attributes:
        verdict: The judge's verdict; None where nobody asked or the judge had trouble.
        reference: The reference output as text, when recording.
        trouble: Why there is no verdict, in words; empty where nobody asked.
    """

    verdict: Verdict | None = None
    reference: str | None = None
    trouble: str = ""


Order = Open | Close
