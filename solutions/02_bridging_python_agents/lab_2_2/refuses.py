"""Lab 2.2, a bad moment: limits are refused with a reason while the red button is pressed."""

from random import Random

from autograder.kit import SameAsSolution, Sets, To, shuffled

LOWER, HIGHER = 0.65, 1.37
"""New limits, as multiples of those that hold: both are within the ranges, also after one another."""


def fast(random: Random) -> To:
    """Return a command above each limit."""
    return To(
        "/agent_vel", {"linear": {"x": random.uniform(1.5, 4.0)}, "angular": {"z": random.uniform(2.5, 6.0)}}
    )


def steps(random: Random) -> list[To | Sets]:
    """Return changes to higher and to lower limits, before the button is pressed, meanwhile, and after that.

    How many commands come in between is drawn, so that a node that counts its inputs is wrong.
    """
    pressed, released = (To("/stop", {"data": data}) for data in (True, False))
    limits = {"max_forward": 0.5, "max_turn": 1.0}
    told: list[To | Sets] = []
    for factor in shuffled(random, (LOWER, HIGHER)):
        limits = {name: round(limit * factor, 4) for name, limit in limits.items()}
        changes = [Sets(name, value) for name, value in limits.items()]
        during = [
            Sets(name, round(value * beside, 4))
            for name, value in limits.items()
            for beside in (LOWER, HIGHER)
        ]
        told += [
            *shuffled(random, changes),
            *(fast(random) for _ in range(random.randint(1, 3))),
            pressed,
            *shuffled(random, during),
            released,
            fast(random),
        ]
    last = [Sets(name, round(limit * random.choice((LOWER, HIGHER)), 4)) for name, limit in limits.items()]
    return [*told, *shuffled(random, last), fast(random)]


EXERCISE = SameAsSolution(
    "lab_2_2.refuses",
    "Lab 2.2 · A bad moment",
    "Refuse each change of a limit while the stop holds, and say why.",
    gives=steps,
    tells={"/cmd_vel": ("linear.x", "angular.z")},
    parameters=["max_forward", "max_turn"],
    pause=0.3,
    roles=("service", "publisher", "subscription"),
).exercise(text={"So no limit may change then": "max_forward max_turn cmd_vel"})
