"""The recipe for a subject that drives: whether its commands are the solution's, and what is wrong if they are not."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.kit import rules
from autograder.kit.draft import OWN_LATE
from autograder.kit.in_words import counted
from autograder.kit.mission.moment import TWIST, number_of, published
from autograder.kit.mistakes.role_mistakes import ladder
from autograder.kit.mistakes.silence import GO_ON, NO_MORE
from autograder.kit.mistakes.unfinished import STEP_MISSING
from autograder.kit.model import Finding, Mistake, mistake
from autograder.kit.recipes.own_scenario import OwnScenario

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.kit.evidence import Event, Evidence, Part

GOES_ON = 2.5
"""Seconds by which the last command may be older than the solution's at the end of a mission."""

_AXES = tuple((part, axis) for part in ("linear", "angular") for axis in "xyz")


def drive_topic(interface: Mapping[str, Mapping[str, str]]) -> str:
    """Return the name of the topic on which the solution drives the robot; empty if there is none."""
    publishers = interface.get("publisher", {})
    return next((topic for topic, kind in sorted(publishers.items()) if kind == TWIST), "")


def drives(seen: Part, expected: Part) -> Finding:
    """Decide whether the commands are the solution's, and as many, if those of the solution come to an end."""
    mine, theirs = _commands(seen, expected)
    ends = _silence(theirs) > GOES_ON
    same = set(_movements(mine)) == set(_movements(theirs))
    enough = not ends or published(mine) == published(theirs)
    return Finding(same and enough, _in_words(theirs, ends), _in_words(mine, ends))


def another_movement(seen: Part, expected: Part) -> tuple[str, str] | None:
    """Return a movement that the solution does not command, and those that it commands; None if there is none."""
    mine, theirs = map(_movements, _commands(seen, expected))
    other = next((one for one in mine if one not in theirs), "")
    return (other, " / ".join(theirs)) if other else None


def _in_words(part: Part, counts: bool) -> str:
    many = f"{counted(published(part), 'command')}: " if counts else ""
    return many + " / ".join(_movements(part)) if part.of("message") else "no command"


def _movements(part: Part) -> list[str]:
    """Return the different commands, each in words: the numbers in it that are not 0."""
    return list(dict.fromkeys(map(movement, part.of("message"))))


def movement(command: Event) -> str:
    """Return a command in words: the numbers in it that are not 0, such as ``linear.x = 0.5``.

    Two digits after the point: a speed may be calculated, and half a centimeter per second is the same movement.
    """
    numbers = {f"{part}.{axis}": round(number_of(command, part, axis), 2) for part, axis in _AXES}
    return ", ".join(f"{name} = {number:g}" for name, number in numbers.items() if number) or "all numbers 0"


def keeps_rate(seen: Part, expected: Part) -> Finding:
    """Decide whether the commands come as often as the solution's, and go on as long."""
    mine, theirs = _commands(seen, expected)
    rate = rules.keeps_rate(mine, theirs)
    if rate.passed and _stopped(mine, theirs):
        return replace(rate, passed=False, seen=f"{counted(published(mine), 'command')}, and no more")
    return rate


def another_rate(seen: Part, expected: Part) -> str:
    """Return the rate of the commands in words if it is wrong; empty if it is right, or cannot be told."""
    return rules.another_rate(*_commands(seen, expected))


def _commands(seen: Part, expected: Part) -> tuple[Part, Part]:
    """Return the records of the subject and of the solution, in which the messages are those that drive the robot."""
    topic = drive_topic({"publisher": expected.endpoints("publisher")})
    mine, theirs = (
        replace(part, events=[e for e in part.events if e.kind != "message" or e.name == topic])
        for part in (seen, expected)
    )
    return mine, theirs


def _stopped(mine: Part, theirs: Part) -> bool:
    """Return True if the commands ended, although those of the solution went on."""
    fewer = published(mine) < published(theirs)
    return fewer and (mine.ending is not None or _silence(mine) > _silence(theirs) + GOES_ON)


def _silence(part: Part) -> float:
    """Return the seconds between the last command and the end of the mission."""
    messages = part.of("message")
    # A recording keeps no times of what the judge noted, so whatever came last tells when the mission ended.
    return max(event.moment for event in part.events) - messages[-1].moment if messages else 0.0


class Driving(OwnScenario):
    """The recipe for a subject that drives, with the mistakes of a node that publishes nothing, or no more."""

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        silent = (
            mistake(
                "not_written", self._not_written, "Your node drives, and no {} came after that.", STEP_MISSING
            ),
            mistake("stopped_publishing", self._stopped_publishing, NO_MORE, GO_ON),
        )
        return ladder(self.roles, late=(OWN_LATE, *silent) if "publisher" in self.roles else (OWN_LATE,))

    @staticmethod
    def _not_written(evidence: Evidence) -> str:
        """Return the first call or goal of the solution that the subject never sent; empty if it sent all, or none."""
        interface, part = evidence.reference.interface, evidence.main
        kinds = (("client", "request", "call of"), ("action_client", "goal", "goal for"))
        missing = [
            f"{what} {name}"
            for role, kind, what in kinds
            for name in interface.get(role, {})
            if not part.of(kind, name)
        ]
        return missing[0] if missing and part.of("message", drive_topic(interface)) else ""

    def _stopped_publishing(self, evidence: Evidence) -> str:
        mine, theirs = _commands(evidence.main, self.expected(evidence))
        came, alive = len(mine.of("message")), mine.ending is None and not mine.of("unanswered")
        return counted(came, "message") if came and alive and _stopped(mine, theirs) else ""
