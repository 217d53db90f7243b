"""What a judge that compares with the solution gives in each step, and what it notes of a subject that talks."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.oracle.same_as_solution import PAUSE, SameAsSolution, Sets, To

if TYPE_CHECKING:
    from autograder.kit.oracle.steps import Step

INTERFACE = {"publisher": {"/said": "x/msg/Y"}, "subscription": {"/asked": "x/msg/Y"}}
STEPS: list[Step] = [To("/asked", 7), 2.0, Sets("speed", 2.5), To("/asked", 8), Sets("speed", 9.5)]
SAID = ((1,), (2, 3), (), (4, 5, 6), (), (7,))
"""What the subject says in the pause at the start, and in each step."""
IN_ORDER = [PAUSE, 7, PAUSE, 2.0, "speed", PAUSE, 8, PAUSE, "speed", PAUSE]
"""What the judge gives, and the seconds that it lets pass."""


class _Talking:
    """A bench with a subject that says the numbers of one row whenever the judge lets time pass.

    Messages and answers arrive a moment after they were sent: in real time, when the judge is at its next step.
    """

    before = None

    def __init__(self, pace: Pace, *said: tuple[int, ...], answers: int = 2) -> None:
        self.pace, self.random, self.moment = pace, Random(1), 0.0
        self.reference = Reference("a.b", INTERFACE, [])
        self.given: list[Any] = []
        self.noted: dict[str, list[tuple[int, list[Any]]]] = {}
        self._events = [Event(0.0, "interface", "graph", {"nodes": ["/robot"]})]
        self._said, self._answers, self._on_the_way = iter(said), answers, list[Event]()

    def run_time(self, seconds: float, **_: Any) -> bool:
        self.settle()
        self.given.append(seconds)
        self.moment += seconds
        for number in next(self._said, ()):
            self._sends("message", "/said", fields={"data": number}, number=number)
        return True

    def settle(self) -> None:
        self._events += self._on_the_way
        self._on_the_way.clear()

    def send(self, data: int) -> None:
        self.given.append(data)

    def call(self, service: str, _: str) -> _Talking:
        self._service = service
        return self

    def ask(self, request: Any) -> None:
        self.given.append(request["parameters"][0]["name"])
        self._answers -= 1
        if self._answers >= 0:
            result = {"successful": self._answers > 0, "reason": "too fast" * (not self._answers)}
            self._sends("answered", self._service, fields={"results": [result]})

    def note(self, name: str, **data: Any) -> None:
        self.noted.setdefault(name, []).append((data["step"], data["values"]))

    def listen(self, *_: Any, **__: Any) -> None:
        """The judge hears whatever is said."""

    def speak(self, *_: Any, **__: Any) -> _Talking:
        return self

    def seen(self) -> Part:
        return Part("drawing 0", {}, self._events)

    def wait_until(self, condition: Any, _: float) -> bool:
        if not condition(now := Evidence([self.seen()], self.reference)):
            self.settle()
        return bool(condition(now))

    watch_graph = wait_until

    def _sends(self, kind: str, name: str, **data: Any) -> None:
        times = {"sent": self.moment - 0.01, "arrived": self.moment}
        self._on_the_way.append(Event(self.moment, kind, name, data | times))

    def __getattr__(self, _: str) -> Any:
        return lambda *_, **__: True


def played(bench: _Talking, **how: Any) -> dict[str, list[tuple[int, list[Any]]]]:
    """Return what the judge notes of each output: the number of each step, and its values."""
    SameAsSolution("a.b", "A", "B", gives=lambda _: STEPS, **how).exercise().scenario(bench)  # type: ignore[arg-type]
    return bench.noted


@pytest.mark.parametrize("pace", Pace)
def test_of_what_is_said_in_a_step_the_last_message_counts_or_each(pace: Pace) -> None:
    noted = played(_Talking(pace, *SAID), tells={"/said": "data"})
    assert noted["/said"] == [(0, [[1]]), (1, [[3]]), (2, []), (3, [[6]]), (4, []), (5, [[7]])]
    noted = played(_Talking(pace, *SAID), tells={"/said": "data"}, every=True)
    assert noted["/said"] == [(step, [[number] for number in row]) for step, row in enumerate(SAID)]


@pytest.mark.parametrize("pace", Pace)
def test_a_list_has_all_messages_once(pace: Pace) -> None:
    noted = played(_Talking(pace, *SAID), lists={"/said": "data"})
    assert noted["/said"] == [(0, [[number] for row in SAID for number in row])]


def test_to_a_late_subscriber_one_message_counts_before_the_first_step() -> None:
    """A publisher may keep more than the last one for it. The first input comes before the judge listens."""
    bench = _Talking(Pace.FAST, (), (), (1, 2), (3, 4))
    noted = played(bench, tells={"/said": "data"}, every=True, late_after=3.0)
    assert bench.given[:3] == [3.0, 7, PAUSE]
    assert [values for _, values in noted["/said"]][:2] == [[[2, 2]], [[3, 3], [4, 4]]]


@pytest.mark.parametrize("pace", Pace)
def test_each_input_is_given_in_order_and_each_answer_belongs_to_its_own_step(pace: Pace) -> None:
    bench = _Talking(pace)
    assert played(bench)["speed"] == [(3, [[True, False]]), (5, [[False, True]])]
    assert bench.given == IN_ORDER


@pytest.mark.parametrize(("answers", "given", "steps"), [(0, 5, 3), (1, 9, 5)])
def test_nothing_more_is_given_to_a_node_that_does_not_answer(answers: int, given: int, steps: int) -> None:
    bench = _Talking(Pace.FAST, *SAID, answers=answers)
    noted = played(bench, tells={"/said": "data"})
    assert bench.given == IN_ORDER[:given]
    assert [step for step, _ in noted["/said"]] == [*range(steps)]
