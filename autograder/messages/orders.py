"""The messages between the grader and the judge process: an order and its answer, on a socket that no notebook has."""

from __future__ import annotations

import msgspec

from autograder.verdict import Verdict  # noqa: TC001  (msgspec reads the annotations)


class Open(msgspec.Struct, tag="open", frozen=True):
    """An order to allow the notebook one check of this exercise.

    Attributes:
        exercise: The exercise's id.
        seed: The seed of the random inputs.
        record: True to record a reference output instead of judging.
        workspaces: The path at which the judge reaches the socket of the grader's workspace service; empty if there
            is none.
        evidence: True to add the evidence to the report.
        boxed: True if judge and notebook are in sandboxes, as for a submission. No other program is on the network of
            the sandboxes, so a ROS domain is free even if its ports seem to be in use. The judge reports the verdict
            only to the grader (:class:`autograder.messages.checks.Judged` says why).
    """

    exercise: str
    seed: str
    record: bool = False
    workspaces: str = ""
    evidence: bool = False
    boxed: bool = False


class Close(msgspec.Struct, tag="close", frozen=True):
    """An order to end the opened check and to report its result."""


class Report(msgspec.Struct, frozen=True):
    """The result of a check.

    Attributes:
        verdict: The judge's verdict; None if no check was requested or the judge failed.
        reference: The reference output as text, after a recording.
        trouble: Why there is no verdict, as a text for people; empty if there is one, or if no check was requested.
        evidence: The evidence, as :mod:`autograder.judge.verdicts.keeping` packs it; empty if it was not requested.
        crowded: True if the subject did not pass, perhaps because the machine was overloaded.
        unfinished: True if there is no verdict because the judge's time was over.
    """

    verdict: Verdict | None = None
    reference: str | None = None
    trouble: str = ""
    evidence: bytes = b""
    crowded: bool = False
    unfinished: bool = False


Order = Open | Close
