"""Lab 2.2, limits that are parameters: no command is faster than what holds at the moment."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, Sets, To


def command(random: Random, *, fast: bool) -> To:
    """Return a command of an agent, ahead or back: far above each limit, or below all of them."""
    forward, turn = (random.uniform(1.5, 4.0), random.uniform(2.5, 6.0)) if fast else (0.15, 0.25)
    return To(
        "/agent_vel",
        {"linear": {"x": random.choice((-1, 1)) * forward}, "angular": {"z": random.choice((-1, 1)) * turn}},
    )


EXERCISE = SameAsSolution(
    "lab_2_2.limits",
    "Lab 2.2 · Limits",
    "Hand each command on, within limits that are parameters.",
    gives=lambda random: [
        *(command(random, fast=fast) for fast in (True, False, True)),
        Sets("max_forward", random.uniform(0.2, 0.4)),
        *(command(random, fast=fast) for fast in (True, False)),
        Sets("max_forward", random.uniform(1.1, 9.0)),
        Sets("max_turn", random.uniform(0.3, 0.9)),
        *(command(random, fast=fast) for fast in (True, True, False)),
        Sets("max_turn", random.uniform(-2.0, -0.1)),
        command(random, fast=True),
    ],
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    every=True,
    parameters=["max_forward", "max_turn"],
).exercise(
    text={
        "`max_forward`, by default 0.5, from 0.0 to 1.0": "max_forward cmd_vel",
        "`max_turn`, by default 1.0, from 0.0 to 2.0": "max_turn cmd_vel",
        "between `-max_forward` and `max_forward`": "cmd_vel",
    }
)
