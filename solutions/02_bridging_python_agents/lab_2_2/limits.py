"""Lab 2.2, limits that are parameters: no command is faster than what holds at the moment."""

from random import Random

from autograder.kit import SameAsSolution, Sets, To, shuffled
from autograder.kit.oracle.drawings import LADDER

DEFAULTS, HIGHEST = {"max_forward": 0.5, "max_turn": 1.0}, {"max_forward": 1.0, "max_turn": 2.0}
BELOW, ABOVE = [factor for factor in LADDER if factor < 1], [factor for factor in LADDER if factor > 1]


def command(forward: float, turn: float) -> To:
    """Return a command of an agent."""
    return To("/agent_vel", {"linear": {"x": forward}, "angular": {"z": turn}})


def commands(random: Random, limits: dict[str, float]) -> list[To]:
    """Return a command above each limit and below the other, ahead or back, and the last one again."""
    forward, turn = limits.values()
    first, second = random.choice((-1, 1)), random.choice((-1, 1))
    told = [
        command(first * forward * random.choice(ABOVE), second * turn * random.choice(BELOW)),
        command(-first * forward * random.choice(BELOW), -second * turn * random.choice(ABOVE)),
    ]
    order = shuffled(random, told)
    return [*order, order[-1]]


def steps(random: Random) -> list[To | Sets]:
    """Return commands just beside each limit, in both directions; and changes of the limits in drawn order.

    A change is taken within the range of its parameter, also at its end, and refused just beside it.
    """
    limits = dict(DEFAULTS)
    beside = [sign * factor for sign in (1, -1) for factor in (0.98, 1.02)]
    told: list[To | Sets] = [
        command(limits["max_forward"] * forward, limits["max_turn"] * turn)
        for forward, turn in zip(shuffled(random, beside), shuffled(random, beside), strict=True)
    ]
    changes = [(name, high * factor) for name, high in HIGHEST.items() for factor in (1.02, -0.02)]
    changes += [
        ("max_forward", random.choice((0.2, 0.3, 0.98))),
        ("max_turn", random.choice((0.3, 0.6, 1.96))),
    ]
    changes += [random.choice(list(HIGHEST.items()))]
    for name, value in shuffled(random, changes):
        told.append(Sets(name, value))
        if 0 <= value <= HIGHEST[name]:
            limits[name] = value
            told += commands(random, limits)
    return [*told, *commands(random, limits)]


EXERCISE = SameAsSolution(
    "lab_2_2.limits",
    "Lab 2.2 · Limits",
    "Hand each command on, within limits that are parameters.",
    gives=steps,
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
