"""Lab 2.3: what the exercises share: questions, and answers that nobody can guess."""

from random import Random

from autograder.kit.oracle.same_as_solution import To

PLACES = ("at the door", "in the hall", "at the dock", "by the lamp", "at the desk", "in the shed")


def place(random: Random) -> dict[str, object]:
    """Return an answer of the service ``where``."""
    return {"success": True, "message": f"{random.choice(PLACES)}, {random.randrange(100)} m"}


def questions(random: Random, count: int, stands: float = 0.0) -> list[To]:
    """Return questions with other numbers each time; after the last one, the robot's time may stand still."""
    *first, last = random.sample(range(1, 100), count)
    return [*(To("/ask", number) for number in first), To("/ask", last, stands)]
