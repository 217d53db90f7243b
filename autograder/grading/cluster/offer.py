"""What a machine offers to a cluster: which course it has, and whether it can execute in boxes."""

from __future__ import annotations

from autograder.boxes.sandbox import why_impossible
from autograder.grading.cluster.messages import Offer
from autograder.grading.rebuilding.course_version import course_version


def offer(slots: int) -> Offer:
    """What this machine offers.

    Args:
        slots: Notebooks at once.
    """
    obstacle = why_impossible()
    return Offer(course_version(), slots, sandbox=not obstacle, obstacle=obstacle)
