"""A look in real time ends once each mistake of the look before was made again, and only then."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.bench import Pace
from autograder.kit.oracle.mistakes_again import MistakesAgain
from autograder.kit.oracle.outputs import Kind, Output
from tests.kit.test_oracle import ALWAYS_AHEAD, RIGHT, evidence_of, run

if TYPE_CHECKING:
    from autograder.kit.evidence import Part

TURNS_LATE = ([0.0, 0.0], [0.3, 0.0], [0.2, 0.0])
NO_RANGE: tuple[Any, ...] = ((3, []), (False, True))
OUTPUTS = (
    Output("/cmd_vel", ("linear.x", "angular.z"), Kind.STEPS, 1e-3),
    Output("speed", ("described",), Kind.PARAMETER, 1e-3),
    Output("/beat", ("data",), Kind.LIST, 1e-3),
)


def ends_after(
    before: Part | None, now: Part, *, late: Part | None = None, pace: Pace = Pace.REAL_TIME
) -> int:
    """Return the number of steps after which a look ends: four, if nothing ends it before.

    ``late`` is the run once all that was sent has come.
    """
    shown = now
    bench: Any = SimpleNamespace(pace=pace, before=before and evidence_of(before), confirmed=False)
    bench.doubted = False
    bench.reference = evidence_of(now).reference

    def values(output: Output, number: int) -> Any:
        noted = shown.of("noted", output.name)
        return next(event.data["values"] for event in noted if event.data["step"] == number)

    def settle() -> None:
        nonlocal shown
        shown = late or now

    def doubt() -> None:
        bench.doubted = True

    def confirm() -> None:
        bench.confirmed = bench.doubted

    bench.settle, bench.doubt, bench.confirm = settle, doubt, confirm
    again = MistakesAgain(bench, OUTPUTS)
    for steps in range(1, 5):
        again.end_look(steps, values)
        if bench.confirmed:
            return steps
    return 4


AHEAD, LATE = run(ALWAYS_AHEAD), run(TURNS_LATE)
SILENT, THEN_SILENT = run(([], [], [])), run(([0.0, 0.0], [], [0.0, 0.5]))


@pytest.mark.parametrize(
    ("before", "now", "steps"),
    [
        pytest.param(LATE, LATE, 3, id="the step after the wrong one is over"),
        pytest.param(AHEAD, LATE, 4, id="the mistake comes in the last step"),
        pytest.param(LATE, run(RIGHT), 4, id="right in real time"),
        pytest.param(LATE, run(([0.0, 0.0], [0.4, 0.0], [0.2, 0.0])), 4, id="another mistake"),
        pytest.param(run(RIGHT), run(RIGHT), 4, id="nothing was wrong"),
        pytest.param(None, LATE, 4, id="nobody has looked before"),
        pytest.param(run(RIGHT, speed=NO_RANGE), run(RIGHT, speed=NO_RANGE), 2, id="a parameter's range"),
        pytest.param(run(TURNS_LATE, speed=NO_RANGE), run(TURNS_LATE, speed=NO_RANGE), 3, id="both"),
        pytest.param(run(TURNS_LATE, speed=NO_RANGE), LATE, 4, id="one of both"),
        pytest.param(run(TURNS_LATE, [7]), run(TURNS_LATE, [7]), 4, id="a list needs the whole look"),
        pytest.param(run(TURNS_LATE[:1]), LATE, 4, id="the look before was cut short"),
        pytest.param(SILENT, SILENT, 4, id="it was silent, perhaps by another clock"),
        pytest.param(THEN_SILENT, run(([0.1, 0.0], [], [0.0, 0.5])), 4, id="right before, and not now"),
        pytest.param(THEN_SILENT, THEN_SILENT, 3, id="silent after it has spoken"),
    ],
)
def test_a_look_ends_when_each_mistake_was_made_again(before: Part | None, now: Part, steps: int) -> None:
    assert ends_after(before, now) == steps


def test_what_was_sent_late_counts() -> None:
    assert ends_after(LATE, LATE, late=run(RIGHT)) == 4


def test_the_look_in_simulated_time_is_whole() -> None:
    """The judge looks twice in simulated time, too: the second time it uses the subject's names."""
    assert ends_after(LATE, replace(LATE), pace=Pace.FAST) == 4
