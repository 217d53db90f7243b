"""Ends a look in real time once the subject has made each mistake of the look before again: the rest is known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from autograder.kit.bench import Pace
from autograder.kit.oracle.naming.deltas import rows
from autograder.kit.rules import same

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.oracle.outputs import Output


class MistakesAgain:
    """The mistakes of the look before: the first wrong step of each output.

    Args:
        bench: The bench of the present look, which has begun.
        outputs: The outputs that are compared.
    """

    def __init__(self, bench: Bench, outputs: Sequence[Output]) -> None:
        self._bench = bench
        self._wrong: Sequence[tuple[Output, Mapping[int, Any]]] = ()
        if bench.before is None or bench.pace is Pace.FAST:
            return
        run = bench.before.main
        due = bench.reference.part(run.name)
        failed = [output for output in outputs if not output.agrees(run, due)]
        noted = [(output, event.data["step"]) for output in failed if (event := output.noted_at(run, due))]
        wrong = [
            (output, {at: values for at, values in rows(output, run).items() if at <= step})
            for output, step in noted
        ]
        # If an output has no steps, or ended before its first wrong one, only a whole look tells. So it does of a
        # subject that was silent: by another clock it may say something in real time.
        if len(noted) == len(failed) and all(any(before.values()) for _, before in wrong):
            self._wrong = wrong

    def end_look(self, steps: int, values: Callable[[Output, int], Sequence[Any]]) -> None:
        """End the look if the subject has made each of the mistakes again, in the same step after the same ones.

        Args:
            steps: The number of steps that are over.
            values: Returns the values of an output in a step.
        """
        # The step after the last wrong one is over, too, so that what was sent late has come.
        if not self._wrong or steps != max(map(max, (before for _, before in self._wrong))) + 2:
            return
        if self._are_made(values):
            self._bench.settle()
            if self._are_made(values):
                self._bench.doubt()  # a node that is right in real time may be late on a busy machine
                self._bench.confirm()

    def _are_made(self, values: Callable[[Output, int], Sequence[Any]]) -> bool:
        return all(
            same(values(output, step), told, output.tolerance)
            for output, before in self._wrong
            for step, told in before.items()
        )
