"""A made-up exercise: a brake that says for each distance whether to brake, with drawings as a test wants them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.authoring.mutants.solutions import Solution
from autograder.authoring.mutants.trials import PaperTask, paper_task
from autograder.kit.evidence import Part, Reference
from autograder.kit.oracle.same_as_solution import SameAsSolution, To

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

    from autograder.kit.oracle.steps import Step

BRAKE = """from rclpy.node import Node
from std_msgs.msg import Bool, Float32


class Brake(Node):
    def __init__(self) -> None:
        super().__init__("brake")
        self.publisher = self.create_publisher(Bool, "/brake", 10)
        self.create_subscription(Float32, "/distance", self.on_distance, 10)

    def on_distance(self, message: Float32) -> None:
        self.publisher.publish(Bool(data=message.data < 0.8))
"""
ENDS = {
    "publisher": {"/brake": "std_msgs/msg/Bool"},
    "subscription": {"/distance": "std_msgs/msg/Float32"},
}
SOLUTION = Solution("a.brake", BRAKE, "Brake", ((BRAKE.index("    def on_distance"), len(BRAKE)),))


def by_habit(random: Random) -> list[Step]:
    """Draw distances far from the limit, in an order that never changes."""
    return [To("/distance", random.uniform(*meters)) for meters in ((0.1, 0.4), (1.7, 3.0), (0.1, 0.4))]


def by_levels(random: Random) -> list[Step]:
    """Draw distances on both sides of the limit, in any order."""
    factors = [0.3, 0.65, 0.85, 0.98, 1.02, 1.18, 1.37, 1.75]
    random.shuffle(factors)
    return [To("/distance", 0.8 * factor) for factor in factors]


def task(gives: Callable[[Random], list[Step]], *, text: str = BRAKE, fresh: int = 3) -> PaperTask:
    """Return the exercise on paper, with two practice drawings."""
    exercise = SameAsSolution(
        "a.brake", "A brake", "Brake.", gives=gives, tells={"/brake": "data"}, every=True
    ).exercise()
    stored = Reference("a.brake", ENDS, [Part(f"drawing {number}") for number in range(2)])
    return paper_task(exercise, stored, text, "Brake", fresh=fresh, must_be_recorded=False)
