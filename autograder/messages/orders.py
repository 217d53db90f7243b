"""Between the grader and its judge process: one JSON line each way, on a socket or pipe that no notebook has."""

from __future__ import annotations

import msgspec

from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)


class Open(msgspec.Struct, tag="open", frozen=True):
    """Answer one check of this exercise from now on.

    Attributes:
        exercise: The exercise's id.
        seed: What its random inputs are drawn from.
        record: Record a reference output instead of judging against one.
        workspaces: The socket of the grader's side of checks of workspaces, as the judge sees it; empty where there is
            none.
        evidence: Hand over, with the verdict, what it follows from.
        boxed: Judge and notebook are in boxes. Nobody else is on their network, so that a domain whose ports are taken
            is free all the same; and the notebook is a submission, which hears no verdict.
    """

    exercise: str
    seed: str
    record: bool = False
    workspaces: str = ""
    evidence: bool = False
    boxed: bool = False


class Close(msgspec.Struct, tag="close", frozen=True):
    """Answer no check any more, and report the result of the last one."""


class Report(msgspec.Struct, frozen=True):
    """The result of a check.

    Attributes:
        verdict: The judge's verdict; None where nobody asked or the judge had trouble.
        reference: The reference output as text, when recording.
        trouble: Why there is no verdict, in words; empty where nobody asked.
        evidence: What the verdict follows from, as :mod:`autograder.judge.verdicts.keeping` packs it; empty where it
            was not asked for.
        crowded: It did not pass, and that may be because the machine was crowded.
        unfinished: The trouble is that the judge was still at work when its time was over.
    """

    verdict: Verdict | None = None
    reference: str | None = None
    trouble: str = ""
    evidence: bytes = b""
    crowded: bool = False
    unfinished: bool = False


Order = Open | Close
