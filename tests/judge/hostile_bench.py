"""A bench without ROS, whose subject does whatever a subject can do, at any moment of the scenario.

The events of the subject are those that the bank's answers have made in the same exercise, with other values of the
same types. The bench itself keeps what :class:`autograder.kit.bench.Bench` promises.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.authoring.answer_bank import answers
from autograder.judge import evidence_files
from autograder.judge.bench.recorder import MAX_EVENTS, Recorder
from autograder.kit.bench import Pace
from autograder.kit.evidence import INTERRUPTED, Event, Evidence, Part, Reference
from tests.measure import evidence

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from random import Random


class Clock:
    """A clock that goes on only with the events of a bench."""

    now = 0.0

    def monotonic(self) -> float:
        return self.now

    time = monotonic


RUNS = 6
"""The number of answers of the bank from which the events of an exercise come."""
OWN_KINDS = frozenset(
    (
        *("message", "log", "output", "request", "goal", "cancel", "result_request", "feedback_heard"),
        *("goal_ended", "matched", "mismatch", "interface", "announced", "unanswered", "stack", "looked"),
    )
)
"""The kinds of events that a subject can cause at any moment."""
ENDINGS = ("exited", "returned", "raised")
JUDGES_WORDS = frozenset({"interface", "matched", "mismatch"})
"""The kinds of events whose data the judge makes from what is on the graph."""
ANSWERS = 0.95
"""The share of the judge's requests that the subject answers."""
BURST, FLOOD = 30, MAX_EVENTS + 1
"""The number of equal events in a burst, and in a flood, which fills a record."""


@dataclass(frozen=True)
class Odd:
    """Values that a subject may put in place of its own, by type."""

    texts: Sequence[str]
    integers: Sequence[int]
    floats: Sequence[float]

    def other(self, value: Any, random: Random) -> Any:
        """Return another value of the same type; a list may have another length."""
        if isinstance(value, bool):
            return random.random() < 0.5
        if isinstance(value, str):
            return random.choice([*self.texts, value + random.choice(self.texts), value[:-1]])
        if isinstance(value, (int, float)):
            return random.choice(self.integers if isinstance(value, int) else self.floats)
        if isinstance(value, dict):
            return {key: self.other(one, random) for key, one in value.items()}
        if isinstance(value, (list, tuple)):
            return [random.choice([one, self.other(one, random)]) for one in value] * random.choice((0, 1, 2))
        return value


def seen_of(exercise_id: str, reference: Reference) -> list[Event]:
    """Return all events of some answers of the bank."""
    kept = evidence.kept(exercise_id)
    bank = [answer for answer in answers([exercise_id]) if answer.name in kept]
    step = max(1, len(bank) // RUNS)
    looks = (
        evidence_files.evidence_of(evidence.record_of(answer, kept[answer.name]).seen, reference)
        for answer in bank[::step]
    )
    return [event for seen in looks for part in (*(seen.before or ()), *seen) for event in part.events]


class HostileBench:
    """A bench whose subject does at each moment what ``random`` draws from the events of an exercise."""

    def __init__(
        self,
        pool: Sequence[Event],
        reference: Reference,
        random: Random,
        odd: Odd,
        clock: Clock,
        before: Evidence | None = None,
    ) -> None:
        self.pace = Pace.FAST if before is None else Pace.REAL_TIME
        self.random, self.reference, self.before = random, reference, before
        self.in_a_cell, self.is_waited_for = random.random() < 0.5, random.random() < 0.5
        self.parts: list[Part] = []
        self._odd, self._pool, self._clock = odd, pool, clock
        self._own = [event for event in pool if event.kind in OWN_KINDS]
        self._serving: dict[str, Callable[[Any], Mapping[str, Any]]] = {}
        self._recorder = Recorder()
        self._in_part = self._simulated = self.ended = False
        self._liveliness = random.random() * 0.95

    # --- the subject

    def record(self, kind: str, name: str, **data: Any) -> None:
        """Record an event, a hundredth of a second after the one before."""
        self._clock.now += 0.01
        self._recorder.simulated_now = self._clock.now if self._simulated else None
        self._recorder.record(kind, name, **data)

    def happens(self) -> None:
        """Let the subject do something, or nothing."""
        random = self.random
        while not self.ended and self._own and random.random() < self._liveliness:
            self.does(random.choice(self._own))
        if not self.ended and random.random() < 0.02:
            one = random.choice(self._own or [Event(0.0, "output", "stdout", {"text": ""})])
            for _ in range(FLOOD if random.random() < 0.05 else BURST):
                self.record(one.kind, one.name, **one.data)
        if not self.ended and random.random() < 0.03:
            self.ended = True
            kept = [one for one in self._of("subject") if one.name in ENDINGS]
            self.does(random.choice(kept or [Event(0.0, "subject", "exited", {"code": 1})]))

    def does(self, event: Event, **known: Any) -> None:
        """Record an event of the subject as it was, or with other values; ``known`` are those that the judge knows."""
        data, random = event.data, self.random
        if random.random() < 0.5 and data and event.kind not in JUDGES_WORDS:
            changed = random.choice([*data])
            data = {**data, changed: self._odd.other(data[changed], random)}
        self.record(event.kind, event.name, **{**data, **known})
        if event.kind == "request" and event.name in self._serving:
            response = self._serving[event.name](data["fields"])
            self.record("response", event.name, fields=dict(response))

    def answers(self, kind: str, name: str, **known: Any) -> None:
        """Record an answer of the subject to the judge, with fields of any values; or none."""
        like = self._of(kind, name)
        if like and self.random.random() < ANSWERS:
            self.does(self.random.choice(like), **known)

    def _of(self, kind: str, name: str = "") -> list[Event]:
        return [event for event in self._pool if event.kind == kind and name in ("", event.name)]

    # --- the scenario

    def part(self, name: str, **inputs: Any) -> None:
        self.stop()
        self._recorder, self._in_part = Recorder(name, inputs), True
        self._simulated = self.ended = False
        self._serving.clear()

    def again(self, name: str = "") -> None:
        self.stop()
        dropped = next(part for part in reversed(self.parts) if name in ("", part.name))
        self.parts.remove(dropped)
        self.part(dropped.name, **dropped.inputs)

    def leave_out(self, name: str) -> None:
        self.stop()
        self.parts = [part for part in self.parts if part.name != name]

    def keep(self, name: str) -> bool:
        known = self.before.part(name) if self.before else Part(name)
        if known.ending is None or self.random.random() < 0.5:
            return False
        self.stop()
        self.parts.append(known)
        return True

    def stop(self) -> None:
        if self._in_part:
            self.happens()
            self._in_part = False
            self.parts.append(self.seen())

    def start(self, *_: Any, **__: Any) -> None:
        self.happens()

    def seen(self) -> Part:
        return self._recorder.part()

    @property
    def moment(self) -> float:
        return self._recorder.moment

    def heard(self, topic: str) -> int:
        return len(self.seen().of("message", topic))

    def note(self, name: str, **data: Any) -> None:
        self.record("noted", name, **data)

    def wait_until(self, condition: Callable[[Evidence], bool], within: float, **_: Any) -> bool:
        del within
        for _turn in range(self.random.randint(0, 3)):
            if condition(self._evidence()) or self.ended:
                break
            self.happens()
        return condition(self._evidence())

    watch_graph = wait_until

    def _evidence(self) -> Evidence:
        return Evidence([self.seen()], self.reference, self.pace is Pace.REAL_TIME)

    def run_time(self, seconds: float, *, until: Callable[[], bool] | None = None, **_: Any) -> bool:
        self._simulated = self.pace is Pace.FAST and self.random.random() < 0.9
        for _turn in range(self.random.randint(0, 3)):
            if (until is not None and until()) or self.ended:
                break
            self.happens()
        self._clock.now += seconds
        return self.random.random() < ANSWERS

    def await_end(self, within: float) -> bool:
        del within
        self.happens()
        return self.ended

    def press_ctrl_c(self, within: float) -> bool:
        if self.ended:
            return False
        self.record("subject", INTERRUPTED)
        return self.await_end(within)

    def await_endpoint(self, role: str, name: str) -> bool:
        self.happens()
        if self.random.random() < 0.9:
            kind = self.reference.interface.get(role, {}).get(name, "a/msg/B")
            self.record("interface", "topic", **{role: {name: kind}})
        return name in self.seen().endpoints(role)

    def await_any_endpoint(self, roles: Sequence[str]) -> Mapping[str, Mapping[str, str]]:
        del roles
        return self.reference.interface

    def await_node(self) -> bool:
        self.happens()
        return self.seen().had_node

    def await_sign_of_life(self, within: float) -> bool:
        return self.await_end(within) or bool(self.seen().events)

    def speak(self, topic: str, type_name: str, **_: Any) -> Any:
        return _Counterpart(self, topic, type_name)

    call = call_action = serve_action = speak

    def serve(self, service: str, type_name: str, answer: Callable[[Any], Any], **_: Any) -> _Counterpart:
        self._serving[service] = answer
        return _Counterpart(self, service, type_name)

    def serve_goals(self, action: str, type_name: str, work: Callable[[Any], Any]) -> None:
        del type_name, work
        self.answers("goal", action)

    def compare_type(self, service: str, like: str) -> None:
        del like
        self.answers("type", service)

    def note_whether_it_spins(self) -> None:
        if not self.ended and self.random.random() < 0.5:
            self.record("unanswered", self.random.choice(self._odd.texts))

    def note_where_it_hangs(self) -> None:
        if not self.ended:
            self.record("stack", "subject", text=self.random.choice(self._odd.texts))

    def await_attention(self) -> None:
        self.happens()

    settle = take_in = release = doubt = note_its_log = listen = plant = let_wait = pass_time = (
        lambda self, *_, **__: self.happens()
    )


class _Counterpart:
    """An endpoint of the judge of any kind."""

    def __init__(self, bench: HostileBench, name: str, type_name: str) -> None:
        self._bench, self._name = bench, name
        self._asked = 0
        del type_name

    def send(self, **fields: Any) -> None:
        self._bench.record("sent", self._name, fields=fields)
        self._bench.happens()

    def await_server(self, within: float) -> bool:
        del within
        self._bench.record("servers", self._name, count=self._bench.random.choice((1, 1, 1, 2)))
        return self._bench.random.random() < ANSWERS

    def ask(self, *requests: Mapping[str, Any]) -> None:
        for number, fields in enumerate(requests, self._asked):
            self._bench.record("asked", self._name, call=number, fields=dict(fields))
        for number, _ in enumerate(requests, self._asked):
            self._bench.answers("answered", self._name, call=number)
            self._bench.happens()
        self._asked += len(requests)

    def await_answers(self, quiet: float) -> bool:
        del quiet
        self._bench.happens()
        return len(self._bench.seen().of("answered", self._name)) >= self._asked

    def send_goal(self, number: int | None = None, /, **fields: Any) -> int:
        number = self._asked if number is None else number
        self._asked += 1
        self._bench.record("goal_sent", self._name, goal=number, fields=fields)
        self._bench.answers("goal_answer", self._name, goal=number)
        for _ in range(self._bench.random.randint(0, 4)):
            self._bench.answers("feedback_heard", self._name, goal=number)
        if self._bench.random.random() < 0.8:
            self._bench.answers("goal_ended", self._name, goal=number)
            self._bench.answers("result_heard", self._name, goal=number)
        return number

    def cancel(self, goal: int) -> None:
        self._bench.record("cancel_sent", self._name, goal=goal)
        self._bench.answers("cancel_answer", self._name, goal=goal)
        self._bench.answers("result_heard", self._name, goal=goal)

    def await_goal(self, within: float) -> bool:
        return self._await("goal", within)

    def await_cancel(self, within: float) -> bool:
        return self._await("cancel", within)

    def await_result_request(self, within: float) -> bool:
        return self._await("result_request", within)

    def _await(self, kind: str, within: float) -> bool:
        del within
        self._bench.happens()
        self._bench.answers(kind, self._name)
        return self._bench.seen().first(kind, self._name) is not None

    def send_feedback(self, **fields: Any) -> None:
        self._bench.record("feedback", self._name, fields=fields)
        self._bench.happens()

    def finish(self, status: str, **fields: Any) -> None:
        self._bench.record("result", self._name, status=status, fields=fields)
        self._bench.happens()

    def say_status(self) -> None:
        self._bench.happens()

    release = close = say_status
