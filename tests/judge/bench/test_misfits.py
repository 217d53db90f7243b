"""The judge sends numbers as the field's type has them, and refuses a value that the field cannot hold."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from autograder.judge.bench.ros_interfaces import MisfitError
from autograder.kit.bench import Pace
from autograder.kit.evidence import Reference
from autograder.kit.oracle.same_as_solution import SameAsSolution, Sets, To
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from tests.judge.bench.conftest import BenchOf

pytestmark = pytest.mark.ros
POINT, NUMBER = "geometry_msgs/msg/Point", "std_msgs/msg/Float64"
ADD, FIBONACCI = "my_robot_interfaces/srv/AddTwoInts", "my_robot_interfaces/action/Fibonacci"
ENDS = {"subscription": {"/point": POINT}, "publisher": {"/sum": NUMBER}}
ADDER = cases(__file__, "ADDER")
CALLER = cases(__file__, "CALLER")


def told(bench_of: BenchOf, steps: Sequence[To | Sets]) -> list[Any]:
    """Return the sums that a node said to these steps."""
    exercise = SameAsSolution(
        "lab.adder", "Adder", "Add.", gives=lambda _: steps, tells={"/sum": "data"}
    ).exercise()
    with bench_of(ADDER, Reference("lab.adder", ENDS), Pace.FAST) as bench:
        exercise.scenario(bench)
        return [event.data["values"] for part in bench.parts for event in part.of("noted", "/sum")]


def test_whole_numbers_arrive_as_floats(bench_of: BenchOf) -> None:
    assert told(bench_of, [To("/point", {"x": -58, "y": 60, "z": 0.5})]) == [[], [[2.5]]]


@pytest.mark.parametrize(
    ("step", "says"),
    [
        (To("/pint", {"x": 1}), "Step 2 gives '/pint', which is not one of /point"),
        (
            Sets("size", 2**63),
            r"Step 2 gives /adder/set_parameters: field parameters\[0\]\.value\.integer_value is int64",
        ),
        (
            Sets("size", [1]),  # type: ignore[arg-type]
            r"Step 2 gives \[1\], which is neither a number",
        ),
    ],
    ids=["topic", "parameter", "list"],
)
def test_an_author_learns_which_step_does_not_fit(bench_of: BenchOf, step: To | Sets, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        told(bench_of, [To("/point", {"x": 1}), step])


def test_an_answer_that_does_not_fit_is_a_fault_of_the_exercise(bench_of: BenchOf) -> None:
    with bench_of(CALLER, Reference("lab.caller", {})) as bench:
        bench.part("asked")
        bench.serve("/add", ADD, lambda request: {"sum": str(request["a"])})
        bench.start()
        assert bench.wait_until(lambda evidence: bool(evidence.main.of("request")), 60.0)
        with pytest.raises(MisfitError, match="The answer of /add: field sum is int64 and cannot hold '1'"):
            bench.stop()


@pytest.mark.parametrize(
    ("send", "says"),
    [
        (lambda bench: bench.call_action("/f", FIBONACCI).send_goal(order=2.5), "/f: field order is int32"),
        (
            lambda bench: bench.serve_action("/f", FIBONACCI).send_feedback(partial_sequence=[2**31]),
            r"The feedback of /f: field partial_sequence is sequence<int32> and cannot hold \[2147483648\]",
        ),
        (
            lambda bench: bench.serve_action("/f", FIBONACCI).finish("succeeded", sequence=1),
            "The result of /f: field sequence is sequence<int32> and cannot hold 1",
        ),
        (lambda bench: bench.call("/add", ADD).ask({"a": 1}, {"a": "1"}), "/add: field a is int64"),
        (lambda bench: bench.speak("/p", POINT).send(x=True), "/p: field x is float64 and cannot hold True"),
    ],
    ids=["goal", "feedback", "result", "request", "message"],
)
def test_nothing_that_does_not_fit_is_sent(
    bench_of: BenchOf, send: Callable[[Any], object], says: str
) -> None:
    with bench_of(ADDER, Reference("lab.adder", ENDS)) as bench:
        bench.part("sent")
        with pytest.raises(MisfitError, match=says):
            send(bench)
        assert not {event.kind for event in bench.seen().events} & {"sent", "asked", "goal_sent", "feedback"}
