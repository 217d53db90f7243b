"""The criteria of the adding server's lab on hand-made evidence: no ROS is started."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from unittest.mock import MagicMock

from lab_1_3.server import EXERCISE, ordinary, single_calls

from autograder.kit.bench import Pace
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.recipes.servers import CALLS, CALLS_AT_ONCE, Asks

SERVICE, TYPE = "/add_two_ints", "my_robot_interfaces/srv/AddTwoInts"
ASKED = [*single_calls(Random("a")), *(ordinary(Random(n)) for n in range(CALLS_AT_ONCE + 1))]
LAST = len(ASKED) - 1


def part(answered: dict[int, int], *, servers: int = 1) -> Part:
    events = [
        Event(0.0, "interface", "graph", {"nodes": ["/n"], "service": {SERVICE: TYPE}}),
        Event(0.0, "servers", SERVICE, {"count": servers}),
        *(Event(0.0, "asked", SERVICE, {"call": n, "fields": fields}) for n, fields in enumerate(ASKED)),
        *(Event(0.0, "answered", SERVICE, {"call": n, "fields": {"sum": s}}) for n, s in answered.items()),
    ]
    return Part(CALLS, {}, events)


SUMS = {number: fields["a"] + fields["b"] for number, fields in enumerate(ASKED)}


def failed(seen: Part) -> set[str]:
    evidence = Evidence([seen], Reference("lab_1_3.server", {"service": {SERVICE: TYPE}}, [part(SUMS)]))
    return {c.name for c in EXERCISE.criteria if not c.judge(evidence).passed}


def test_every_sum_that_is_asked_for_fits_into_64_bits() -> None:
    for seed in range(200):
        for numbers in single_calls(Random(seed)):
            for value in (*numbers.values(), sum(numbers.values())):
                assert -(2**63) <= value < 2**63


def test_answers_to_calls_at_once_must_not_be_swapped() -> None:
    assert failed(part(SUMS | {LAST - 1: SUMS[LAST - 2], LAST - 2: SUMS[LAST - 1]})) == {"together"}


def test_where_chance_picks_the_server_a_wrong_answer_counts_against_each_call() -> None:
    # The other server happened to answer one call only; another time it answers others.
    assert failed(part(SUMS | {3: 0}, servers=2)) == {"service", "sums", "together"}
    assert failed(part(SUMS | {LAST: 0}, servers=2)) == {"service", "sums", "together"}


def test_a_server_that_ends_by_itself_earns_nothing_whenever_it_ends() -> None:
    for answered in range(len(SUMS) + 1):
        seen = part(dict(list(SUMS.items())[:answered]))
        assert failed(_ended(seen)) == {"service", "sums", "together", "alive"}


def test_an_exception_in_the_callback_does_not_cost_the_points_for_the_service_that_was_there() -> None:
    raised = {"traceback": "Traceback (most recent call last):\nTypeError"}
    assert failed(_ended(part({}), **raised)) == {"sums", "together", "alive"}
    never_called = replace(part({}), events=part({}).events[:2])
    assert "service" in failed(_ended(never_called, **raised))


def _ended(seen: Part, **data: str) -> Part:
    end = Event(1.0, "subject", "raised" if data else "exited", data)
    return replace(seen, events=[*seen.events, end])


def test_time_passes_for_the_server_before_the_last_call() -> None:
    bench, caller = MagicMock(random=Random(0), pace=Pace.FAST), MagicMock()
    bench.reference.only.return_value = SERVICE, TYPE
    bench.pass_time.side_effect = lambda *_: caller.time_passes()
    assert Asks(single_calls, ordinary)._all_answered(bench, caller)
    calls = [name for name, *_ in caller.mock_calls if name in ("ask", "time_passes")]
    assert calls[-2:] == ["time_passes", "ask"]
    assert calls.count("time_passes") == 1
