"""The course of one mission: the world goes on step by step, and the judge notes what was reached and what happened."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from autograder.kit.mission.first_look import FirstLook
from autograder.kit.mission.track import NOTED, Track

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.mission.moment import Moment
    from autograder.kit.mission.robot import Robot
    from autograder.kit.mission.steps import Journey, Step

AFTER = 1.0
"""Seconds of the subject's time for which the world goes on after everything was reached."""
MISTAKE = "mistake"
"""The name of the noted events about the mistakes that an author knows."""
_NEWS = (
    "request",
    "goal",
    "cancel",
    "answered",
    "goal_answer",
    "feedback_heard",
    "cancel_answer",
    "result_heard",
)
"""The kinds of events with which the subject does something new, besides messages."""
_CIRCLE = 7.0
"""Radians that a robot turns under one command without an end: a little more than a circle."""


@dataclass(frozen=True)
class Line:
    """A line of the card.

    Attributes:
        text: The line.
        name: The key of the criterion.
        points: The points; 0 for an equal part of the rest.
        wants: What the card shows as expected, if it is not the solution's fact.
        holds: The condition, or the function that returns the fact in words.
    """

    text: str
    name: str
    points: float = 0.0
    wants: str = ""
    holds: Callable[[Moment], Any] = str


@dataclass(frozen=True)
class Lines:
    """The lines of a mission: what must be reached, what must never happen, and facts that are the solution's."""

    reaches: Sequence[Line]
    never: Sequence[Line]
    same: Sequence[Line]


NOTHING_REACHED = "nothing yet: this counts once your robot has reached something"
"""The words of the card for a line of ``never`` before a line of ``reaches`` was reached."""


class Course:
    """Steps the world of one mission, and notes what became of its lines.

    Args:
        bench: The bench of the scenario.
        robot: The robot in its world.
        lines: The lines of the card.
        within: Seconds of the subject's time for the whole mission.
        quiet: Seconds without anything new of the subject and a movement of the robot after which the mission is over.
    """

    def __init__(self, bench: Bench, robot: Robot, lines: Lines, within: float, quiet: float) -> None:
        self._bench, self._robot, self._lines = bench, robot, lines
        self._within, self._quiet = within, quiet
        self._reached: dict[str, str] = {}
        self._broken: dict[str, str] = {}
        self._news: tuple[object, ...] = ()
        self._last_at = self._turned = 0.0
        self._pose = robot.now.pose
        self._track = Track()
        before = bench.before
        self._first_look = FirstLook(before.main, robot.now.topic) if before is not None else None

    def run(self, journey: Journey, steps: Sequence[Step], until: Callable[[Moment], bool] | None) -> bool:
        """Take all steps, and go on until the mission is over. Return False if the subject did not answer."""
        over = until or (
            lambda _: bool(self._lines.reaches) and len(self._reached) == len(self._lines.reaches)
        )
        if not (self._robot.begin() and all(journey.take(step) for step in steps)):
            return False
        return self.go(self._within, lambda now: over(now) or self._is_quiet(now)) and self.go(AFTER)

    def go(self, seconds: float, until: Callable[[Moment], bool] = lambda _: False) -> bool:
        """Let seconds pass, or fewer if a condition holds. Return False if the subject does not answer."""
        robot = self._robot
        end = robot.now.time + seconds
        while robot.now.time < end - 1e-6 and not until(robot.now):
            if math.isinf(end) and self._is_quiet(robot.now):
                return True
            if self._first_look is not None and self._first_look.is_confirmed(robot.now):
                self._bench.confirm()
            if robot.now.time >= self._within + AFTER or robot.now.part.ending is not None:
                return True
            if not robot.step():
                return False
            self._look()
        return True

    def _look(self) -> None:
        """Note the place of the robot, and which lines the present moment reaches or breaks."""
        now = self._robot.now
        self._track.add(now)
        for line in self._lines.reaches:
            if line.name not in self._reached and line.holds(now):
                self._reached[line.name] = str(now)
                now = self._robot.now = replace(now, reached={**now.reached, line.text: now.time})
        for line in self._lines.never:
            if line.name not in self._broken and line.holds(now):
                self._broken[line.name] = str(now)

    def _is_quiet(self, now: Moment) -> bool:
        """Return True if the subject has done nothing new for long, and the robot stands, pushes a wall, or circles.

        In a mission in which something has to be reached, to repeat a message is nothing new.
        """
        part, repeats = now.part, bool(self._lines.reaches)
        said = {event.name: str(event.data["fields"]) for event in part.of("message")} if repeats else {}
        heard = sum(event.kind in _NEWS or (event.kind == "message" and not repeats) for event in part.events)
        if (news := (heard, now.leg, said)) != self._news:
            self._news, self._turned, self._last_at = news, 0.0, now.time
        turned = math.remainder(now.pose.heading - self._pose.heading, math.tau)
        self._turned += abs(turned)
        if now.pose != self._pose:
            self._pose, self._last_at = now.pose, now.time
        circles = repeats and self._turned > _CIRCLE
        return circles or now.time - self._last_at >= self._quiet

    def note(self, knows: Sequence[Callable[[Moment], Any]]) -> bool:
        """Note what became of each line, and which mistakes show. Return True if all lines hold."""
        now, holds = self._robot.now, []
        for line in self._lines.reaches:
            reached = self._reached.get(line.name)
            self._bench.note(line.name, holds=reached is not None, text=reached or f"no, {now}")
            holds.append(reached is not None)
        for line in self._lines.never:
            # A robot that never leaves its place breaks no rule, and has done nothing for the points either.
            did = bool(self._reached) or not self._lines.reaches
            broken = self._broken.get(line.name, "" if did else NOTHING_REACHED)
            self._bench.note(line.name, holds=not broken, text=broken or "never")
            holds.append(not broken)
        for line in self._lines.same:
            text, theirs = str(line.holds(now)), self._bench.reference.parts
            self._bench.note(line.name, text=text)
            due = theirs[0].first("noted", line.name) if theirs else None
            holds.append(due is None or due.data["text"] == text)
        self._bench.note(NOTED, text=str(now), ways=self._track.told())
        for number, found in enumerate(knows):
            if shown := found(now):
                self._bench.note(MISTAKE, number=number, shown=shown)
        return all(holds)
