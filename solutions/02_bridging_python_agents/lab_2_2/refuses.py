"""Lab 2.2, a bad moment: limits are refused with a reason while the red button is pressed."""

from random import Random

from autograder.kit.oracle.same_as_solution import SameAsSolution, Sets, To


def limits(random: Random) -> list[Sets]:
    """Return a change of each limit, within its range."""
    return [Sets("max_forward", random.uniform(0.2, 0.9)), Sets("max_turn", random.uniform(0.3, 1.9))]


def fast(random: Random) -> To:
    """Return a command above each limit."""
    return To(
        "/agent_vel", {"linear": {"x": random.uniform(1.5, 4.0)}, "angular": {"z": random.uniform(2.5, 6.0)}}
    )


def steps(random: Random) -> list[To | Sets]:
    """Return changes before the button is pressed, while it is pressed, and after that."""
    pressed, released = (To("/stop", {"data": data}) for data in (True, False))
    during: list[To | Sets] = [pressed, *limits(random), released, fast(random)]
    return [*limits(random), fast(random), *during, *limits(random), fast(random)]


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
