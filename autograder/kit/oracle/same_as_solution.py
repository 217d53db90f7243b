"""A recipe in which the reference solution decides what is right: the author declares only inputs and outputs.

While the reference output is recorded, the solution is given several drawings of the inputs. A check draws one of them,
gives the same inputs to the subject, and compares the outputs step by step. So the rule of the task is written once, in
the solution.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import zip_longest
from random import Random
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from autograder.kit.bench import Pace
from autograder.kit.counterparts import Qos
from autograder.kit.draft import POINTS, Draft
from autograder.kit.mistakes.common_mistakes import KEEP_THE_PERIOD, NOT_LATCHED, is_not_latched
from autograder.kit.model import Finding, card_words
from autograder.kit.oracle.goal_sender import GoalSender
from autograder.kit.oracle.mistakes_again import MistakesAgain
from autograder.kit.oracle.naming.calls_in_turn import IN_TURN, called_in_turn
from autograder.kit.oracle.naming.drawn import Drawn
from autograder.kit.oracle.outputs import NUMBER, Kind, Output
from autograder.kit.oracle.parameter_answers import (
    DESCRIBE,
    DESCRIBED,
    SET,
    described,
    parameter_value,
    received,
)
from autograder.kit.oracle.standing_clock import noted_before
from autograder.kit.oracle.steps import Goal, Sets, Step, To, Turn, answer_delays
from autograder.kit.recipes.own_scenario import QUIET, Met, meet

if TYPE_CHECKING:
    from collections.abc import Container

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Event, Part, Reference
    from autograder.kit.model import Exercise

_WORDS = card_words(__file__)
__all__ = ["Goal", "SameAsSolution", "Sets", "To"]

DRAWINGS = 4
"""The number of practice drawings of the inputs, which every hand-out contains."""
DRAWING = "drawing "
"""The beginning of a drawing's name. The rest is the seed: a number for practice, a secret one for a class."""
PAUSE = 0.75
"""Seconds of the subject's time after each input. Whatever the input changes must be published by then."""
PERIODS = 3
"""The number of periods in a row that show a rate, without an input in any of them."""
MANY = 100
"""The most feedback messages of a goal that are expected if the feedback is not compared."""
TOLERANCE = 1e-3
"""The tolerance for numbers, absolute or relative to the larger one."""
NOTHING: Mapping[str, Any] = MappingProxyType({})


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
        serves: The services that the subject calls, by name, with a function that draws the fields of an answer. An
            input says when the call is answered that it leads to (:attr:`To.answered`).
        parameters: The names of the parameters whose description (type and range) is compared, and which values of
            them are taken and which are refused with a reason, if a step :class:`Sets` them.
        waits: Seconds of wall time before the first step. What the subject says by itself so early is compared, too.
        late_after: Seconds of the subject's time after which the judge gives the first input. It subscribes only after
            that, and asks for the last message, too.
        qos: The topics on which the QoS counts: the judge's endpoint gets the QoS of the solution's, and an endpoint
            that does not match gets or tells nothing.
        every: The topics of which all messages of a step are compared, not only the last one, because the task asks for
            one message for each input; True for all of ``tells``. While a goal that the judge cancels is at work, the
            last one is compared.
        rates: The topics for which the task asks for a period, with this period in seconds. A node that publishes more
            often or less often fails; it may be silent for some time, or publish once more at an input. So only
            intervals without an input show a period, and ``gives`` needs three periods in a row without one. On
            other topics, the period is the student's.
        pause: Seconds of the subject's time after each input.
        tolerance: The absolute or relative tolerance for numbers.
        roles: The roles of the subject's endpoints, the most telling first, of ``"publisher"``, ``"subscription"``,
            ``"service"``, ``"client"``, ``"action_server"`` and ``"action_client"``.
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

    _told = Kind.STEPS

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        gives: Callable[[Random], Sequence[Step]],
        tells: Mapping[str, str | tuple[str, ...]] = NOTHING,
        lists: Mapping[str, str | tuple[str, ...]] = NOTHING,
        serves: Mapping[str, Callable[[Random], Mapping[str, Any]]] = NOTHING,
        parameters: Sequence[str] = (),
        waits: float = 0.0,
        late_after: float = 0.0,
        qos: Sequence[str] = (),
        every: bool | Container[str] = False,
        rates: Mapping[str, float] = NOTHING,
        pause: float = PAUSE,
        tolerance: float = TOLERANCE,
        roles: Sequence[str] = ("publisher", "subscription"),
        points: float = POINTS,
    ) -> None:
        self._id, self._gives, self._serves = exercise_id, gives, serves
        self._every = tells if every is True else every or ()
        self._pause, self._tolerance = pause, tolerance
        self._waits, self._late_after, self._qos = waits, late_after, qos
        kinds = {
            self._told: tells,
            Kind.LIST: lists,
            Kind.PARAMETER: dict.fromkeys(parameters, DESCRIBED),
        }
        steps = gives(Random(0))
        # What was published before the judge listened shows only in the number of a message.
        also = {self._told: (NUMBER,)} if late_after and steps else {}
        self._outputs = [
            self._output(name, (*((paths,) if isinstance(paths, str) else paths), *also.get(kind, ())), kind)
            for kind, outputs in kinds.items()
            for name, paths in outputs.items()
        ]
        self._outputs += [Output(name, (), Kind.RATE, tolerance, period) for name, period in rates.items()]
        self._is_drawn = steps != gives(Random(1)) or bool(serves)
        # A clock that stands still tells which clock a node asks. Then no other clock makes it right.
        stands = any(isinstance(step, To) and step.stands for step in steps)
        is_timed = not stands and any(isinstance(step, (int, float)) for step in steps)
        self._check_rates(rates, steps)
        drawn = self._drawn = Drawn(self._scenario, self._outputs, roles, is_timed=is_timed)
        self._draft = Draft(exercise_id, title, task, drawn, points=points)
        if late_after:
            self._draft.knows("not_latched", is_not_latched, *NOT_LATCHED, certain=True)
        if asks := {step.name for step in steps if isinstance(step, To) and step.answered is not None}:
            in_turn = partial(called_in_turn, serves, asks)
            self._draft.knows("one_at_a_time", in_turn, *IN_TURN, late=True)
        for output in self._of(Kind.PARAMETER):
            self._knows("parameter_not_declared", output.is_undeclared, output, certain=True)
            self._knows("other_range", output.other_description, output, certain=True)
        for output in self._of(Kind.RATE):
            self._knows("only_if_new", output.only_news, output, late=True)
            self._knows("wrong_rate", output.another_rate, output, late=True)
        for output in self._outputs:
            self._draft.criterion(output.key, output.title.replace("?", ""))(partial(_by_one_server, output))

    def _knows(self, key: str, found: Callable[[Part, Part], object], output: Output, **how: Any) -> None:
        """Add a mistake about one output, whose name and period its words contain."""
        words = (one.format(output=output, keep_the_period=KEEP_THE_PERIOD) for one in _WORDS[key])
        self._draft.knows(key, found, *words, **how)

    def _check_rates(self, rates: Mapping[str, float], steps: Sequence[Step]) -> None:
        """Raise ``ValueError`` if it would depend on chance whether two messages come without an input in between."""
        quiet = longest = self._pause
        for step in steps:
            quiet = quiet + step if isinstance(step, (int, float)) else self._pause
            longest = max(longest, quiet)
        for topic, period in rates.items():
            if longest < PERIODS * period:
                raise ValueError(
                    f"rates: to show a period of {period:g} s on {topic}, {PERIODS * period:g} s have to pass "
                    f"without an input, and it is {longest:g} s at most: add seconds at the end of gives"
                )

    def _output(self, name: str, paths: tuple[str, ...], kind: Kind) -> Output:
        """Return an output that is compared."""
        return Output(name, paths, kind, self._tolerance)

    def exercise(self, **more: Any) -> Exercise:
        """Return the finished exercise. For ``more`` see :meth:`autograder.kit.draft.Draft.exercise`."""
        self._drawn.law = more.get("text", {})
        return self._draft.exercise(
            recorded=("noted",), tolerance=self._tolerance, is_drawn=self._is_drawn, **more
        )

    def _scenario(self, bench: Bench) -> None:
        known = [part.name for part in bench.reference.parts]
        practice = [f"{DRAWING}{number}" for number in range(DRAWINGS if self._is_drawn else 1)]
        for name in [bench.random.choice(known)] if known else bench.reference.drawings or practice:
            drawn = Random(f"{self._id} {name.removeprefix(DRAWING)}")
            self._gives_to(bench, name, self._gives(drawn), drawn)

    def _gives_to(self, bench: Bench, part: str, steps: Sequence[Step], drawn: Random) -> None:
        """Run the subject once, and give it all steps of one drawing."""
        serve = partial(self._serve, bench, steps, drawn)
        plays = partial(self._plays, steps)
        meet(bench, part, plays, serve, listens=not self._late_after, qos=self._matching(bench.reference))

    def _matching(self, reference: Reference) -> dict[str, Qos]:
        """Return the QoS of the judge's endpoints on the topics on which it counts."""
        recorded = {topic: Qos(qos) for ends in reference.qos.values() for topic, qos in ends.items()}
        if usual := ", ".join(topic for topic in self._qos if topic not in recorded):
            raise ValueError(f"qos: on {usual} the solution has the default QoS, which each answer has")
        return {topic: recorded[topic] for topic in self._qos}

    def _serve(self, bench: Bench, steps: Sequence[Step], drawn: Random, service: str, kind: str) -> None:
        draws, (late, never) = self._serves[service], answer_delays(steps)
        bench.serve(service, kind, lambda _: draws(drawn), late=late, never=never)

    def _plays(self, steps: Sequence[Step], met: Met) -> bool:
        """Give the subject all steps. Return False as soon as the subject does not answer."""
        bench = met.bench
        if self._late_after:
            bench.run_time(self._late_after)
            unheard, steps = steps[:1], steps[1:]
            inputs = [step for step in unheard if not isinstance(step, (int, float))]
            if not (all(self._given(met, step) for step in inputs) and bench.run_time(self._pause)):
                return False
            for topic, kind in bench.reference.interface["publisher"].items():
                bench.listen(topic, kind, qos=Qos.LATCHED)
            bench.wait_until(lambda e: bool(e.main.of("mismatch") or e.main.of("message")), QUIET[bench.pace])
        turns: list[Turn] = []
        again = MistakesAgain(bench, self._outputs)
        begun = (
            Turn(number, step, len(bench.seen().events) if number else 0, bench.moment)
            for number, step in enumerate([self._pause, *steps])
        )
        went_through = self._describe(bench) and all(self._takes(met, one, turns, again) for one in begun)
        if bench.pace is Pace.REAL_TIME:
            bench.settle()
            for turn, following in zip_longest(turns, turns[1:]):
                self._notes(bench, turn, following)
        for output in self._of(Kind.LIST):
            seen = bench.seen().of("message", output.name)
            stepped = sum(event.sim is not None for event in seen)
            bench.note(output.name, step=0, given="", values=output.values(seen), stepped=stepped)
        # In real time nothing has proved so far that the subject's executor is alive.
        return went_through and bench.pace is Pace.FAST

    def _takes(self, met: Met, turn: Turn, turns: list[Turn], again: MistakesAgain) -> bool:
        """Give the subject one step, and note its outputs. Return False if the subject does not answer."""
        bench, step = met.bench, turn.step
        if turn.number == 0:
            # A node that begins to count before the first input does so in real time.
            bench.wait_until(lambda evidence: bool(evidence.main.of("message")), self._waits)
        went_through = True
        if not isinstance(step, (int, float)):
            try:
                went_through = self._given(met, step)
            except ValueError as error:
                raise ValueError(f"Step {turn.number} gives {error}") from error
            # What is wrong with a goal that does not end is compared, too.
            if not (went_through or isinstance(step, Goal)):
                return False
        if bench.pace is Pace.FAST and not isinstance(step, (int, float)):
            bench.settle()
            if isinstance(step, To):
                bench.wait_until(lambda _: False, step.stands)
        if not bench.run_time(step if isinstance(step, (int, float)) else self._pause):
            return False
        turns.append(turn)
        if bench.pace is Pace.FAST:
            bench.settle()
            self._notes(bench, turn)
        again.end_look(
            len(turns), lambda output, number: self._values(bench, output, *turns[number : number + 2])
        )
        return went_through

    def _notes(self, bench: Bench, turn: Turn, following: Turn | None = None) -> None:
        """Note the outputs of a step.

        In real time this comes after the last step: to settle in between would take the longer, the busier the machine.
        A message then belongs to the step in which it was sent.
        """
        step = turn.step
        given = f"{step:g} s without an input" if isinstance(step, (int, float)) else str(step)
        stood = {"stood": step.stands} if isinstance(step, To) and step.stands else {}
        if isinstance(step, Sets):
            given = f"{step.parameter} = {step.value}"
            values = [received(self._events(bench, turn, following))]
            bench.note(step.parameter, step=turn.number, given=given, values=values)
        for output in self._of(Kind.STEPS):
            values = self._values(bench, output, turn, following)
            bench.note(output.name, step=turn.number, given=given, values=values, **stood)

    def _values(self, bench: Bench, output: Output, turn: Turn, following: Turn | None = None) -> list[Any]:
        """Return the values of an output in a step."""
        seen, step = bench.seen(), turn.step
        if output.kind is Kind.PARAMETER:
            described = next(event.data["values"] for event in seen.of("noted", output.name))
            return [received(self._events(bench, turn, following))] if turn.number else described
        if isinstance(step, Goal) and output.name == step.name:
            until = following.first if following else None
            return step.outcomes(replace(seen, events=seen.events[:until]), output.paths)
        values = output.values(self._events(bench, turn, following))
        # A publisher may keep more than its last message for late subscribers.
        is_late = self._late_after and turn.number == 0
        # How many messages are sent before a cancel depends on the moment at which it comes.
        is_cut_off = isinstance(step, Goal) and step.cancel_after is not None
        if output.name not in self._every or is_late or is_cut_off:
            values = values[-1:]
        if isinstance(step, To) and step.stands and bench.before:
            values = noted_before(bench.before.part(seen.name), output.name, turn.number, values)
        return values

    @staticmethod
    def _events(bench: Bench, turn: Turn, following: Turn | None) -> list[Event]:
        return turn.events(bench.seen(), following, by_time=bench.pace is Pace.REAL_TIME)

    def _given(self, met: Met, step: To | Sets | Goal) -> bool:
        """Give the subject an input. Return False if it should answer and does not."""
        bench, ends = met.bench, met.bench.reference.interface
        if isinstance(step, Sets):
            value = {"name": step.parameter, "value": parameter_value(step.value)}
            return self._ask(bench, step.node, SET, {"parameters": [value]})
        roles = (
            ("subscription", met.speakers),
            ("service", met.callers),
            ("action_server", met.action_callers),
        )
        clients: dict[str, Any] = {
            name: client
            for role, made in roles
            for name, client in zip(sorted(ends.get(role, {})), made, strict=True)
        }
        if step.name not in clients:
            raise ValueError(f"{step.name!r}, which is not one of {', '.join(clients)}")
        if isinstance(step, Goal):
            most = self._most_feedback(bench, step.name)
            return step.play(GoalSender(bench, clients[step.name], most=most, simulated=True))
        whole = step.value if isinstance(step.value, Mapping) else {"data": step.value}
        if step.name in ends.get("service", {}):
            clients[step.name].ask(whole)
            return bool(clients[step.name].await_answers(QUIET[bench.pace]))
        clients[step.name].send(**whole)
        return True

    def _most_feedback(self, bench: Bench, action: str) -> float:
        """Return the most feedback messages that a goal of the solution sends; many if that is not compared."""
        noted = [event.data["values"] for part in bench.reference.parts for event in part.of("noted", action)]
        paths = next((output.paths for output in self._of(Kind.STEPS) if output.name == action), ())
        told = [i for i, path in enumerate(paths) if path.startswith("feedback")]
        return max((len(row[i]) for values in noted for row in values for i in told), default=MANY)

    def _describe(self, bench: Bench) -> bool:
        """Note the types and ranges of the parameters. Return False if the subject does not answer."""
        for name in [output.name for output in self._of(Kind.PARAMETER)]:
            if not self._ask(bench, "", DESCRIBE, {"names": [name]}):
                return False
            bench.note(name, step=0, given="", values=[described(bench.seen().events)])
        return True

    @staticmethod
    def _ask(bench: Bench, node: str, service: tuple[str, str], request: Mapping[str, Any]) -> bool:
        if not bench.watch_graph(lambda evidence: bool(_nodes(evidence.main, node)), QUIET[bench.pace]):
            return False
        name, kind = f"{_nodes(bench.seen(), node)[0]}/{service[0]}", service[1]
        caller = bench.call(name, kind)
        if not caller.await_server(QUIET[bench.pace]):
            return False
        # A caller counts all answers of a service, and those of earlier steps came to other callers.
        earlier = len(bench.seen().of("answered", name))
        caller.ask(request)
        return bench.wait_until(
            lambda evidence: len(evidence.main.of("answered", name)) > earlier, QUIET[bench.pace]
        )

    def _of(self, kind: Kind) -> list[Output]:
        return [output for output in self._outputs if output.kind is kind]


def _by_one_server(output: Output, seen: Part, expected: Part) -> Finding:
    """Compare an output, unless several servers have its name: each gets the call, and chance decides who answers."""
    count = max((event.data["count"] for event in seen.of("servers", output.name)), default=0)
    if count > 1:
        return Finding(False, f"one server of {output.name}", f"{count} servers of {output.name}")
    return output.compared(seen, expected)


def _nodes(part: Part, begins: str) -> list[str]:
    """Return the full names of the subject's nodes that begin with a text, in the order in which they were seen."""
    surveys = part.of("interface", "graph")
    return [node for survey in surveys for node in survey.data["nodes"] if node.startswith(begins)]
