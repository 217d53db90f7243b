"""Lab 2.2, a red button: nothing moves while it is pressed, and only a new command moves the robot after that."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.kit import SameAsSolution, To, drawn_until, shuffled

if TYPE_CHECKING:
    from random import Random

    from autograder.kit import Bench
    from autograder.kit.oracle.outputs import Output
    from autograder.kit.oracle.steps import Turn


def command(random: Random) -> To:
    """Return a command below the limits."""
    return To(
        "/agent_vel", {"linear": {"x": random.uniform(0.1, 0.4)}, "angular": {"z": random.uniform(0.1, 0.9)}}
    )


def button(pressed: bool) -> To:
    """Return a press of the button, or its release."""
    return To("/stop", {"data": pressed})


STILL = To("/agent_vel", {"linear": {"x": 0.0}})
"""A command of an agent that stands: it does not release the stop."""

AGAIN = button(True)
"""The button, pressed while the stop holds."""


class RedButton(SameAsSolution):
    """Compares the outputs of each step, but not what is published when the button is pressed again.

    The robot stands already, so a right answer may send one more Twist or none.
    """

    def _values(self, bench: Bench, output: Output, turn: Turn, following: Turn | None = None) -> list[Any]:
        is_free = output.name == "/cmd_vel" and turn.step is AGAIN
        return [] if is_free else super()._values(bench, output, turn, following)


def steps(random: Random) -> list[To | float]:
    """Return three rounds in drawn order: commands, the press, what happens until the release, and what comes after."""
    # The first is a command that moves: after a release that should not be, it tells what released.
    held = [command(random), *shuffled(random, [STILL, command(random)])]
    long: list[To | float] = [command(random), button(True), *held, 3.2, command(random), button(False), 0.9]
    silent: list[To | float] = [
        command(random),
        command(random),
        button(True),
        0.9,
        command(random),
        button(False),
        button(False),
    ]
    # By now the watchdog has stopped the robot, so only the button can publish once more.
    short: list[To | float] = [command(random), 0.9, button(True), AGAIN, command(random), button(False)]
    # It comes later than another round, so that a button that works only once is noticed.
    rounds = drawn_until(lambda: shuffled(random, [long, silent, short]), lambda order: order[0] is not short)
    return [*(step for each in rounds for step in each), command(random), 0.9]


EXERCISE = RedButton(
    "lab_2_2.stop",
    "Lab 2.2 · The red button",
    "Stop the robot when the button is pressed, and hold it until it is released.",
    gives=steps,
    tells={"/cmd_vel": ("linear.x", "angular.z"), "/stop": ("success", "message")},
    every=True,
    pause=0.3,
    roles=("service", "publisher", "subscription"),
).exercise(
    text={
        "stop the robot at once with one `Twist()`": "cmd_vel",
        "While the stop holds, publish nothing, whatever the agent says.": "cmd_vel",
        "publish nothing, and answer with `success` true and the `message` `released`": "stop cmd_vel",
        "Only a *new* command moves the robot again": "cmd_vel",
    }
)
