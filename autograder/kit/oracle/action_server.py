"""The recipe for an action server: the judge sends goals, decides what came of them, and names common mistakes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes.action_server_mistakes import NO_FREE_THREAD, UNREAD, result_type
from autograder.kit.mistakes.crashes import traceback_of
from autograder.kit.mistakes.role_mistakes import ladder
from autograder.kit.model import Finding, Mistake, card_words, mistake
from autograder.kit.oracle.goals_seen import ENDED, GoalsSeen
from autograder.kit.outcomes import CANCELED, SUCCEEDED, goal, status_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence

_WORDS = card_words(__file__)

CANCELED_UNASKED = "with event CANCELED"
"""In what rclpy raises if canceled() is called for a goal that no client has asked to cancel."""

Seen = TypeVar("Seen", bound=GoalsSeen)


class SendsGoals(Generic[Seen]):
    """The recipe for an action server. Its view is the author's :class:`GoalsSeen`.

    The recipe recognizes the mistakes ``two_servers``, ``result_missing``, ``action_name``, ``message_type``,
    ``cancel_not_accepted``, ``older_goal_ended``, ``goals_mixed_up``, ``goal_rejected``, ``done_at_once``.

    Args:
        scenario: The function that runs all parts of the exercise on a bench, usually with a
            :class:`autograder.kit.oracle.goal_sender.GoalSender`.
        view: Returns the view of what the judge saw.

    Example::

        def docking(met: Met) -> bool:
            sender = GoalSender(met.bench, met.action_callers[0])
            if not sender.finish(sender.send(distance=2.0)):
                return False
            sender.cancel(sender.send(distance=9.0), after=3)
            return True

        def docked(evidence: Evidence) -> GoalsSeen:
            first, far = (compared(goal(evidence.main, number)) for number in range(2))
            return GoalsSeen(evidence, [first], [], [], [first, far], [], [], [far], None)

        recipe = SendsGoals(once_met(docking), docked)
    """

    roles = ("action_server",)

    def __init__(self, scenario: Callable[[Bench], None], view: Callable[[Evidence], Seen]) -> None:
        self.scenario, self.seen, self.expected = scenario, view, view

    def serves(self, evidence: Evidence) -> Finding:
        """Decide whether the subject has exactly one server with the right name and type, and it accepts a goal.

        A server whose callback raised an exception was there, so the exception costs only the goals.
        """
        name, type_name = evidence.reference.only("action_server")
        part, expected = evidence.main, f"one server of {name} ({type_name}) that accepts goals"
        wrong, first = common.misfit(evidence, "action_server"), goal(part, 0)
        raised = first.request is not None and bool(part.traceback)
        if not (wrong or raised):
            wrong = ENDED if part.ending is not None else "" if first.accepted else first.objection(True, "")
        return Finding(not wrong, expected, wrong or "it accepts goals")

    def cancels(self, evidence: Evidence) -> Finding:
        """Decide whether a cancel request is accepted, ends the goal soon, and brings the part that was computed."""
        seen = self.seen(evidence)
        first, *later = seen.canceled
        faults = (
            "" if first.accepted else first.objection(True, ""),
            first.request_fault,
            f"the cancel was accepted, then: status {status_text(first.status)}"
            if first.status != CANCELED
            else "",
            seen.part_fault,
            "only as the machine is busy: it counts without a pause" if seen.takes_no_time else "",
            # Of a quick server, a goal may be over when a busy judge asks to cancel it.
            *(
                one.request_fault and f"later, {one.request_fault}"
                for one in later
                if not one.was_canceled_too_late
            ),
        )
        expected = "the cancel is accepted, the goal ends as CANCELED with what was found so far"
        return seen.find(faults, expected, "it is canceled", reached=first.request is not None)

    def refuses(self, evidence: Evidence) -> Finding:
        """Decide whether bad goals are refused, and good ones after them come to an end, whichever that is."""
        seen = self.seen(evidence)
        taken = [one for one in seen.bad if one.accepted is not False]
        lost = [one for one in seen.last if not (one.accepted and one.over)]
        faults = (
            *(f"{one} was {'accepted' if one.accepted else 'not answered'}" for one in taken),
            *(f"after the rejected goals, {one.fault}" for one in lost),
        )
        return seen.find(faults, "rejects bad goals, and lives on", "it does", reached=bool(seen.last))

    @staticmethod
    def remark(evidence: Evidence) -> str:
        """Return a remark for the card if the server sent feedback after it had said that the goal was over."""
        ends = [(part, event.data) for part in evidence for event in part.of("goal_ended")]
        late = any(goal(part, int(data["goal"])).sent_after(data["sent"]) for part, data in ends)
        words = "Your server publishes feedback after it has ended the goal. Later releases of ROS drop such feedback."
        return words if late else ""

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        return ladder(
            self.roles,
            first=(*self._about_goals(BESIDE_ANOTHER), OWN),
            named=(),
            working=(*self._about_goals(ALONE), OWN_LATE),
            late=(),
        )

    def _about_goals(self, rows: Iterable[Row]) -> Iterator[Mistake]:
        for key, found, text, next_step, certain in rows:
            shows = lambda evidence, found=found: found(self.seen(evidence))  # noqa: E731
            yield mistake(key, shows, text, next_step, certain=certain)


def _canceled_unasked(seen: GoalsSeen) -> bool:
    part = seen.evidence.main
    kinds = [event.kind for event in part.events]
    before = part.events[: kinds.index("cancel_sent")] if "cancel_sent" in kinds else part.events
    return any(CANCELED_UNASKED in str(event.data) for event in before)


def _ended_for_another(seen: GoalsSeen) -> str:
    older = None if traceback_of(seen.evidence) else seen.ended_for_another
    return status_text(older.status) if older else ""


def _rejected(seen: GoalsSeen) -> object:
    rejected = [one for one in seen.welcome if one.accepted is False]
    return rejected[0] if rejected and not traceback_of(seen.evidence) else None


def _mixed_up(seen: GoalsSeen) -> str:
    crash = traceback_of(seen.evidence)
    ended = [one for one in seen.later if one.status is not None]
    slips = [one for one in ended if one.slip]
    wrong = slips or [one for one in ended if one.fault]
    others = [f"{one}: it goes on, although your server agreed to stop" for one in seen.astray]
    if CANCELED_UNASKED in crash:
        others.append("canceled() was called for a goal that no client had asked to cancel")
    # If the numbers of two goals get into one list, they grow too large, and that is an exception, too.
    by_a_crash = bool(crash) and not (slips or others)
    # If only large numbers are wrong, two at once are right.
    is_large = len(ended) > 1 and wrong == ended[:1] and (wrong[0].is_wrong_when_large or not slips)
    if (
        by_a_crash
        or (is_large and not others)
        or any(one.fault or one.feedback_fault for one in seen.alone[:1])
    ):
        return ""
    return next(iter([*((one.slip or one.fault) for one in wrong), *others]), "")


def _result_never_filled(seen: GoalsSeen) -> object:
    results = [one.result for one in seen.good if one.status == SUCCEEDED]
    is_empty = results and not any(value for result in results for value in result.values())
    return result_type(seen.evidence) if is_empty else None


def _done_at_once(seen: GoalsSeen) -> object:
    long = seen.canceled[0]
    quick = long.status == SUCCEEDED and not long.cancel_accepted and long.is_quick
    # Whether the cancel got in between, and whether the result was seen, is then up to the machine.
    ended = long.cancelled_too_late or long.status is not None
    return long if quick or (ended and seen.takes_no_time) else None


def _ended_before_its_work(seen: GoalsSeen) -> bool:
    long = seen.canceled[0]
    return long.cancelled_too_late and long.sent_after(long.cancel_answered_at) > 0


def _cancel_not_read(seen: GoalsSeen) -> bool:
    # A goal without a result may keep the only thread busy.
    hangs = any(one.accepted and not one.over for one in seen.good)
    long = seen.canceled[0]
    return not (long.cancel_accepted or long.is_quick or hangs) and long.unread >= UNREAD


Row = tuple[str, "Callable[[GoalsSeen], object]", str, str, bool]
"""A mistake: its key, what shows it, the two texts with placeholders for that, and whether the evidence proves it."""
BESIDE_ANOTHER: tuple[Row, ...] = (
    ("older_goal_ended", _canceled_unasked, *_WORDS["canceled_unasked"], True),
    ("older_goal_ended", _ended_for_another, *_WORDS["older_goal_ended"], True),
    ("goals_mixed_up", _mixed_up, *_WORDS["goals_mixed_up"], False),
)
ALONE: tuple[Row, ...] = (
    ("goal_rejected", _rejected, *_WORDS["goal_rejected"], True),
    ("field_typo", _result_never_filled, *_WORDS["field_typo"], True),
    ("done_at_once", _done_at_once, *_WORDS["done_at_once"], False),
    ("cancel_not_accepted", _ended_before_its_work, *_WORDS["cancel_not_accepted"], False),
    ("cancel_not_accepted", _cancel_not_read, *NO_FREE_THREAD, False),
)
