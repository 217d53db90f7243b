"""A subject is compared with the recorded solution in the same drawing, step by step, or message by message."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from random import Random
from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.bench import Pace
from autograder.kit.counterparts import Qos
from autograder.kit.evidence import Event, Evidence, Part, Reference, Variant
from autograder.kit.oracle.same_as_solution import SameAsSolution, Sets, To
from autograder.kit.oracle.steps import Step, Turn, answer_delays
from tests.cases import cases, named_cases

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.model import Exercise

INTERFACE = {"publisher": {"/cmd_vel": "x/msg/Y", "/beat": "x/msg/Y"}, "subscription": {"/scan": "x/msg/Y"}}
GIVEN = ("0.75 s without an input", "/scan", "speed = 2.5")


def exercise(*more: float) -> Exercise:
    """Commands after each step, beats in all, and a parameter; at the end more seconds without an input."""
    return SameAsSolution(
        "a.b",
        "A",
        "B",
        gives=lambda random: [To("/scan", random.random()), Sets("speed", 2.5), *more],
        tells={"/cmd_vel": ("linear.x", "angular.z")},
        lists={"/beat": "data"},
        parameters=["speed"],
    ).exercise()


def run(
    commands: Sequence[Sequence[Any]],
    beats: Sequence[int] = (1, 2, 3, 4, 5),
    speed: Sequence[Any] = ((3, [[0.0, 2.0]]), (False, True)),
    *,
    drawing: int = 1,
    simulated: bool = True,
    early: int = 0,
) -> Part:
    """Return a run with these commands, one in each step, these beats, and what the parameter's node answered.

    ``early`` beats came before the judge stepped the clock.
    """
    noted = [
        *(("/cmd_vel", step, [list(command)] if command else []) for step, command in enumerate(commands)),
        ("speed", 0, [list(speed[0])]),
        ("speed", 2, [list(speed[1])]),
        ("/beat", 0, [[beat] for beat in beats]),
    ]
    return Part(
        f"drawing {drawing}",
        {},
        [
            Event(
                1.0,
                "noted",
                name,
                {
                    "step": step,
                    "given": GIVEN[step],
                    "values": values,
                    "stepped": (len(values) - early) * simulated,
                },
                100.0 if simulated else None,
            )
            for name, step, values in noted
        ],
    )


RIGHT = ([0.0, 0.0], [0.2, 0.0], [0.0, 0.5])
ALWAYS_AHEAD = ([0.0, 0.0], [0.2, 0.0], [0.2, 0.0])
VARIANT = Variant("always_ahead", "Your robot never turns.", "Turn.", [run(ALWAYS_AHEAD)])


def evidence_of(part: Part) -> Evidence:
    """Return a run as evidence, with a recording in which another drawing comes first."""
    recorded = [run([[9.0, 9.0]] * 3, drawing=0), run(RIGHT)]
    return Evidence([part], Reference("a.b", INTERFACE, recorded, [VARIANT]))


def failed(part: Part) -> dict[str, tuple[str, str]]:
    """Return the criteria that fail, with what was expected and what was seen."""
    findings = {one.name: one.judge(evidence_of(part)) for one in exercise().criteria}
    return {name: (one.expected, one.seen) for name, one in findings.items() if not one.passed}


def test_the_solution_in_the_same_drawing_decides() -> None:
    assert failed(run(RIGHT)) == {}
    assert set(failed(run(RIGHT, drawing=0))) == {"cmd_vel"}


def test_a_drawing_that_is_not_known_is_an_error() -> None:
    with pytest.raises(KeyError, match="has no part 'drawing 7'"):
        failed(run(RIGHT, drawing=7))


def test_a_subject_that_was_given_no_drawing_has_no_points() -> None:
    """For example, a subject that could not be started."""
    nothing = replace(evidence_of(run(RIGHT)), parts=[])
    findings = [one.judge(nothing) for one in exercise().criteria]
    assert not any(finding.passed for finding in findings)


def test_the_name_of_a_drawing_says_which_inputs_are_given() -> None:
    """A recording has the practice drawings or those that it names; a check gives one that the reference has."""

    def given(*recorded: str, drawings: Sequence[str] = ()) -> list[tuple[str, float]]:
        bench = _Bench(Reference("a.b", INTERFACE, [Part(name) for name in recorded], drawings=drawings))
        draws: list[float] = []

        def gives(random: Random) -> list[To]:
            draws.append(random.random())
            return [To("/scan", draws[-1])]

        made = SameAsSolution("a.b", "A", "B", gives=gives, tells={"/cmd_vel": "data"}).exercise()
        draws.clear()
        made.scenario(bench)  # type: ignore[arg-type]
        return list(zip(bench.parts, draws, strict=True))

    practice = given()
    assert [name for name, _ in practice] == [f"drawing {number}" for number in range(4)]
    assert given("drawing 2") == [practice[2]]
    of_a_class = given(drawings=["drawing 0f1e"])
    assert given("drawing 0f1e") == of_a_class
    assert [name for name, _ in of_a_class] == ["drawing 0f1e"]
    assert of_a_class[0][1] not in dict(practice).values()


def test_an_exercise_without_drawn_inputs_has_no_drawings() -> None:
    def made(**more: Any) -> Exercise:
        return SameAsSolution("a.b", "A", "B", tells={"/cmd_vel": "data"}, **more).exercise()

    assert not made(gives=lambda _: [To("/scan", 1.0)]).is_drawn
    assert made(gives=lambda random: [To("/scan", random.random())]).is_drawn
    assert made(gives=lambda _: [1.0], serves={"/where": lambda random: {"data": random.random()}}).is_drawn


def test_a_card_shows_the_first_step_that_differs() -> None:
    assert failed(run(ALWAYS_AHEAD)) == {
        "cmd_vel": (
            "linear.x = 0, angular.z = 0.5 after speed = 2.5",
            "linear.x = 0.2, angular.z = 0 after speed = 2.5",
        )
    }
    assert failed(run([[], *RIGHT[1:]]))["cmd_vel"][1] == "nothing at the start"
    assert failed(run(RIGHT[:2]))["cmd_vel"][1] == "nothing came from then on"


def test_a_number_may_differ_by_the_tolerance() -> None:
    assert failed(run([RIGHT[0], [0.2001, 0.0], RIGHT[2]])) == {}
    assert failed(run([RIGHT[0], [0.21, 0.0], RIGHT[2]]))


@pytest.mark.parametrize(("beats", "passes"), cases(__file__, "a_list_may_end_a_little_earlier_or_later"))
def test_a_list_may_end_a_little_earlier_or_later(beats: Sequence[int], passes: bool) -> None:
    assert ("beat" not in failed(run(RIGHT, beats))) == passes


@pytest.mark.parametrize(
    ("early", "simulated", "passes"), [(9, True, True), (0, True, False), (9, False, False)]
)
def test_messages_of_a_list_before_the_judge_stepped_the_clock_are_not_too_many(
    early: int, simulated: bool, passes: bool
) -> None:
    ten_more = range(1, 15)
    assert ("beat" not in failed(run(RIGHT, ten_more, early=early, simulated=simulated))) == passes


def rated(*moments: float, simulated: bool = True) -> tuple[bool, str]:
    """Return whether beats at these moments keep a rate of one in a second, and what the card says came."""
    exercise = SameAsSolution("a.b", "A", "B", gives=lambda _: [2.25], rates={"/beat": 1.0}).exercise()
    beats = [Event(at, "message", "/beat", {}, at if simulated else None) for at in moments]
    evidence = Evidence([Part("drawing 0", {}, beats)], Reference("a.b", INTERFACE, [Part("drawing 0")]))
    (criterion,) = exercise.criteria
    mistake = next(one for one in exercise.mistakes if one.key == "wrong_rate")
    finding = criterion.judge(evidence)
    assert (mistake.recognize(evidence) is None) == (finding.passed or len(moments) < 3)
    return finding.passed, finding.seen


def test_a_rate_needs_three_periods_without_an_input() -> None:
    """With fewer it depends on chance whether two messages come between two inputs, and a right node may fail."""
    with pytest.raises(ValueError, match=r"3 s have to pass without an input, and it is 2\.75 s at most"):
        SameAsSolution("a.b", "A", "B", gives=lambda _: [2.0, To("/scan", 1), 2.0], rates={"/beat": 1.0})


EVERY_SECOND = range(10)


@pytest.mark.parametrize("simulated", [True, False])
@pytest.mark.parametrize(
    ("moments", "passes", "seen"),
    [
        (EVERY_SECOND, True, "one every 1 s"),
        ([moment / 10 for moment in EVERY_SECOND], False, "one every 0.1 s"),
        ([moment * 2 for moment in EVERY_SECOND], False, "one every 2 s"),
        ([moment // 2 for moment in range(20)], False, "one every 0"),
        ([1], False, "1 message in all"),
    ],
    ids=["right", "ten times as often", "half as often", "told twice", "too few"],
)
def test_a_rate_that_the_task_asks_for_is_kept(
    moments: Sequence[float], passes: bool, seen: str, simulated: bool
) -> None:
    kept, came = rated(*moments, simulated=simulated)
    assert kept == passes
    assert seen in came


@pytest.mark.parametrize("moments", named_cases(__file__, "a_rate_is_kept_if_the_usual_interval_is_right"))
def test_a_rate_is_kept_if_the_usual_interval_is_right(moments: Sequence[float]) -> None:
    assert rated(*moments)[0]


@pytest.mark.parametrize(
    ("speed", "seen"), cases(__file__, "a_parameter_is_described_and_refused_as_the_solutions")
)
def test_a_parameter_is_described_and_refused_as_the_solutions(speed: Sequence[Any], seen: str) -> None:
    assert seen in failed(run(RIGHT, speed=speed))["speed"][1]


def test_a_run_like_a_recorded_wrong_answer_is_named_for_certain_in_simulated_time() -> None:
    def told(part: Part, *more: float) -> list[tuple[str, bool]]:
        found = (
            (one, one.recognize(evidence_of(part)))
            for one in exercise(*more).mistakes
            if one.key == "variant"
        )
        return [(advice.key, one.certain) for one, advice in found if advice]

    assert told(run(ALWAYS_AHEAD)) == [("always_ahead", True), ("always_ahead", False)]
    assert told(run(ALWAYS_AHEAD, simulated=False)) == [("always_ahead", False)]
    # A node with a clock of its own may be late while the judge moves its clock, and right in real time.
    assert told(run(ALWAYS_AHEAD), 0.7) == [("always_ahead", False)]
    assert told(replace(run(ALWAYS_AHEAD), events=sorted(run(ALWAYS_AHEAD).events, key=lambda one: one.name)))
    assert told(run([[0.0, 0.0], [0.2005, 0.0], [0.2, 0.0]], [1, 2, 3, 4]))
    assert told(run(RIGHT)) == told(run(ALWAYS_AHEAD, drawing=0)) == told(run([[0.1, 0.0]] * 3)) == []


def test_a_run_that_is_cut_short_like_a_wrong_answer_is_no_proof() -> None:
    """A right server that sleeps in real time may be cut at the step at which a wrong answer was cut, too."""
    cut = run(ALWAYS_AHEAD[:2])
    evidence = evidence_of(cut)
    reference = replace(evidence.reference, variants=[replace(VARIANT, parts=[cut])])
    evidence = replace(evidence, reference=reference)
    told = {one.certain: one.recognize(evidence) for one in exercise().mistakes if one.key == "variant"}
    assert told[True] is None
    assert told[False] is not None


def test_a_run_in_real_time_is_named_by_what_it_did_in_simulated_time() -> None:
    once_more = evidence_of(run([*ALWAYS_AHEAD[:2], []], simulated=False))
    (likely,) = [one for one in exercise().mistakes if one.key == "variant" and not one.certain]
    assert not likely.recognize(once_more)
    named = likely.recognize(replace(once_more, before=evidence_of(run(ALWAYS_AHEAD))))
    assert named is not None
    assert named.key == "always_ahead"
    right = replace(evidence_of(run(RIGHT)), before=evidence_of(run(ALWAYS_AHEAD)))
    assert not likely.recognize(right)


def test_in_real_time_a_message_belongs_to_the_step_in_which_it_was_sent() -> None:
    """The second message is sent 0.02 s before the next step begins, and arrives 0.03 s after that."""
    arrived, sent = (10.1, 10.78), (10.09, 10.73)
    events = [
        Event(at - 10.0, "message", "/state", {"fields": {"data": at}, "arrived": at, "sent": before})
        for at, before in zip(arrived, sent, strict=True)
    ]
    seen = Part("drawing 0", {}, events)
    first, second = Turn(0, 0.75, 0, 0.0), Turn(1, To("/scan", 1), 1, 0.75)
    assert first.events(seen, second, by_time=True) == events
    assert not second.events(seen, None, by_time=True)
    assert [turn.events(seen, None, by_time=False)[-1:] for turn in (first, second)] == [events[1:]] * 2


def test_the_judge_s_endpoint_has_the_qos_of_the_solution_s_if_the_author_says_that_it_counts() -> None:
    def scenario(*topics: str, qos: dict[str, dict[str, str]]) -> list[tuple[str, Qos]]:
        counts = SameAsSolution("a.b", "A", "B", gives=lambda _: [], qos=topics).exercise()
        counts.scenario(bench := _Bench(Reference("a.b", INTERFACE, [], qos=qos)))  # type: ignore[arg-type]
        return bench.made

    sensor = {"subscription": {"/scan": "sensor"}}
    assert ("/scan", Qos.SENSOR) in scenario("/scan", qos=sensor)
    assert set(scenario(qos=sensor)) == {(name, Qos.DEFAULT) for name in ("/cmd_vel", "/beat", "/scan")}
    with pytest.raises(ValueError, match="on /scan the solution has the default QoS"):
        scenario("/scan", qos={})


@pytest.mark.parametrize("pace", Pace)
def test_a_node_that_hangs_at_the_first_step_says_nothing(pace: Pace) -> None:
    bench = _Hung(evidence_of(run(RIGHT)).reference, pace)
    exercise().scenario(bench)  # type: ignore[arg-type]
    part = Part("drawing 1", {}, [Event(1.0, "noted", name, data) for name, data in bench.noted])
    assert set(failed(part)) == {"cmd_vel", "speed", "beat"}


class _Bench:
    """A bench on which no endpoint of a subject appears. It remembers the judge's endpoints."""

    def __init__(self, reference: Reference) -> None:
        self.reference, self.made = reference, list[tuple[str, Qos]]()
        self.random, self.parts, self.before = Random(1), list[str](), None

    def part(self, name: str) -> None:
        self.parts.append(name)

    def listen(self, topic: str, _: str, *, qos: Qos) -> None:
        self.made.append((topic, qos))

    speak = listen

    def seen(self) -> Part:
        return Part("drawing 0")

    def __getattr__(self, _: str) -> Callable[..., bool]:
        return lambda *_, **__: False


class _Hung(_Bench):
    """A bench with a subject that the judge has met, and that then answers nothing."""

    def __init__(self, reference: Reference, pace: Pace) -> None:
        super().__init__(reference)
        self.pace, self.random, self.moment = pace, Random(1), 0.0
        self.noted: list[tuple[str, Any]] = []

    def await_endpoint(self, *_: str) -> bool:
        return True

    def note(self, name: str, **data: Any) -> None:
        self.noted.append((name, data))


def test_an_input_says_when_the_call_is_answered_that_it_leads_to() -> None:
    steps: list[Step] = [
        To("/stop", True),
        To("/ask", 1, answered=2.5),
        0.5,
        To("/ask", 2, answered=inf),
        To("/ask", 3, answered=0.0),
    ]
    assert answer_delays(steps) == ({1: 2.5}, {2})
