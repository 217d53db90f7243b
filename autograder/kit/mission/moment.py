"""The argument of an author's conditions: the world, the robot, and everything that the subject has sent so far."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence  # noqa: TC003  (an author reads the types)
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from autograder.kit import outcomes
from autograder.kit.in_words import counted
from autograder.kit.rules import value
from autograder.robot.motion import ROOM, START, STILL, Point, Pose, Velocity, Walls
from autograder.robot.sensors import FARTHEST

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Part
    from autograder.kit.outcomes import SentGoal

TWIST = "geometry_msgs/msg/Twist"
SLACK = 0.25
"""Seconds by which a message may seem to come after a call or goal that was sent right behind it."""


@dataclass(frozen=True)
class World:
    """A place for a mission. A world among the steps of a mission puts the robot at the start of this world.

    Attributes:
        walls: The walls; by default those of the course's two rooms.
        start: The robot's pose at the start: x and y in meters, the heading in radians.
        places: Points with names, in meters, for conditions and sensors, such as ``{"lamp": (4.0, 2.0)}``.
        turns: False for a robot that does not turn: ``linear.x`` and ``linear.y`` move it along the axes.
    """

    walls: Walls = ROOM
    start: Pose = START
    places: Mapping[str, Point] = field(default_factory=dict)
    turns: bool = True


@dataclass(frozen=True)
class Moment:
    """One moment of a mission.

    Attributes:
        time: Seconds of the subject's time since the mission began.
        world: The world in which the robot is.
        leg: The number of worlds in which the robot has been before this one.
        pose: The robot's pose.
        velocity: The robot's velocity; 0 forward if a wall is in its way.
        bumped: True if the robot pushes against a wall at this moment.
        lamp: True if the robot's lamp is on.
        stood: Seconds for which the robot has neither moved nor pushed against a wall.
        silent: Seconds since the subject's last command; since the beginning if no command has come.
        reached: For the text of each line of ``reaches`` that has been reached, the ``time`` at which it was.
        part: Everything that the judge has recorded so far.
        topic: The name of the topic with commands.
    """

    part: Part
    topic: str
    world: World = field(default_factory=World)
    pose: Pose = START
    velocity: Velocity = STILL
    time: float = 0.0
    leg: int = 0
    bumped: bool = False
    lamp: bool = False
    stood: float = 0.0
    silent: float = 0.0
    reached: Mapping[str, float] = field(default_factory=dict)

    @property
    def ahead(self) -> float:
        """The distance in meters from the robot's center straight ahead to a wall, at most the laser's range."""
        return min(FARTHEST, *self.world.walls.ranges(self.pose.point, (self.pose.heading,)))

    @property
    def clearance(self) -> float:
        """The distance in meters from the robot's center to the nearest wall, at most the laser's range."""
        return min(FARTHEST, self.world.walls.clearance(self.pose.point))

    def to(self, place: str | Point) -> float:
        """Return the distance in meters from the robot's center to a point, or to a place of the world."""
        return math.dist(self.pose.point, self.world.places[place] if isinstance(place, str) else place)

    def said(self, topic: str) -> Any:
        """Return the content of the last message on a topic of the subject; None if none has come."""
        messages = self.part.of("message", topic)
        return value(messages[-1]) if messages else None

    def since(self, line: str) -> float:
        """Return the seconds since a line of ``reaches`` was reached, given by its text; infinity if it was not."""
        return self.time - self.reached.get(line, -math.inf)

    @property
    def commands(self) -> int:
        """The number of commands that the subject has published, also before the judge could hear them."""
        return published(self.part, self.topic)

    def asked(self, service: str) -> str:
        """Return in words how the subject called a service of the judge: how often, with what, after what."""
        calls = [value(event) for event in self.part.of("request", service)]
        after = counted(self.before("request", service).commands, "command")
        return f"{counted(len(calls), 'call')} ({_each(calls)}) after {after}" if calls else "no call"

    def sent(self, action: str) -> str:
        """Return in words which goals the subject sent to an action of the judge, and if before a service answered."""
        goals = [
            ", ".join(f"{name} = {number:.6g}" for name, number in event.data["fields"].items())
            for event in self.part.of("goal", action)
        ]
        calls, answers = (self.before("goal", action).part.of(kind) for kind in ("request", "response"))
        early = ", before the answer" if len(answers) < len(calls) else ""
        return f"{counted(len(goals), 'goal')}: {_each(goals)}{early}" if goals else "no goal"

    def goal(self, number: int) -> SentGoal:
        """Return what came of a goal that the judge sent to the subject's action, counted from 0."""
        return outcomes.goal(self.part, number)

    def ended(self, number: int = 0) -> str:
        """Return how such a goal ended, as :func:`autograder.kit.outcomes.end_of` names it."""
        return outcomes.end_of(self.goal(number))

    def before(self, kind: str, name: str | None = None) -> Moment:
        """Return what the judge had recorded before the first event of a kind, such as ``"request"``, and a name.

        If there is no such event, the whole record. A message right behind the event counts as earlier, because it may
        have overtaken the message on the wire.
        """
        first = self.part.first(kind, name)
        if first is None:
            return self
        earlier = self.part.events[: self.part.events.index(first)]
        late = [
            event
            for event in self.part.events[len(earlier) :]
            if event.kind == "message" and event.moment <= first.moment + SLACK
        ]
        return replace(self, part=replace(self.part, events=[*earlier, *late]))

    def __str__(self) -> str:
        """Return the time and the place in words."""
        return f"after {self.time:.1f} s, at x = {self.pose.x:.2f} m, y = {self.pose.y:.2f} m"


def number_of(command: Event, part: str, axis: str) -> float:
    """Return one of the six numbers of a command; 0 if it is missing."""
    return float(command.data["fields"].get(part, {}).get(axis, 0.0))


def published(part: Part, topic: str | None = None) -> int:
    """Return the number of messages that were published on a topic, also those before the judge was found."""
    messages = part.of("message", topic)
    return max((len(messages), *(int(event.data.get("number", 0)) for event in messages)))


def _each(listed: Sequence[object]) -> str:
    return " / ".join(dict.fromkeys(map(str, listed)))
