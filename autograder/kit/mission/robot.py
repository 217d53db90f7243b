"""The robot that the judge plays: it obeys commands, walks to the goals of the subject, and tells what it senses."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from autograder.kit.bench import Pace
from autograder.kit.mission.driving import drive_topic
from autograder.kit.mission.moment import Moment, World, number_of
from autograder.robot.motion import STILL, TICK, Velocity, move, towards
from autograder.robot.sensors import OBEYS_FOR, SCAN_EVERY, laser_scan, look_around, odometry

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.counterparts import ActionCounterpart, Speaker

ARRIVED = 0.1
"""The distance in meters from a goal at which a walk has arrived."""
FEEDBACK_EVERY = 5
"""The number of steps between two feedback messages of a walk."""
BRAKES = 10
"""The number of steps for which a walk goes on after a request to cancel it."""
FEEDBACK_MATCH = 3.0
"""Time limit in seconds of wall time until the subject can hear the feedback of a walk."""


class Walk:
    """An action with which the subject sends the robot to a point: ``small_robot_interfaces/action/WalkTo``."""

    def __init__(self, bench: Bench, action: str, kind: str) -> None:
        self._bench, self._action = bench, action
        self._server: ActionCounterpart = bench.serve_action(action, kind)
        self._ticks, self._brakes, self._over = 0, 0, False

    def next(self, now: Moment) -> Velocity | None:
        """Return the velocity for the next step, and report the way that is left; None if no walk is under way."""
        goal = now.part.first("goal", self._action)
        if goal is None or self._over:
            return None
        if not self._ticks:
            self._server.await_goal(FEEDBACK_MATCH)
        x, y = (float(goal.data["fields"][axis]) for axis in "xy")
        left, canceled = now.to((x, y)), now.part.first("cancel", self._action)
        self._brakes += canceled is not None
        if left <= ARRIVED or self._brakes > BRAKES:
            self._over = True
            status = "canceled" if canceled else "succeeded"
            self._server.finish(status, arrived=not canceled, x=now.pose.x, y=now.pose.y)
            return STILL
        if self._ticks % FEEDBACK_EVERY == 0:
            self._server.send_feedback(distance=left)
        self._ticks += 1
        return towards(now.pose, (x, y))


class Robot:
    """A robot in the world of a mission. It moves in steps of :data:`autograder.robot.motion.TICK` seconds.

    Args:
        bench: The bench of the scenario. The subject's endpoints are those of the reference solution.
        world: The world at the beginning.
        senses: What the robot tells on topics: the fields of a message, or None for what the course's robot tells.
        serves: What the robot answers to calls of services that do not switch the lamp: the fields of an answer.
        late: The services that answer late, with the delays of their answers in seconds of the subject's time.
    """

    def __init__(
        self,
        bench: Bench,
        world: World,
        senses: Mapping[str, Callable[[Moment], Mapping[str, Any] | None]],
        serves: Mapping[str, Callable[[Moment], Mapping[str, Any]]],
        late: Mapping[str, Sequence[float]],
    ) -> None:
        ends = bench.reference.interface
        self._bench, self._senses, self._serves = bench, senses, serves
        self._topic = drive_topic(ends)
        self._sensors: dict[str, tuple[Speaker, str]] = {}
        self._steps, self._obeyed, self._commanded = 0, 0, 0.0
        self._told, self._at = STILL, 0.0
        for topic, kind in ends.get("subscription", {}).items():
            self._sensors[topic] = bench.speak(topic, kind), kind
        for service, kind in ends.get("client", {}).items():
            delays = dict(enumerate(late.get(service, ()), 1))
            bench.serve(service, kind, partial(self._answer, service), late=delays)
        self._walks = [Walk(bench, action, kind) for action, kind in ends.get("action_client", {}).items()]
        self.now = Moment(bench.seen(), self._topic, world, world.start)

    def begin(self) -> bool:
        """Let the subject follow the judge's clock, if it can. Return False if it does not answer."""
        answers = self._bench.run_time(TICK)
        self._at = self._bench.moment
        return answers

    def enter(self, world: World) -> None:
        """Put the robot at the start of another world."""
        self.now = replace(
            self.now, world=world, pose=world.start, velocity=STILL, leg=self.now.leg + 1, stood=0.0
        )
        self._told = STILL

    def send(self, topic: str, fields: Mapping[str, Any]) -> None:
        """Publish a message to the subject on a topic that is not one of a sensor."""
        self._sensors[topic][0].send(**fields)

    def knows(self, topic: str) -> bool:
        """Return True if the subject subscribes to the topic."""
        return topic in self._sensors

    def step(self) -> bool:
        """Sense, let the subject's time pass, and move as it wants. Return False if the subject does not answer."""
        if self._sense() and self._bench.pace is Pace.FAST:
            # Without this, it depends on the load in which of the clock's steps the subject handles its sensors.
            self._bench.settle()
        answers = self._bench.run_time(TICK)
        self._bench.take_in()
        before, self._at = self._at, self._bench.moment
        self._move(self._at - before)
        return answers

    def _sense(self) -> bool:
        """Publish what the robot senses. Return True if anything was published."""
        messages = {topic: fields for topic in self._sensors if (fields := self._sensed(topic))}
        for topic, fields in messages.items():
            self.send(topic, fields)
        self._steps += 1
        return bool(messages)

    def _sensed(self, topic: str) -> Mapping[str, Any]:
        """Return the fields of the message that is due on a topic; empty if none is."""
        now, stamp, kind = self.now, round(self._at * 1e9), self._sensors[topic][1]
        if topic in self._senses and (fields := self._senses[topic](now)) is not None:
            return fields
        if kind == "nav_msgs/msg/Odometry":
            return odometry(now.pose, now.velocity, stamp)
        if kind == "sensor_msgs/msg/LaserScan" and self._steps % SCAN_EVERY == 0:
            return laser_scan(look_around(now.pose, now.world.walls), stamp)
        return {}

    def _move(self, seconds: float) -> None:
        self.now = now = replace(self.now, part=self._bench.seen(), time=self.now.time + seconds)
        messages = now.part.of("message", self._topic)
        if len(messages) > self._obeyed:
            self._obeyed, self._commanded, last = len(messages), now.time, messages[-1]
            left = 0.0 if now.world.turns else number_of(last, "linear", "y")
            turn = number_of(last, "angular", "z") if now.world.turns else 0.0
            self._told = Velocity(number_of(last, "linear", "x"), turn, left)
        silent = now.time - self._commanded
        walking = [velocity for walk in self._walks if (velocity := walk.next(now)) is not None]
        told = self._told if silent < OBEYS_FOR else STILL
        moved = move(now.pose, walking[0] if walking else told, seconds, now.world.walls)
        stands = moved.pose == now.pose and not moved.bumped
        stood = now.stood + seconds if stands else 0.0
        self.now = replace(
            now, pose=moved.pose, velocity=moved.velocity, bumped=moved.bumped, stood=stood, silent=silent,
            lamp=next((bool(one) for one in reversed(_switched(now))), False),
        )  # fmt: skip

    def _answer(self, service: str, request: Mapping[str, Any]) -> Mapping[str, Any]:
        if service in self._serves:
            return self._serves[service](self.now)
        return {"success": True, "message": f"the lamp is {'on' if request.get('data') else 'off'}"}


def _switched(now: Moment) -> list[Any]:
    return [event.data["fields"].get("data") for event in now.part.of("response")]
