"""A recipe for a node with a state that a service changes; the author declares how each request changes it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from autograder.kit.counterparts import Qos
from autograder.kit.model import Finding
from autograder.kit.recipes.own_scenario import QUIET, Declared, fields, pick, variant
from autograder.kit.rules import SOME_TEXT, same, value

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.counterparts import Caller
    from autograder.kit.evidence import Event, Part
    from autograder.kit.model import Bench

__all__ = ["SOME_TEXT", "Machine"]

PAUSE = 0.5
"""Seconds of the subject's time that the judge waits after each answer, because the subject may report a change from a
timer.
"""
ON_AND_OFF = (False, True, True, False, False, True, True, False, False, True, False)
"""Requests for a state that is either on or off. After each state is requested, it is requested once more."""

Step = Callable[..., tuple[Any, Mapping[str, Any]]]
"""A function that returns the new state and the fields of the reply, given the state and the request."""


@dataclass(frozen=True)
class Call:
    """One call of the service, with the reply and the state that must follow from it.

    Attributes:
        asked: The request: its field ``data``, or all its fields if it has no such field.
        reply: The required fields of the reply.
        state: The required state after the call.
        changed: True if the call changes the state.
    """

    asked: Any
    reply: Mapping[str, Any]
    state: Any
    changed: bool


class Machine(Declared):
    """An exercise about a node with a state that a service changes, and a topic that reports each change.

    The node must also send its last message to subscribers that join late.

    Args:
        exercise_id: The lab's folder and the file's name, such as ``"lab_8_1.mode"``.
        title: The title of the card, naming the lab and the subject.
        task: One sentence that states the task.
        state: The state at the beginning.
        step: Returns the new state and the reply, given the state and the request. :data:`SOME_TEXT` in a reply
            allows any text.
        asks: The requests in order, or a function that draws them; it must draw the same number of requests in each
            run. A dictionary is a whole request; anything else is the value of its field ``data``.
        late_after: The number of calls after which the judge subscribes to the topic.
        field: The path of the field that contains the state in the topic's messages.

    Example::

        def step(mode: bool, asked: bool) -> tuple[bool, dict[str, Any]]:
            return asked, {"success": asked != mode}

        task = Machine("lab_8_1.mode", "Lab 8.1 · The mode", "Set a mode by a service.", state=False, step=step)
        task.replies("success", 4, "Says success only if the mode changes")
        task.once_at_each_change("once", 3, "Reports each change once")
        task.late_joiner_gets_the_last("late", 3, "Tells a late subscriber the last mode")
        EXERCISE = task.exercise()
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        state: Any,
        step: Step,
        asks: Sequence[Any] | Callable[[Random], Sequence[Any]] = ON_AND_OFF,
        late_after: int = 6,
        field: str = "data",
    ) -> None:
        super().__init__(exercise_id, title, task, self._scenario, "publisher", "service", given="answered")
        self._state, self._step, self._asks = state, step, asks
        self._late_after, self._field = late_after, field

    def replies(self, field: str, points: float, title: str, words: str = "") -> None:
        """Add the criterion that a field of each reply is right. The field's name is also the criterion's key.

        A reply is not compared if ``step`` does not return this field for it.

        Args:
            title: The criterion in one line, as the card shows it.
            words: The sentence of the task that the criterion judges.
        """

        def due(seen: Part) -> list[Any]:
            return [call.reply[field] for call in self._course(seen, self._step) if field in call.reply]

        def came(seen: Part) -> list[Any]:
            pairs = zip(self._course(seen, self._step), fields(seen, "answered"), strict=False)
            return [reply[field] for call, reply in pairs if field in call.reply]

        self._compares(field, points, title, due, came, words)

    def once_at_each_change(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add the criterion that exactly one message comes at each change. For the arguments see :meth:`asks`."""

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
        """Add the criterion that a late subscriber receives the current state. For the arguments see :meth:`asks`."""

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

    def wrong(self, key: str, step: Step | Mapping[str, Any], says: str, next_step: str) -> None:
        """Add a mistake: all replies are those of a wrong ``step``. For the arguments see :meth:`Relay.wrong`."""
        wrong = variant(self._step, step)

        def replied(seen: Part, step: Step) -> bool:
            pairs = zip(self._course(seen, step), fields(seen, "answered"), strict=False)
            return all(
                same(due, reply.get(field)) for call, reply in pairs for field, due in call.reply.items()
            )

        def found(seen: Part) -> bool:
            return bool(seen.of("answered")) and not replied(seen, self._step) and replied(seen, wrong)

        self._knows(key, found, says, next_step)

    def told_too_often(self, key: str = "told_too_often") -> None:
        """Add the mistake that the node publishes more messages than there are changes."""

        def found(seen: Part) -> bool:
            most = sum(call.changed for call in self._course(seen, self._step))
            return any(event.data["number"] > most for event in seen.of("message"))

        self._knows(
            key,
            found,
            "Your node publishes more messages than there are changes.",
            "Publish only if the new value differs from the old one, and only once for each change.",
        )

    def not_latched(self, key: str = "not_latched") -> None:
        """Add the mistake that the publisher does not store its last message for late subscribers."""
        self._knows(
            key,
            lambda seen: any(event.data["policy"] == "durability" for event in seen.of("mismatch")),
            "Your publisher does not store its last message, so a subscriber that joins later receives nothing.",
            "Pass QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL) to create_publisher instead of 10.",
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
        bench.listen(topic, type_name, qos=Qos.LATCHED)
        bench.wait_until(lambda e: bool(e.main.of("mismatch") or e.main.of("message")), QUIET[bench.pace])
        bench.settle()
        if bench.seen().of("mismatch"):
            bench.listen(topic, type_name)

    def _course(self, seen: Part, step: Step) -> list[Call]:
        """Return each call with its reply and the state after it, as the function ``step`` computes them."""
        state, course = self._state, []
        for asked in map(value, seen.of("asked")):
            new, reply = step(state, asked)
            course.append(Call(asked, reply, new, not same(new, state)))
            state = new
        return course

    def _told(self, event: Event) -> Any:
        return pick(event.data["fields"], self._field)
