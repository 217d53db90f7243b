"""A recipe for plain Python: a function is called with a list, and returns what the solution returns for it."""

from __future__ import annotations

from random import Random  # noqa: TC003  (an author reads the types)
from typing import TYPE_CHECKING, Any

from autograder.kit.bench import Pace
from autograder.kit.draft import POINTS
from autograder.kit.mistakes.unfinished import STEP_MISSING
from autograder.kit.oracle.outputs import Kind
from autograder.kit.oracle.same_as_solution import TOLERANCE, SameAsSolution
from autograder.kit.rules import value_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.bench import Bench

ANSWERED = {Pace.FAST: 4.0, Pace.REAL_TIME: 10.0}
"""Time limit in seconds of wall time for the function to return."""
RETURNED = "returned"
"""The name of the only criterion, and of what is compared."""


class Returns(SameAsSolution):
    """An exercise about a function without ROS, which gets a list and returns a list or a tuple that is as long.

    It is called with another list before, so what a call leaves behind shows in the next one.

    The solution is the rule, as in :class:`SameAsSolution`: what it returns for four drawings of the list is recorded,
    and compared one by one.

    Args:
        exercise_id: The lab's folder and the file's name, such as ``"lab_8_1.agent"``.
        title: The title of the card, naming the lab and the subject.
        task: One sentence that states the task.
        gives: Draws the list that the function gets: numbers, texts, and lists of these.
        tolerance: The absolute or relative tolerance for numbers.
        points: The points of the exercise.

    Example::

        EXERCISE = Returns(
            "lab_8_1.agent",
            "An agent · Far or near",
            "Say for each distance whether to drive.",
            gives=lambda random: [[random.uniform(0.1, 2.0)] for _ in range(12)],
        ).exercise()
    """

    _told = Kind.RETURNED

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        gives: Callable[[Random], Sequence[Any]],
        tolerance: float = TOLERANCE,
        points: float = POINTS,
    ) -> None:
        super().__init__(
            exercise_id,
            title,
            task,
            gives=gives,
            tells={RETURNED: "data"},
            tolerance=tolerance,
            roles=(),
            points=points,
        )
        self._draft.knows(
            "not_written",
            lambda seen, _: {str(event.data["values"]) for event in seen.of("noted")} == {"[[None]]"},
            "Your code returns nothing: each value is None.",
            STEP_MISSING,
            certain=True,
        )

    def _gives_to(self, bench: Bench, part: str, steps: Sequence[Any], drawn: Random) -> None:
        bench.part(part)
        bench.start(self._gives(drawn))
        ended = bench.await_end(ANSWERED[bench.pace])
        if ended:
            bench.again()
            bench.start(steps)
            ended = bench.await_end(ANSWERED[bench.pace])
        if not ended:
            bench.note_where_it_hangs()
        for number, (given, value) in enumerate(zip(steps, _returned(bench), strict=False), 1):
            bench.note(RETURNED, step=number, given=str(given), values=[[value]])
        bench.stop()


def _returned(bench: Bench) -> list[Any]:
    """Return the list or tuple that the function returned, or that a program printed last; else an empty list."""
    seen = bench.seen()
    value = value_of(seen.returned or "".join(seen.said()[-1:]))
    return [*value] if isinstance(value, (list, tuple)) else []
