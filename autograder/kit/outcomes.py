"""How goals ended, as the judge saw it, and the outcomes that a program must report in a line with a word of the task.

An exercise declares its outcomes, such as ``REJECTED = Outcome("rejected")``, and its task names the same words. An
outcome counts as reported if, in the run with this outcome, the program logs, prints, raises or returns a line with the
word. But a line that, apart from numbers, also appears in runs with other outcomes does not count.

This rule has a known gap: a program also passes if, in each run, it prints a line with all words and a random word. The
judge cannot tell this from ``canceled: True`` in one run and ``canceled: False`` in the others, which is a right
report.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit.in_words import counted
from autograder.kit.mistakes.crashes import on_purpose, raised_lines
from autograder.kit.model import Advice

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from autograder.kit.evidence import Part


_ERROR_GOAL_TERMINATED = 3
"""The return code of action_msgs/srv/CancelGoal for a goal that has already ended."""
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
"""The numbers of three statuses, as defined in action_msgs/msg/GoalStatus."""
IMMEDIATELY = 0.3
"""A limit in seconds. A server that computes many numbers in less time makes no pause for each number."""
LONG_SILENCE, BURST = 1.0, 0.1
"""Seconds of work without feedback, and the share of them in which all feedback comes if it is sent at the end."""
STATUS = {
    0: "UNKNOWN",
    1: "ACCEPTED",
    2: "EXECUTING",
    3: "CANCELING",
    4: "SUCCEEDED",
    5: "CANCELED",
    6: "ABORTED",
}


@dataclass(frozen=True)
class SentGoal:
    """A goal that the judge sent, with everything that the subject's server answered.

    Attributes:
        request: The fields of the goal; None if the goal was not sent.
        accepted: True if the server accepted the goal, False if it refused; None if it did not answer.
        feedback: The fields of each feedback message that was sent before the judge had the result, in order.
        sent: For each message in ``feedback``, when it was sent, in seconds since the epoch by the publisher's clock.
        answered_at: When the server's answer to the goal arrived, by the judge's clock; None if unknown.
        cancel_answered_at: When the answer to the cancel request arrived, by the judge's clock; None if unknown.
        cancel_accepted: True if the server accepted the cancel request; None if it did not answer or none was sent.
        cancelled_too_late: True if the server answered the cancel request by saying that the goal had already ended.
        before_cancel: The number of feedback messages that arrived before the cancel request was sent.
        unread: The number of feedback messages that arrived between the cancel request and its answer.
        seconds: Wall time in seconds from the acceptance to the result; None if one of them is missing.
        status: The status that came with the result; None if no result came.
        result: The fields of the result; empty if no result came.
    """

    request: Mapping[str, Any] | None
    accepted: bool | None
    feedback: list[Mapping[str, Any]]
    sent: tuple[float, ...]
    answered_at: float | None
    cancel_answered_at: float | None
    cancel_accepted: bool | None
    cancelled_too_late: bool
    before_cancel: int
    unread: int
    seconds: float | None
    status: int | None
    result: Mapping[str, Any]

    def __str__(self) -> str:
        """Return the fields of the goal in words, such as "order 5"."""
        return ", ".join(f"{name} {value}" for name, value in (self.request or {}).items())

    def objection(self, is_right: bool, result: str) -> str:
        """Return in words why a goal did not succeed as it should; empty if it did.

        Args:
            is_right: True if the result is right.
            result: The result in words.
        """
        faults = (
            (self.accepted is None, "the goal was not answered"),
            (not self.accepted, "the goal was rejected"),
            (self.status is None, "no result"),
            (self.status != SUCCEEDED, f"status {status_text(self.status)}"),
            (not is_right, result),
        )
        # A goal that was never sent has no words.
        return next((f"{self}: {fault}".removeprefix(": ") for holds, fault in faults if holds), "")

    @property
    def was_canceled_too_late(self) -> bool:
        """True if the goal was over before the server could answer the cancel request."""
        return self.cancelled_too_late or (self.cancel_accepted is None and self.over)

    @property
    def was_over_when_canceled(self) -> bool:
        """True if the judge asked too late to cancel the goal: the server had done all of its work."""
        return self.was_canceled_too_late and self.over and not self.sent_after(self.cancel_answered_at)

    @property
    def request_fault(self) -> str:
        """What is wrong with the answer to the cancel request, in words; empty if it was accepted."""
        if self.cancel_accepted:
            return ""
        if self.cancel_accepted is None and self.status is None:
            came = counted(self.unread, "feedback message")
            return f"the cancel request was not answered, and {came} came after it"
        return f"the cancel request was not accepted; status {status_text(self.status)}"

    @property
    def over(self) -> bool:
        """True if the goal has a result, or was refused and therefore gets none."""
        return self.status is not None or self.accepted is False

    @property
    def is_quick(self) -> bool:
        """True if the server needed hardly any time for the goal."""
        return self.seconds is not None and self.seconds < IMMEDIATELY

    @property
    def cancel_is_over(self) -> bool:
        """True if the server refused to cancel the goal, or answered the request and ended the goal."""
        return self.cancel_accepted is False or (self.over and self.cancel_accepted is not None)

    @property
    def told_at_the_end(self) -> bool:
        """True if all feedback was sent at once, after seconds of work in silence."""
        if not self.pauses or self.answered_at is None:
            return False
        silent = self.sent[0] - self.answered_at
        return silent >= LONG_SILENCE and sum(self.pauses) < BURST * silent

    @property
    def pauses(self) -> tuple[float, ...]:
        """The times between successive feedback messages, in seconds."""
        return tuple(after - before for before, after in pairwise(self.sent))

    def sent_after(self, moment: float | None) -> int:
        """Return how many feedback messages were certainly sent after a moment; 0 if the moment is unknown."""
        return 0 if moment is None else sum(sent > moment for sent in self.sent)


def goal(part: Part, number: int) -> SentGoal:
    """Return the goal with a given number; the judge numbers its goals from 0."""
    events = [event for event in part.events if event.data.get("goal") == number]
    first = {event.kind: place for place, event in reversed(list(enumerate(events)))}
    data = {kind: events[place].data for kind, place in first.items()}
    result = data.get("result_heard", {})
    moments = [events[first[kind]].t for kind in ("goal_answer", "result_heard") if kind in first]
    ended_at = result.get("arrived", math.inf)
    places = [
        i for i, e in enumerate(events) if e.kind == "feedback_heard" and e.data.get("sent", 0.0) <= ended_at
    ]
    heard = [events[place] for place in places]
    split = first.get("cancel_sent", len(events))
    answered = first.get("cancel_answer", len(events))
    return SentGoal(
        request=data.get("goal_sent", {}).get("fields"),
        accepted=data.get("goal_answer", {}).get("accepted"),
        feedback=[event.data["fields"] for event in heard],
        sent=tuple(float(event.data["sent"]) for event in heard if "sent" in event.data),
        answered_at=data.get("goal_answer", {}).get("arrived"),
        cancel_answered_at=data.get("cancel_answer", {}).get("arrived"),
        cancel_accepted=data.get("cancel_answer", {}).get("accepted"),
        cancelled_too_late=data.get("cancel_answer", {}).get("return_code") == _ERROR_GOAL_TERMINATED,
        before_cancel=sum(place < split for place in places),
        unread=sum(split < place < answered for place in places),
        seconds=moments[1] - moments[0] if len(moments) == 2 else None,
        status=result.get("status"),
        result=result.get("fields", {}),
    )


def end_of(sent: SentGoal) -> str:
    """Return ``"SUCCEEDED"``, ``"CANCELED"``, ``"ABORTED"`` or ``"REJECTED"``; ``"UNKNOWN"`` if no result came."""
    return STATUS.get(sent.status or 0, "UNKNOWN") if sent.accepted else "REJECTED"


def all_goals(part: Part) -> list[SentGoal]:
    """Return all goals that the judge sent in a part."""
    return [goal(part, int(event.data["goal"])) for event in part.of("goal_sent")]


def status_text(number: int | None) -> str:
    """Return a goal's status as text, such as ``SUCCEEDED (4)``."""
    return "none" if number is None else f"{STATUS.get(number, '?')} ({number})"


_STATUS_WORD = re2.compile(r"(?i)status")
_STATUS_NUMBER = re2.compile(r"(^\D*|[:=]\s*|\bis )([0-6])\b")
"""Matches a status number in the text after the word ``status``: the first number in it, or one after a colon, an
equals sign or ``is``.
"""
_NUMBERS = re2.compile(r"[\pL\pN_.+-]*\pN[\pL\pN_.+-]*|[\[\](){},;\s]+")
"""Matches text that :func:`shape` removes: numbers, words that contain a digit (such as a goal's id), and separators in
a list of numbers.
"""


@dataclass(frozen=True)
class Outcome:
    """An outcome, and the word with which the task asks the program to report it.

    Attributes:
        word: The word, in lower case; a line may contain it in any case. If the word is the name of a goal's status,
            its number after the word ``status`` also counts.
        other: A second spelling of the word, or a second word that the task allows.

    Example::

        REJECTED = Outcome("rejected")

        def reports_rejection(evidence: Evidence) -> Finding:
            others = [part for part in evidence if part.name != "refused"]
            missing = REJECTED.missing(evidence.part("refused"), others)
            return Finding(not missing, f"a line with {REJECTED}", missing or "it was reported")
    """

    word: str
    other: str = ""

    def is_said_in(self, line: str) -> bool:
        """Return True if a line contains the word, or the status number that stands for it.

        Line breaks and other whitespace in the line count as spaces.
        """
        named = " ".join(_with_status_names(line).lower().split())
        return self.word in named or bool(self.other and self.other in named)

    def lines(self, part: Part) -> list[str]:
        """Return the lines of a run that contain the word."""
        return list(filter(self.is_said_in, all_lines(part)))

    def reported(self, part: Part, others: Iterable[Part]) -> str:
        """Return the line in the given run that reports the outcome; empty if there is none.

        Args:
            part: The run that ended with this outcome.
            others: Runs that ended with another outcome.
        """
        usual = _shapes(others)
        return next((line for line in self.lines(part) if shape(line) not in usual), "")

    def missing(self, part: Part, others: Sequence[Part]) -> str:
        """Return in words for the card what the program reported instead; empty if it reported the outcome."""
        if self.reported(part, others):
            return ""
        if told := self.lines(part):
            return f"“{told[-1]}”, which your program also says in runs with another outcome"
        return f"“{said}”" if (said := _most_telling(part, others)) else "it was not reported"

    def advice(self, part: Part, others: Sequence[Part], what: str, next_step: str) -> Advice:
        """Return the advice for a program that does not report the outcome. It quotes one of the program's lines.

        Args:
            part: The run that ended with this outcome.
            others: Runs that ended with another outcome.
            what: What happened in the run, in a clause such as ``"The goal was rejected"``.
            next_step: What the student should do about it.
        """
        asked = f"the task asks for a line with {self}"
        if told := self.lines(part):
            says = f"your program said “{told[-1]}”. But it says the same in runs with another outcome"
        elif said := _most_telling(part, others):
            says = f"your program said “{said}”; {asked}"
        else:
            says = f"your program did not report this; {asked}"
        return Advice(f"{what}, and {says}.", next_step)

    def __str__(self) -> str:
        """Return the word as the card shows it, such as "the word `rejected`"."""
        return f"the word{'s' * (' ' in self.word)} `{self.word}`"


def all_lines(part: Part) -> list[str]:
    """Return all lines of a program in a run: logged, printed, returned, or raised on purpose."""
    raised = raised_lines(part.traceback) if on_purpose(part.traceback) else []
    return [line for line in (*part.said(), *raised) if line.strip()]


@functools.lru_cache(maxsize=1024)
def shape(line: str) -> str:
    """Return a line without its numbers, in lower case, so that lines about two different goals can be compared."""
    return " ".join(_NUMBERS.sub(" ", _with_status_names(line).lower()).split())


def _shapes(parts: Iterable[Part]) -> set[str]:
    """Return the :func:`shape` of each line in the given runs."""
    return {shape(line) for part in parts for line in all_lines(part)}


@functools.lru_cache(maxsize=1024)
def _with_status_names(line: str) -> str:
    word = _STATUS_WORD.search(line)
    if word is None:
        return line
    behind = _STATUS_NUMBER.sub(lambda found: found[1] + STATUS[int(found[2])], line[word.end() :])
    return f"{line[: word.end()]}{behind}"


def _most_telling(part: Part, others: Sequence[Part]) -> str:
    """Return the last line whose words occur in no other run; if there is none, the last line with a word or number."""
    lines = [line for line in all_lines(part) if re2.search(r"[\pL\pN]", line) and line != part.returned]
    usual = _shapes(others)
    new = [line for line in lines if shape(line) not in usual]
    return (new or lines or [""])[-1]
