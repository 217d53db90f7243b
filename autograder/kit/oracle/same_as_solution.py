"""A recipe in which the reference solution decides what is right: the author declares only inputs and outputs.

While the reference output is recorded, the solution is given several drawings of the inputs. A check draws one of them,
gives the same inputs to the subject, and compares the outputs step by step. So the rule of the task is written once, in
the solution.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from random import Random
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from autograder.kit.draft import OWN, Draft
from autograder.kit.in_words import counted
from autograder.kit.model import Advice, Finding, Mistake, Pace
from autograder.kit.oracle.action_server import IN_EXECUTE
from autograder.kit.oracle.goal_sender import GoalSender
from autograder.kit.oracle.steps import Goal, Serves, Sets, Step, parameter_in_words, parameter_value
from autograder.kit.outcomes import all_goals
from autograder.kit.recipes.own_scenario import QUIET, Met, OwnScenario, meet, pick
from autograder.kit.recipes.relay import To
from autograder.kit.rules import in_words, same

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence, Part
    from autograder.kit.model import Bench, Exercise

__all__ = ["Goal", "SameAsSolution", "Serves", "Sets", "To"]

DRAWINGS = 4
"""The number of drawings of the inputs in a recording."""
PAUSE = 0.75
"""Seconds of the subject's time after each input. Whatever the input changes must be published by then."""
TOLERANCE = 1e-3
"""The tolerance for numbers, absolute or relative to the larger one."""
ONE_MISSING_IN = 4
"""One more or one fewer of this many messages may come, because each node asks and tells at its own moments."""
NOTHING: Mapping[str, Any] = MappingProxyType({})
SET = ("set_parameters", "rcl_interfaces/srv/SetParameters")
DESCRIBE = ("describe_parameters", "rcl_interfaces/srv/DescribeParameters")
DESCRIBED = ("type", "ranges")
POINTS = 10.0
"""The points of an exercise whose author does not say how many it is worth."""


class _Drawn(OwnScenario):
    """A subject that was given one drawing of the inputs; it is compared with the solution in the same drawing."""

    def expected(self, evidence: Evidence) -> Part:
        """Return the record of the solution in the drawing that the subject was given."""
        recorded = evidence.reference.parts
        return evidence.reference.part(evidence.main.name) if recorded else evidence.main

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, and first of all an exercise's own: that it does the same as a recorded wrong answer."""
        proven = Mistake(
            "variant", lambda evidence: self._same_as_a_variant(evidence, simulated=True), certain=True
        )
        likely = Mistake("variant", self._same_as_a_variant)
        ladder = super().ladder
        at = ladder.index(OWN)
        in_execute = IN_EXECUTE if "action_server" in self.roles else ()
        return (*in_execute, *ladder[:at], proven, likely, *ladder[at:])

    def _same_as_a_variant(self, evidence: Evidence, *, simulated: bool = False) -> Advice | None:
        mine, right = _noted(evidence.main), _noted(self.expected(evidence))
        if simulated and any(event.sim is None for event in evidence.main.of("noted")):
            return None
        for variant in evidence.reference.variants:
            part = next((part for part in variant.parts if part.name == evidence.main.name), None)
            if part and mine and same(mine, _noted(part), TOLERANCE) and not same(mine, right, TOLERANCE):
                return Advice(variant.text, variant.next_step, key=variant.key)
        return None


def _noted(part: Part) -> list[Any]:
    return [[event.name, event.data["step"], event.data["values"]] for event in part.of("noted")]


class SameAsSolution:
    """An exercise about a node that must do what the reference solution does with the same inputs.

    After each input the judge notes the outputs of this step: for a topic, the last message since the step before; for
    a service that the input calls, its answer; for an action, what came of each goal.

    Args:
        exercise_id: The lab's folder and the file's name, such as ``"lab_2_5.agent"``.
        title: The title of the card, naming the lab and the subject.
        task: One sentence that states the task.
        gives: Draws the steps: each is an input, :class:`To` a topic or service or a :class:`Goal` to an action, or a
            number of seconds of the subject's time without an input. It must draw the same number of steps each time.
        tells: For each topic or service of the subject, the path of the field that is compared, such as ``"data"`` or
            ``"linear.x"``; a tuple of paths if there are several. For an action, ``("status", "feedback.left",
            "result.arrived")``.
        lists: The same for topics of which all messages are compared, in order, however they are spread over the steps.
            The last ones may be missing, or be more.
        serves: The services that the subject calls, by name, and how the judge answers: at once, late or never.
        parameters: The names of the parameters whose description (type and range) is compared, and which values of
            them are taken and which are refused with a reason, if a step :class:`Sets` them.
        late_after: Seconds of the subject's time after which the judge subscribes, and asks for the last message, too.
        every: True to compare all messages of a step, not only the last: for a node that answers each input.
        pause: Seconds of the subject's time after each input.
        tolerance: The absolute or relative tolerance for numbers.
        roles: The roles of the subject's endpoints, the most telling first.
        points: The points of the exercise. All criteria are worth the same.

    Example::

        EXERCISE = SameAsSolution(
            "lab_8_1.brake",
            "A rule · The brake",
            "Drive, but stand still in front of a wall.",
            gives=lambda random: [To("/distance", random.choice((0.2, 0.9))) for _ in range(12)],
            tells={"/cmd_vel": ("linear.x", "angular.z")},
        ).exercise()
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        gives: Callable[[Random], Sequence[Step]],
        tells: Mapping[str, str | tuple[str, ...]] = NOTHING,
        lists: Mapping[str, str | tuple[str, ...]] = NOTHING,
        serves: Mapping[str, Serves] = NOTHING,
        parameters: Sequence[str] = (),
        late_after: float = 0.0,
        every: bool = False,
        pause: float = PAUSE,
        tolerance: float = TOLERANCE,
        roles: Sequence[str] = ("publisher", "subscription"),
        points: float = POINTS,
    ) -> None:
        self._id, self._gives, self._serves = exercise_id, gives, serves
        self._every, self._pause, self._tolerance = every, pause, tolerance
        self._parameters, self._late_after = parameters, late_after
        described = dict.fromkeys(parameters, DESCRIBED)
        self._paths = {
            n: (p,) if isinstance(p, str) else p for n, p in {**tells, **lists, **described}.items()
        }
        self._lists = lists.keys()
        self._draft = Draft(exercise_id, title, task, _Drawn(self._scenario, *roles))
        for name, paths in self._paths.items():
            # Every message of std_msgs has a field named data, so this name says nothing on a card.
            what = " and ".join(path for path in paths if path != "data")
            line = f"Says the right {what or 'value'} on {name}"
            if name in parameters:
                line = f"Describes the parameter {name}, takes the right values and refuses the others"
            agrees = partial(self._same_list if name in lists else self._same_steps, name)
            self._draft.criterion(name.strip("/"), points / len(self._paths), line)(agrees)

    def exercise(self, **more: Any) -> Exercise:
        """Return the finished exercise. For ``more`` see :meth:`autograder.kit.draft.Draft.exercise`."""
        return self._draft.exercise(recorded=("noted",), **more)

    def _scenario(self, bench: Bench) -> None:
        drawings = range(DRAWINGS if self._gives(Random(0)) != self._gives(Random(1)) or self._serves else 1)
        is_recording = not bench.reference.parts
        for drawing in drawings if is_recording else [bench.random.choice(drawings)]:
            drawn = Random(f"{self._id} {drawing}")
            steps = self._gives(drawn)
            serve = partial(self._serve, bench, drawn)
            plays = partial(self._plays, steps)
            meet(bench, f"drawing {drawing}", plays, serve, listens=not self._late_after)

    def _serve(self, bench: Bench, drawn: Random, service: str, kind: str) -> None:
        how = self._serves[service]
        bench.serve(service, kind, lambda _: how.answer(drawn), late=how.late, never=how.never)

    def _plays(self, steps: Sequence[Step], met: Met) -> bool:
        """Give the subject all steps. Return False as soon as the subject does not answer."""
        bench = met.bench
        if self._late_after:
            bench.run_time(self._late_after)
            for topic, kind in bench.reference.interface["publisher"].items():
                bench.listen(topic, kind, latched=True)
            bench.wait_until(lambda e: bool(e.main.of("mismatch") or e.main.of("message")), QUIET[bench.pace])
        went_through = self._describe(bench) and all(
            self._takes(met, number, step) for number, step in enumerate([self._pause, *steps])
        )
        for name in self._lists:
            bench.note(name, step=0, given="", values=self._values(name, bench.seen().events))
        # In real time nothing has proved so far that the subject's executor is alive.
        return went_through and bench.pace is Pace.FAST

    def _takes(self, met: Met, number: int, step: Step) -> bool:
        """Give the subject one step, and note its outputs. Return False if the subject does not answer."""
        bench = met.bench
        before = 0 if number == 0 else len(bench.seen().events)
        went_through = True
        if not isinstance(step, (int, float)):
            went_through = self._given(met, step)
            if not (went_through or isinstance(step, Goal)):
                return False
            bench.settle()
        if not bench.run_time(step if isinstance(step, (int, float)) else self._pause):
            return False
        bench.settle()
        events = bench.seen().events[before:]
        given = f"{step:g} s without an input" if isinstance(step, (int, float)) else step.name
        # The words of a refusal are the student's own, so only the presence of a reason is compared.
        if isinstance(step, Sets):
            given = f"{step.parameter} = {step.value}"
            result = next(e.data["fields"]["results"][0] for e in events if e.kind == "answered")
            taken = [result["successful"], bool(result["reason"])]
            bench.note(step.parameter, step=number, given=given, values=[taken])
        outcomes: dict[str, list[list[Any]]] = {}
        if isinstance(step, Goal):
            given = str(step)
            sent = all_goals(bench.seen())[-len(step.goals) :]
            for one, goal in zip(step.goals, sent, strict=True):
                outcomes.setdefault(one.name, []).append(
                    [one.outcome(goal, path) for path in self._paths[one.name]]
                )
        for name in self._paths.keys() - self._lists - set(self._parameters):
            values = self._values(name, events)
            last = values if self._every else values[-1:]
            bench.note(name, step=number, given=given, values=outcomes.get(name, last))
        return went_through

    def _given(self, met: Met, step: To | Sets | Goal) -> bool:
        """Give the subject an input. Return False if it should answer and does not."""
        bench, ends = met.bench, met.bench.reference.interface
        if isinstance(step, Sets):
            value = {"name": step.parameter, "value": parameter_value(step.value)}
            return self._ask(bench, step.node, SET, {"parameters": [value]})
        speakers, callers, clients = (
            dict(zip(sorted(ends.get(role, {})), made, strict=True))
            for role, made in (
                ("subscription", met.speakers),
                ("service", met.callers),
                ("action_server", met.action_callers),
            )
        )
        if step.name not in {**speakers, **callers, **clients}:
            raise ValueError(
                f"gives: {step.name!r} is not one of {', '.join([*speakers, *callers, *clients])}"
            )
        if isinstance(step, Goal):
            return step.play(GoalSender(bench, clients[step.name], simulated=True))
        whole = step.value if isinstance(step.value, Mapping) else {"data": step.value}
        if step.name in callers:
            callers[step.name].ask(whole)
            return callers[step.name].await_answers(QUIET[bench.pace])
        speakers[step.name].send(**whole)
        return True

    def _describe(self, bench: Bench) -> bool:
        """Note the types and ranges of the parameters. Return False if the subject does not answer."""
        if not self._parameters:
            return True
        if not (bench.await_node() and self._ask(bench, "", DESCRIBE, {"names": [*self._parameters]})):
            return False
        described = bench.seen().of("answered")[-1].data["fields"]["descriptors"]
        for name, one in zip(self._parameters, described, strict=False):
            ranges = [
                [r["from_value"], r["to_value"]]
                for r in (*one["floating_point_range"], *one["integer_range"])
            ]
            bench.note(name, step=0, given="", values=[[one["type"], ranges]])
        return True

    @staticmethod
    def _ask(bench: Bench, node: str, service: tuple[str, str], request: Mapping[str, Any]) -> bool:
        nodes = (name for survey in bench.seen().of("interface") for name in survey.data["nodes"])
        name, kind = service
        caller = bench.call(f"{node or next(nodes, '')}/{name}", kind)
        if not caller.await_server(QUIET[bench.pace]):
            return False
        caller.ask(request)
        return caller.await_answers(QUIET[bench.pace])

    def _values(self, name: str, events: Sequence[Event]) -> list[list[Any]]:
        told = [e.data["fields"] for e in events if e.kind in ("message", "answered") and e.name == name]
        return [[pick(fields, path) for path in self._paths[name]] for fields in told]

    def _same_steps(self, name: str, seen: Part, expected: Part) -> Finding:
        """Decide whether the outputs on a topic, or of a service, are the solution's. Show the first that is not."""
        mine, theirs = seen.of("noted", name), expected.of("noted", name)
        for made, due in zip(mine, theirs, strict=False):
            if not same(made.data["values"], due.data["values"], self._tolerance):
                return Finding(False, self._at_step(name, due), self._at_step(name, made))
        if len(mine) < len(theirs):
            return Finding(
                False, self._at_step(name, theirs[len(mine)]), "nothing: your node did not get that far"
            )
        return Finding(True, right := f"the same as the solution in all {len(theirs)} steps", right)

    def _same_list(self, name: str, seen: Part, expected: Part) -> Finding:
        """Decide whether the messages on a topic are the solution's, in order. Show those around a difference."""
        mine, theirs = _listed(seen, name), _listed(expected, name)
        both = min(len(mine), len(theirs))
        differs = next((n for n in range(both) if not same(mine[n], theirs[n], self._tolerance)), both)
        missing = abs(len(mine) - len(theirs))
        around = slice(max(0, differs - 2), differs + 2)
        due, came = (
            f"{self._in_words(name, listed[around])} ({counted(len(listed), 'message')} in all)"
            for listed in (theirs, mine)
        )
        return Finding(differs == both and missing <= 1 + len(theirs) // ONE_MISSING_IN, due, came)

    def _at_step(self, name: str, noted: Event) -> str:
        after = (
            f"after step {noted.data['step']} ({noted.data['given']})"
            if noted.data["step"]
            else "at the start"
        )
        return f"{self._in_words(name, noted.data['values'])} {after}"

    def _in_words(self, name: str, listed: Sequence[Sequence[Any]]) -> str:
        if name in self._parameters:
            return "; ".join(map(parameter_in_words, listed)) or "nothing"
        paths = self._paths[name]
        named = ("" if path == "data" else f"{path} = " for path in paths)
        prefixes = list(named)
        told = [
            ", ".join(p + in_words([v]) for p, v in zip(prefixes, values, strict=True)) for values in listed
        ]
        return "; ".join(told) or "nothing"


def _listed(part: Part, name: str) -> list[Any]:
    return [values for event in part.of("noted", name) for values in event.data["values"]]
