"""Recognizes a node that does not take the time from the robot's clock: it goes on while that clock stands still."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.kit.model import Advice

if TYPE_CHECKING:
    from collections.abc import Iterable

    from autograder.kit.evidence import Part
    from autograder.kit.oracle.outputs import Output

KEY = "another_clock"


def on_another_clock(outputs: Iterable[Output], seen: Part, expected: Part) -> Advice | None:
    """Return the advice for a node whose first wrong output came while the robot's clock stood still; else None.

    Args:
        outputs: The outputs that are compared.
        seen: The run of the subject.
        expected: The run of the solution in the same drawing.
    """
    partings = filter(None, (output.parts_at(seen, expected) for output in outputs))
    first = min(partings, key=lambda noted: noted.data["step"], default=None)
    # A node that does nothing there is slow, or has ended: it acts on no clock.
    if first is None or not (first.data.get("stood") and first.data["values"]):
        return None
    return Advice(
        f"The robot's time stood still for {first.data['stood']:g} s, and your node acted as if time had passed.",
        "Take the time from self.get_clock().now(), and wait with self.create_timer: both follow the robot's time. "
        "time.time(), time.monotonic(), time.sleep() and a thread's timer follow the computer's.",
    )


def noted_before(before: Part, name: str, step: int, values: list[Any]) -> list[Any]:
    """Return what the subject said in this step of the look before, or ``values`` if it did not get so far.

    That look was in simulated time. In real time no clock can stand still, so a node on another clock is right there.
    """
    noted = (event.data["values"] for event in before.of("noted", name) if event.data["step"] == step)
    return next(noted, values)
