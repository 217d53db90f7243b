"""Exercises that are declared: the author says what is due, and the judge's steps and the verdict follow from that.

A :class:`Relay` hears on one topic and publishes on another. A :class:`Machine` has a state that a service changes and
a topic tells of. A wrong answer that students often give is a variant of the function that says what is due.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from typing import TYPE_CHECKING, Any

from autograder.kit.draft import Draft
from autograder.kit.model import Finding, Pace
from autograder.kit.recipes.own_scenario import OwnScenario, once_met
from autograder.kit.rules import SOME_TEXT, in_words, same, value

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.counterparts import Caller
    from autograder.kit.evidence import Event, Part
    from autograder.kit.model import Bench, Exercise
    from autograder.kit.recipes.own_scenario import Met

__all__ = ["NAN", "SILENCE", "SOME_TEXT", "Machine", "Relay"]

NAN = float("nan")
SILENCE = object()
"""What is due after an input for which nothing is to be published."""
PATIENCE = {Pace.FAST: 2.0, Pace.REAL_TIME: 6.0}
"""Seconds of wall time in which the last message must have come."""
QUIET = {Pace.FAST: 3.0, Pace.REAL_TIME: 6.0}
"""Seconds of wall time without any event after which the judge waits no longer for an answer or a message."""
PAUSE = 0.5
"""Seconds of the subject's time after each answer in which a timer of the subject may tell of the change."""

Due = Callable[[Sequence[Any]], Any]
"""From all inputs so far to the value that is due after the last one, or :data:`SILENCE`."""
Step = Callable[[Any, Any], tuple[Any, Mapping[str, Any]]]
"""From the state and what is asked for to the new state and the fields of the reply."""


class Declared:
    """What the declared exercises share.

    Args:
        exercise_id: Such as ``"lab_8_1.filter"``.
        title: For the card: the lab and what the subject is.
        task: One sentence: what is asked for.
        scenario: Drives the bench.
        roles: The endpoints of the subject, the most telling first.
        given: The kind of event of an input that the subject has surely received. A subject that received fewer
            inputs than the reference solution fulfils no criterion on what it made of them.
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        scenario: Callable[[Bench], None],
        *roles: str,
        given: str,
    ) -> None:
        self._subject = OwnScenario(scenario, *roles)
        self._draft = Draft(exercise_id, title, task, self._subject)
        self._text: dict[str, str] = {}
        self._given = given
        self._tolerance = 1e-6

    def asks(self, name: str, points: float, title: str, role: str, words: str = "") -> None:
        """Add a criterion: the endpoints of a role have the names and types of the reference solution's.

        Args:
            name: A stable key.
            points: Points it carries.
            title: One line for a person.
            role: Such as ``"subscription"``.
            words: The words of the task that the criterion judges, as ``lab.md`` has them.
        """
        self._draft.asks(name, points, title, self._subject.has(role))
        self._judges(name, words)

    def exercise(self) -> Exercise:
        """Return the exercise, once everything is said of it."""
        return self._draft.exercise(text=self._text)

    def _compares(
        self,
        name: str,
        points: float,
        title: str,
        due: Callable[[Part], Sequence[Any]],
        came: Callable[[Part], Sequence[Any]],
        words: str,
    ) -> None:
        def judge(seen: Part, expected: Part) -> Finding:
            wanted, made = due(seen), came(seen)
            if not wanted:
                return Finding(False, f"such as {in_words(due(expected))}", in_words(made))
            whole = self._got_through(seen, expected)
            more = "" if whole else ", and more after that"
            passed = whole and same(list(wanted), list(made), self._tolerance)
            return Finding(passed, in_words(wanted) + more, in_words(made))

        self._draft.criterion(name, points, title)(judge)
        self._judges(name, words)

    def _got_through(self, seen: Part, expected: Part) -> bool:
        """Return whether the subject was given as much as the reference solution."""
        return len(seen.of(self._given)) >= len(expected.of(self._given))

    def _judges(self, name: str, words: str) -> None:
        if words:
            self._text[words] = f"{self._text[words]} {name}" if words in self._text else name

    def _knows(self, key: str, found: Callable[[Part], bool], says: str, next_step: str) -> None:
        self._draft.knows(key, lambda seen, _: found(seen), says, next_step, certain=True)


class Relay(Declared):
    """A node that hears on one topic and publishes on another what follows from all inputs so far.

    Args:
        exercise_id: Such as ``"lab_8_1.filter"``.
        title: For the card: the lab and what the subject is.
        task: One sentence: what is asked for.
        field: The path of the field that is heard and published, such as ``"range"`` or ``"pose.position.x"``.
        gives: Draws the inputs; as many in each run.
        due: Says what is due after the last of the inputs so far, or :data:`SILENCE`.
        copies: The path of a field that each output copies from its input, such as ``"header.stamp"``. A field of
            another name than ``stamp`` is a text.
        tolerance: How far a number may differ, absolute or relative.
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        field: str,
        gives: Callable[[Random], Sequence[Any]],
        due: Due,
        copies: str = "",
        tolerance: float = 1e-6,
    ) -> None:
        scenario = once_met(self._happens)
        super().__init__(exercise_id, title, task, scenario, "subscription", "publisher", given="sent")
        self._field, self._gives, self._due, self._copied = field, gives, due, copies
        self._tolerance = tolerance

    def answers(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add a criterion: exactly what is due comes, in order; the arguments are those of :meth:`asks`."""
        self._compares(name, points, title, lambda seen: self._made(seen, self._due), self._outputs, words)

    def copies(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add a criterion: each output has the copied field of the input that it answers.

        Inputs and outputs are aligned at the end, so that a message too many or too few does not count twice.
        """
        self._compares(name, points, title, self._copies_due, self._copies_made, words)

    def wrong(self, key: str, due: Due, says: str, next_step: str) -> None:
        """Add a mistake: all outputs are what a variant of ``due`` gives, as far as the subject came.

        Args:
            key: A stable name.
            due: The variant.
            says: What the student is told.
            next_step: What to do about it.
        """

        def found(seen: Part) -> bool:
            made = self._outputs(seen)
            right, other = self._made(seen, self._due), self._made(seen, due)[: len(made)]
            return bool(made) and not self._equal(right, made) and self._equal(other, made)

        self._knows(key, found, says, next_step)

    def not_copied(self, key: str, says: str, next_step: str) -> None:
        """Add a mistake: the field that is to be copied is empty; the arguments are those of :meth:`wrong`."""
        self._knows(
            key, lambda seen: any(map(_is_empty, _picked(seen, "message", self._copied))), says, next_step
        )

    def too_early(self, key: str, says: str, next_step: str) -> None:
        """Add a mistake: the subject publishes before anything is due; the arguments are those of :meth:`wrong`."""

        def found(seen: Part) -> bool:
            inputs = self._inputs(seen)
            silent = next(
                (n for n in range(1, len(inputs) + 1) if self._due(inputs[:n]) is not SILENCE),
                len(inputs) + 1,
            )
            kinds = [event.kind for event in seen.events if event.kind in ("sent", "message")]
            return "message" in kinds and kinds[: kinds.index("message")].count("sent") < silent

        self._knows(key, found, says, next_step)

    def _happens(self, met: Met) -> bool:
        inputs = list(self._gives(met.bench.random))
        for number, given in enumerate(inputs, 1):
            fields: dict[str, Any] = {}
            if self._copied:
                stamp = {"sec": 1000 + number, "nanosec": number}
                _put(fields, self._copied, stamp if self._copied.endswith("stamp") else f"input_{number}")
            _put(fields, self._field, given)
            met.speakers[0].send(**fields)
            met.bench.settle()
        wanted = len(_outputs_due(inputs, self._due))
        came = met.bench.wait_until(lambda _: met.heard >= wanted, PATIENCE[met.bench.pace])
        met.bench.settle()
        return came

    def _inputs(self, seen: Part) -> list[Any]:
        return _picked(seen, "sent", self._field)

    def _outputs(self, seen: Part) -> list[Any]:
        return _picked(seen, "message", self._field)

    def _made(self, seen: Part, due: Due) -> list[Any]:
        return _outputs_due(self._inputs(seen), due)

    def _equal(self, one: Sequence[Any], other: Sequence[Any]) -> bool:
        return same(list(one), list(other), self._tolerance)

    def _copies_due(self, seen: Part) -> list[Any]:
        inputs, copied = self._inputs(seen), _picked(seen, "sent", self._copied)
        due = [copy for n, copy in enumerate(copied, 1) if self._due(inputs[:n]) is not SILENCE]
        return due[-len(self._outputs(seen)) :]

    def _copies_made(self, seen: Part) -> list[Any]:
        return _picked(seen, "message", self._copied)[-len(self._copies_due(seen)) :]


@dataclass(frozen=True)
class Call:
    """One call of a machine's service, as the machine is declared.

    Attributes:
        asked: What was asked for: the request's field ``data``, or all fields of a request without that one.
        reply: The fields of the reply that is due.
        state: The state afterwards.
        changed: Whether the call changed the state.
    """

    asked: Any
    reply: Mapping[str, Any]
    state: Any
    changed: bool


class Machine(Declared):
    """A node with a state that a service changes, and that a topic tells of at each change, to late listeners, too.

    Args:
        exercise_id: Such as ``"lab_8_1.mode"``.
        title: For the card: the lab and what the subject is.
        task: One sentence: what is asked for.
        state: The state at first.
        step: From the state and what is asked for to the new state and the reply; :data:`SOME_TEXT` in a reply stands
            for any text.
        asks: What is asked for, one call after the other, or a function that draws it, as many in each run. A
            dictionary is a whole request, anything else its field ``data``.
        late_after: The number of calls after which the judge subscribes to the topic.
        field: The path of the field of a message that has the state.
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        state: Any,
        step: Step,
        asks: Sequence[Any] | Callable[[Random], Sequence[Any]],
        late_after: int,
        field: str = "data",
    ) -> None:
        super().__init__(exercise_id, title, task, self._scenario, "publisher", "service", given="answered")
        self._state, self._step, self._asks = state, step, asks
        self._late_after, self._field = late_after, field

    def replies(
        self,
        name: str,
        points: float,
        title: str,
        field: str,
        where: Callable[[Call], bool] = lambda _: True,
        words: str = "",
    ) -> None:
        """Add a criterion: a field of the replies is as it is due.

        Args:
            name: A stable key.
            points: Points it carries.
            title: One line for a person.
            field: The reply's field.
            where: Which calls it is asked of.
            words: The words of the task that the criterion judges.
        """

        def due(seen: Part) -> list[Any]:
            return [call.reply[field] for call in self._course(seen, self._step) if where(call)]

        def came(seen: Part) -> list[Any]:
            pairs = zip(self._course(seen, self._step), _fields(seen, "answered"), strict=False)
            return [reply[field] for call, reply in pairs if where(call)]

        self._compares(name, points, title, due, came, words)

    def once_at_each_change(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add a criterion: one message comes at each change, and no other one; arguments as in :meth:`asks`."""

        def judge(seen: Part, expected: Part) -> Finding:
            course = self._course(seen, self._step)
            due = [[n, state] for n, state in enumerate((c.state for c in course if c.changed), 1)]
            live = sum(call.changed for call in course[self._late_after :])
            told = [[event.data["number"], self._told(event)] for event in seen.of("message")]
            passed = (
                self._got_through(seen, expected)
                and all(any(same(one, d) for d in due) for one in told)
                and all(any(same(one, d) for one in told) for d in due[len(due) - live :])
            )
            heard = max((int(number) for number, _ in told), default=0)
            return Finding(passed and bool(told), f"{len(due)} messages", f"{heard} messages")

        self._draft.criterion(name, points, title)(judge)
        self._judges(name, words)

    def late_joiner_gets_the_last(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add a criterion: who subscribes late hears the state as it is then; arguments as in :meth:`asks`."""

        def due(seen: Part) -> list[Any]:
            return [call.state for call in self._course(seen, self._step)][: self._late_after][-1:]

        def came(seen: Part) -> list[Any]:
            calls, before = 0, []
            for event in seen.events:
                calls += event.kind == "asked"
                if event.kind == "message" and calls == self._late_after:
                    before.append(self._told(event))
            return before[-1:]

        self._compares(name, points, title, due, came, words)

    def wrong(self, key: str, step: Step, says: str, next_step: str) -> None:
        """Add a mistake: all replies are those of a variant of ``step``; arguments as in :meth:`Relay.wrong`."""

        def replied(seen: Part, step: Step) -> bool:
            pairs = zip(self._course(seen, step), _fields(seen, "answered"), strict=False)
            return all(
                same(due, reply.get(field)) for call, reply in pairs for field, due in call.reply.items()
            )

        def found(seen: Part) -> bool:
            return bool(seen.of("answered")) and not replied(seen, self._step) and replied(seen, step)

        self._knows(key, found, says, next_step)

    def told_too_often(self, key: str, says: str, next_step: str) -> None:
        """Add a mistake: more messages than changes; arguments as in :meth:`Relay.wrong`."""

        def found(seen: Part) -> bool:
            most = sum(call.changed for call in self._course(seen, self._step))
            return any(event.data["number"] > most for event in seen.of("message"))

        self._knows(key, found, says, next_step)

    def not_latched(self, key: str, says: str, next_step: str) -> None:
        """Add a mistake: the publisher keeps nothing for late listeners; arguments as in :meth:`Relay.wrong`."""
        self._knows(
            key,
            lambda seen: any(event.data["policy"] == "durability" for event in seen.of("mismatch")),
            says,
            next_step,
        )

    def _scenario(self, bench: Bench) -> None:
        asks = self._asks(bench.random) if callable(self._asks) else self._asks
        (service, service_type), (topic, topic_type) = map(bench.reference.only, ("service", "publisher"))
        bench.part("machine")
        bench.start()
        if bench.await_endpoint("service", service):
            bench.release()
            caller = bench.call(service, service_type)
            ask = partial(self._all_answered, bench, caller)
            if caller.await_server(QUIET[bench.pace]) and ask(asks[: self._late_after]):
                self._join_late(bench, topic, topic_type)
                ask(asks[self._late_after :])
            if not bench.seen().of("answered"):
                bench.note_whether_it_spins()
        bench.stop()

    @staticmethod
    def _all_answered(bench: Bench, caller: Caller, asks: Sequence[Any]) -> bool:
        for asked in asks:
            caller.ask(asked if isinstance(asked, Mapping) else {"data": asked})
            if not caller.await_answers(QUIET[bench.pace]):
                return False
            bench.run_time(PAUSE)
            bench.settle()
        return True

    @staticmethod
    def _join_late(bench: Bench, topic: str, type_name: str) -> None:
        bench.listen(topic, type_name, latched=True)
        bench.wait_until(lambda e: bool(e.main.of("mismatch") or e.main.of("message")), QUIET[bench.pace])
        bench.settle()
        if bench.seen().of("mismatch"):
            bench.listen(topic, type_name)

    def _course(self, seen: Part, step: Step) -> list[Call]:
        """Return each call that was made with what a machine with this step makes of it."""
        state, course = self._state, []
        for asked in map(value, seen.of("asked")):
            new, reply = step(state, asked)
            course.append(Call(asked, reply, new, not same(new, state)))
            state = new
        return course

    def _told(self, event: Event) -> Any:
        return _pick(event.data["fields"], self._field)


def _outputs_due(inputs: Sequence[Any], due: Due) -> list[Any]:
    made = (due(inputs[:number]) for number in range(1, len(inputs) + 1))
    return [one for one in made if one is not SILENCE]


def _fields(seen: Part, kind: str) -> list[Mapping[str, Any]]:
    return [event.data["fields"] for event in seen.of(kind)]


def _picked(seen: Part, kind: str, path: str) -> list[Any]:
    return [_pick(fields, path) for fields in _fields(seen, kind)]


def _pick(fields: Any, path: str) -> Any:
    return reduce(lambda part, key: part[key], path.split("."), fields)


def _put(fields: dict[str, Any], path: str, given: Any) -> None:
    *above, last = path.split(".")
    reduce(lambda part, key: part.setdefault(key, {}), above, fields)[last] = given


def _is_empty(copied: Any) -> bool:
    return not any(copied.values()) if isinstance(copied, Mapping) else not copied
