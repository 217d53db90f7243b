"""A recipe for a node that drives: a world, what the robot must reach in it, and what must never happen.

The judge plays the robot of the course. The world is stepped in the subject's simulated time, and only after the
subject has answered for the step before. So the same commands lead to the same places on every machine.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from random import Random  # noqa: TC003  (an author reads the types)
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit.draft import POINTS, Draft, Judge
from autograder.kit.mission import driving
from autograder.kit.mission.course import MISTAKE, Course, Line, Lines
from autograder.kit.mission.moment import Moment, World
from autograder.kit.mission.robot import Robot
from autograder.kit.mission.steps import Goal, Journey, Step
from autograder.kit.mistakes.common_mistakes import KEEP_THE_PERIOD
from autograder.kit.model import Finding
from autograder.kit.oracle.steps import To
from autograder.kit.output.launched_processes import processes
from autograder.kit.recipes.own_scenario import QUIET
from autograder.robot.motion import ROOM, Pose, Wall, Walls

if TYPE_CHECKING:
    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Exercise

__all__ = ["ROOM", "Goal", "Mission", "Moment", "Pose", "To", "Wall", "Walls", "World"]

Row = Sequence[Any]
"""A line of the card: its text, a function of a :class:`Moment`, and perhaps a name without blanks and the points."""
OTHER = "A command of yours says {0[0]}; the task asks for {0[1]}."
MOVEMENT = (
    "linear.x points ahead, in meters per second, and angular turns the robot: make a new Twist() for each command, "
    "set what the task asks for before you publish it, and leave the other numbers alone."
)
WRONG_RATE = "Your commands come {}; the task asks for another rate."
NOTHING: Mapping[str, Any] = MappingProxyType({})
PART = "mission"
RECORDED = (
    *("message", "request", "response", "goal", "cancel", "feedback", "result", "asked", "answered", "noted"),
    *("goal_sent", "goal_answer", "feedback_heard", "cancel_sent", "cancel_answer", "result_heard"),
)
"""The kinds of events that a recording keeps: all but what the robot sensed."""
_NO_NAME = re2.compile(r"[^a-z0-9]+")


class Mission:
    """An exercise about a node that drives a robot, or that tells how the robot drives.

    The robot is that of the course (``docs/robot.md``). Each endpoint of the reference solution gets its counterpart:
    ``Odometry`` and ``LaserScan`` come from the robot, a ``Twist`` moves it, a service that the solution calls switches
    its lamp, an action that the solution calls makes it walk.

    Args:
        exercise_id: The lab's folder and the file's name, such as ``"lab_8_1.brake"``.
        title: The title of the card, naming the lab and the subject.
        task: One sentence that states the task.
        world: The world at the beginning.
        draws: Draws the steps, which the judge takes one after the other: another :class:`World`, :class:`To` a topic
            or service, a :class:`Goal` for an action, seconds of the subject's time to let pass, or a condition to
            await. A condition has to hold for a robot that gives up, too: it is awaited until the mission is over.
        reaches: The lines about what must hold at some moment: text and condition.
        never: The lines about what must hold at no moment. They count only if a line of ``reaches`` was reached.
        same: The lines about a fact at the end that must be the solution's: text, and a function that returns the fact
            in words. It must not depend on what was drawn.
        drives: The line about the commands, which must be the solution's: its text, perhaps a name and the points. If
            the solution's commands come to an end, their number counts, too.
        rate: The line about the rate of the commands, which must be the solution's, in the same form.
        knows: The mistakes that a :class:`Moment` at the end shows: key, function, two texts (see
            :meth:`autograder.kit.draft.Draft.knows`), and perhaps a dictionary with ``certain`` or ``late``.
        senses: For topics that the course's robot does not have, a function that returns the fields of a message, or
            nothing for silence. None stands for what the course's robot senses.
        serves: For services other than a lamp's switch, a function that returns the fields of the answer.
        late: For services that answer late, a function that draws the delays in seconds of the subject's time: that of
            the first request, and perhaps of later ones. Other requests are answered at once.
        roles: The roles of the subject's endpoints, the most telling first.
        within: Seconds of the subject's time for the whole mission: so many that only a robot that never arrives fails
            by them. With fewer, the world that was drawn decides about a slow one.
        until: The mission is over a second after this holds; by default, after all of ``reaches`` were reached.
        quiet: The mission is over if the robot has not moved, which may be because it pushes against a wall, and the
            subject has sent nothing for so many seconds. If something has to be reached, to repeat the last message is
            nothing, and a robot that circles under one command is over, too.
        threads: The number of threads that spin a class of a notebook.
        points: The points of the exercise, in equal parts for the lines without points.

    Example::

        EXERCISE = Mission(
            "lab_8_1.brake",
            "A rule · The brake",
            "Drive ahead, and stop in front of the wall.",
            draws=lambda random: [World(start=Pose(random.uniform(0.5, 2.0), 1.0, 0.0))],
            reaches=[("Stands in front of the wall", lambda now: now.ahead < 0.8 and now.stood > 2.0)],
            never=[("Touches no wall", lambda now: now.bumped)],
            roles=("publisher", "subscription"),
        ).exercise()
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        world: World | None = None,
        draws: Callable[[Random], Sequence[Step]] = lambda _: (),
        reaches: Sequence[Row] = (),
        never: Sequence[Row] = (),
        same: Sequence[Row] = (),
        drives: Row = (),
        rate: Row = (),
        knows: Sequence[Sequence[Any]] = (),
        senses: Mapping[str, Callable[[Moment], Mapping[str, Any] | None]] = NOTHING,
        serves: Mapping[str, Callable[[Moment], Mapping[str, Any]]] = NOTHING,
        late: Mapping[str, Callable[[Random], Sequence[float]]] = NOTHING,
        roles: Sequence[str] = ("publisher",),
        within: float = 30.0,
        until: Callable[[Moment], bool] | None = None,
        quiet: float = 5.0,
        threads: int = 1,
        points: float = POINTS,
    ) -> None:
        self._world, self._draws, self._late = world or World(), draws, late
        self._senses, self._serves = senses, serves
        kinds = (("yes", reaches), ("never", never), ("", same))
        self._lines = Lines(*([_line(wants, *row) for row in rows] for wants, rows in kinds))
        self._knows = [found for _, found, *_ in knows]
        self._is_compared = bool(drives or rate)
        self._within, self._until, self._quiet, self._threads = within, until, quiet, threads
        recipe = driving.Driving(self._scenario, *roles)
        self._draft = Draft(exercise_id, title, task, recipe, points=points)
        rows: list[tuple[Line, Judge[Part]]] = []
        if drives:
            rows.append((_line("", drives[0], str, *drives[1:]), driving.drives))
        rows += [(line, partial(_as_noted, line)) for line in (*self._lines.reaches, *self._lines.same)]
        if rate:
            rows.append((_line("", rate[0], str, *rate[1:]), driving.keeps_rate))
        rows += [(line, partial(_as_noted, line)) for line in self._lines.never]
        for line, judge in rows:
            self._draft.criterion(line.name, line.text, points=line.points)(judge)
        if drives:
            self._draft.knows("wrong_movement", driving.another_movement, OTHER, MOVEMENT, certain=True)
        for number, (key, _, says, next_step, *how) in enumerate(knows):
            shown = partial(_shown, number)
            self._draft.knows(key, shown, says, next_step, **(how[0] if how else {}))
        if rate:
            self._draft.knows("wrong_rate", driving.another_rate, WRONG_RATE, KEEP_THE_PERIOD)

    def exercise(self, **more: Any) -> Exercise:
        """Return the finished exercise. For ``more`` see :meth:`autograder.kit.draft.Draft.exercise`."""
        return self._draft.exercise(**{"recorded": RECORDED, **more})

    def _scenario(self, bench: Bench) -> None:
        # Each solution goes its own way, so a card must not ask for the messages of the recorded one.
        is_free = bool(bench.reference.parts) and not self._is_compared
        bench.part(PART, **({"goes": "its own way"} if is_free else {}))
        ends = bench.reference.interface
        for topic, kind in ends.get("publisher", {}).items():
            bench.listen(topic, kind)
        first, *others = steps = [*self._draws(bench.random)] or [self._world]
        world, steps = (first, others) if isinstance(first, World) else (self._world, steps)
        late = {service: draws(bench.random) for service, draws in self._late.items()}
        robot = Robot(bench, world, self._senses, self._serves, late)
        course = Course(bench, robot, self._lines, self._within, self._quiet)
        journey = Journey(bench, robot, course.go)
        bench.start(threads=self._threads)
        named = [(role, name) for role, names in ends.items() for name in names]
        there = [bench.await_endpoint(*end) for end in named[:1]]
        if processes(bench.seen()):
            # The programs of a launch start one after the other, so the endpoints of the first are not all.
            bench.watch_graph(partial(_has_all, named), QUIET[bench.pace])
        there += [bench.await_endpoint(*end) for end in named[1:]]
        bench.release()
        if any(there):
            bench.await_attention()
            if processes(bench.seen()):
                # A command shows that the programs of a launch have discovered each other: it came through all of them.
                commands = driving.drive_topic(ends)
                bench.wait_until(lambda seen: bool(seen.main.of("message", commands)), QUIET[bench.pace])
            answered = course.run(journey, steps, self._until)
            # A subject that hangs shows nothing but that it hangs.
            if not (course.note(self._knows if answered else ()) and answered):
                bench.note_whether_it_spins()
        bench.stop()


def _has_all(ends: Sequence[tuple[str, str]], evidence: Evidence) -> bool:
    """Return True if the subject has made all endpoints, given by role and name."""
    return all(name in evidence.main.endpoints(role) for role, name in ends)


def _line(wants: str, text: str, holds: Callable[[Moment], Any], name: str = "", points: float = 0.0) -> Line:
    return Line(text, name or _NO_NAME.sub("_", text.lower()).strip("_"), points, wants, holds)


def _as_noted(line: Line, seen: Part, expected: Part) -> Finding:
    """Decide a line from what the scenario noted about it."""
    mine, theirs = seen.first("noted", line.name), expected.first("noted", line.name)
    wanted = line.wants or (theirs.data["text"] if theirs else "")
    if mine is None:
        return Finding(False, wanted, "nothing: your node did not get that far")
    holds = mine.data["holds"] if line.wants else mine.data["text"] == wanted
    return Finding(holds, wanted, mine.data["text"])


def _shown(number: int, seen: Part, _: Part) -> Any:
    """Return what shows an author's mistake at the end of the mission; None if nothing does."""
    noted = (event.data["shown"] for event in seen.of("noted", MISTAKE) if event.data["number"] == number)
    return next(noted, None)
