"""The steps of a mission, which the judge takes one after the other while the world goes on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from autograder.kit.mission.moment import Moment, World
from autograder.kit.oracle.steps import To
from autograder.kit.recipes.own_scenario import QUIET

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.kit.bench import Bench
    from autograder.kit.counterparts import ActionCaller, Caller
    from autograder.kit.evidence import Evidence
    from autograder.kit.mission.robot import Robot


@dataclass(frozen=True)
class Goal:
    """A goal for an action of the subject. The step is over when the result has come.

    Attributes:
        action: The name of the action, such as ``"/dock"``.
        fields: The fields of the goal.
        cancel_after: Seconds of the subject's time after which the judge asks to cancel the goal; None for never.
        within: Seconds of the subject's time until the result must have come.
    """

    action: str
    fields: Mapping[str, Any]
    cancel_after: float | None = None
    within: float = 12.0


Step = World | To | Goal | float | Callable[[Moment], bool]
"""A step: another world, a message or a call, a goal, seconds of the subject's time to let pass, or a condition."""


class Journey:
    """Takes the steps of one mission. ``go`` is called with the seconds that may pass, and a condition to stop."""

    def __init__(
        self, bench: Bench, robot: Robot, go: Callable[[float, Callable[[Moment], bool]], bool]
    ) -> None:
        ends = bench.reference.interface
        self._bench, self._robot, self._go = bench, robot, go
        self._callers: dict[str, Caller] = {n: bench.call(n, k) for n, k in ends.get("service", {}).items()}
        self._actions: dict[str, ActionCaller] = {
            n: bench.call_action(n, k) for n, k in ends.get("action_server", {}).items()
        }

    def take(self, step: Step) -> bool:
        """Take a step. Return False if the subject does not answer."""
        if isinstance(step, World):
            self._robot.enter(step)
            return True
        if isinstance(step, Goal):
            return self._pursue(step)
        if isinstance(step, To):
            return self._give(step)
        return self._go(math.inf, step) if callable(step) else self._go(step, lambda _: False)

    def _give(self, step: To) -> bool:
        fields = step.value if isinstance(step.value, dict) else {"data": step.value}
        if step.name in self._callers:
            caller = self._callers[step.name]
            if not caller.await_server(QUIET[self._bench.pace]):
                return False
            caller.ask(fields)
            return caller.await_answers(QUIET[self._bench.pace])
        if not self._robot.knows(step.name):
            raise ValueError(f"draws: the solution neither subscribes to {step.name!r} nor serves it")
        self._robot.send(step.name, fields)
        return True

    def _pursue(self, step: Goal) -> bool:
        if step.action not in self._actions:
            raise ValueError(f"draws: the solution has no action {step.action!r}")
        caller = self._actions[step.action]
        if not caller.await_server(QUIET[self._bench.pace]):
            return False
        number = caller.send_goal(**step.fields)
        if not self._came("goal_answer", number):
            return False
        if step.cancel_after is not None:
            ended = self._go(step.cancel_after, lambda now: now.goal(number).over)
            caller.cancel(number)
            if not (ended and self._came("cancel_answer", number)):
                return False
        answers = self._go(step.within, lambda now: now.goal(number).over)
        return answers and self._robot.now.goal(number).over

    def _came(self, kind: str, number: int) -> bool:
        def has_come(evidence: Evidence) -> bool:
            return any(event.data["goal"] == number for event in evidence.main.of(kind))

        return self._bench.wait_until(has_come, QUIET[self._bench.pace])
