"""A repair: students get a broken node, and the exercise that judges the right node judges theirs.

Finding the cause is the task. So until the pass the card shows what a user of the node would notice and the events on
the wire, but neither the names and QoS settings that do not fit nor a diagnosis. After the pass it states the cause.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

from autograder.kit.mistakes.crashes import what_and_where
from autograder.kit.model import Advice, Criterion, Exercise, Finding, Mistake
from autograder.kit.runners import LaunchesFromPackage, RunsProgram

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from autograder.kit.evidence import Event, Evidence, Part

POINTS = 4.0
"""The points of a repair; with its question, a ticket has five."""
_ENOUGH = {"right": 3, "wrong": 3}
"""Our repair and two others that differ in mechanism; the broken program and two that only hide the mistake."""
_NOTHING_CAME = {
    "publisher": ("message", "no message arrived on {}"),
    "service": ("answered", "no answer came from {}"),
    "client": ("request", "no call of {} arrived"),
    "subscription": ("matched", "no message on {} reached the node"),
    "action_server": ("goal_answer", "no answer to a goal came from {}"),
    "action_client": ("goal", "no goal arrived at {}"),
}
"""For each role, the kind of event that shows that the endpoint works, and the symptom if there is no such event."""
_ASKED = "the program does what its task says"
"""What is expected of a node of which nothing came. The symptom alone says enough."""
_TELLS_THE_CAUSE = ("mismatch", "misnamed")
_WARNING = "incompatible QoS"
"""A part of the warning that rclpy logs if QoS settings do not fit. The student's own terminal shows it."""
_TOPICS, _SERVICES = "`ros2 topic list`, `ros2 topic info -v`, `ros2 topic echo`", "`ros2 service list -t`"
_ACTIONS, _INSTALLED = "`ros2 action list -t`, `ros2 action info`", "`ros2 pkg executables`, `find install`"
_TOOLS = {
    "publisher": _TOPICS,
    "subscription": _TOPICS,
    "service": _SERVICES,
    "client": _SERVICES,
    "action_server": _ACTIONS,
    "action_client": _ACTIONS,
}
"""The commands that show an endpoint of a role."""
_FROM_A_PACKAGE = (RunsProgram, LaunchesFromPackage)
_LOOK = (
    "Find out why, with the tools of the course: {}, and the output of the program. Change the code "
    "that causes it, and check again."
)


@dataclass(frozen=True)
class Repairs:
    """An exercise in which a broken node is repaired, judged by the exercise about the right node.

    It is all or nothing, because a broken node often does half of the task. In the master, the broken code stands in
    comments ``#- `` above the solution that replaces it. A ticket of a bug hunt is a repair with a question
    (:mod:`autograder.kit.hunts.ticket`).

    Attributes:
        exercise_id: The lab's folder and the file's name, such as ``"bugs_1.dark_display"``.
        title: The title of the card, which must not tell the cause.
        task: One sentence that states the task, as the text of the lab does.
        judged_by: The id of the exercise that judges the repaired node. The broken node must fail it.
        after: Sentences about the cause, which the card shows after the pass.
        points: The points of the exercise.

    Example::

        EXERCISE = Repairs(
            "bugs_1.dark_display",
            "Bug hunt · The dark display",
            "Repair the display, so that it shows the numbers of the sensor.",
            "lab_1_2.listener",
            after=("The display subscribed to a topic with a misspelt name. ROS 2 does not report that.",),
        ).exercise()
    """

    exercise_id: str
    title: str
    task: str
    judged_by: str
    after: Sequence[str]
    points: float = POINTS

    def exercise(self) -> Exercise:
        """Return the finished exercise."""
        judged = cast("Exercise", importlib.import_module(self.judged_by).EXERCISE)

        def works(evidence: Evidence) -> Finding:
            finding = judged.judge_as_one(evidence, "all that was asked for")
            return finding if finding.passed else _symptom(judged, evidence)

        def told(text: str) -> Callable[[Evidence], str]:
            return lambda evidence: text if works(evidence).passed else ""

        return replace(
            judged,
            id=self.exercise_id,
            title=self.title,
            task=self.task,
            criteria=(Criterion("repaired", "Works again", self.points, works),),
            mistakes=[_without_diagnosis(judged, known) for known in (*judged.mistakes, _ANY_OTHER)],
            remarks=[told(text) for text in self.after],
            text={self.task: "repaired"},
            counts={},
            hides_causes=True,
            enough=_ENOUGH,
        )


_ANY_OTHER = Mistake("unknown", lambda _: Advice("", ""))


def _without_diagnosis(judged: Exercise, known: Mistake) -> Mistake:
    """Return a mistake that is recognized as before, and whose advice tells only the symptom."""

    def recognize(evidence: Evidence) -> Advice | None:
        advice, symptom = known.recognize(evidence), _symptom(judged, evidence)
        asked = "" if symptom.expected == _ASKED else f"Asked for: {symptom.expected}. "
        text = f"{asked}Seen: {symptom.seen}."
        return replace(advice, text=text, next_step=_next_step(judged, evidence), uses=()) if advice else None

    return replace(known, recognize=recognize)


def _next_step(judged: Exercise, evidence: Evidence) -> str:
    """Return the advice to use the commands that show what the exercise is about."""
    tools = [_TOOLS[role] for role in evidence.reference.interface if role in _TOOLS]
    built = [_INSTALLED] if isinstance(judged.runner, _FROM_A_PACKAGE) else []
    return _LOOK.format(", ".join(dict.fromkeys(["`ros2 node info`", *built, *tools])))


def _symptom(judged: Exercise, evidence: Evidence) -> Finding:
    """Return what a user notices of a node that does not work: what never came, or else the first failed criterion."""
    # Chance decides what the judge hears of a node that ends soon.
    if raised := next((part.traceback for part in evidence if part.ending and part.traceback), ""):
        return Finding(False, _ASKED, f"the program ended with an error: {what_and_where(raised)}")
    for role, names in evidence.reference.interface.items():
        kind, words = _NOTHING_CAME.get(role, ("", ""))
        for name in names if kind else ():
            if not any(part.of(kind, name) for part in evidence):
                return Finding(False, _ASKED, words.format(name))
    seen = without_causes(evidence)
    found = {one.title: one.judge(seen) for one in judged.criteria}
    failed = (
        Finding(False, f"“{title}”: {one.expected}", one.seen)
        for title, one in found.items()
        if not one.passed
    )
    return next(failed, Finding(False, _ASKED, "not what was asked for"))


def without_causes(evidence: Evidence) -> Evidence:
    """Return the evidence without what tells a cause: wrong names and types, and QoS settings that do not fit.

    Of a role that the exercise does not ask for, it keeps the names that the exercise knows from other roles.
    """
    asked = evidence.reference.interface
    names = {name: kind for ends in asked.values() for name, kind in ends.items()}

    def events(part: Part) -> Iterator[Event]:
        for event in part.events:
            if event.kind == "interface":
                ends = {
                    role: dict(ends.items() & asked.get(role, names).items())
                    for role, ends in event.data.items()
                    if role in _NOTHING_CAME
                }
                yield replace(event, data={**event.data, **ends})
            elif event.kind not in _TELLS_THE_CAUSE and _WARNING not in str(event.data.get("text")):
                yield event

    return replace(evidence, parts=[replace(part, events=[*events(part)]) for part in evidence])
