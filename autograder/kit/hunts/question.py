"""A question with choices: the student's function returns the text of one, and the card lists them in drawn order."""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING

from autograder.kit.draft import OWN, Draft, SeenAsItIs
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES
from autograder.kit.model import Advice, Finding
from autograder.kit.rules import value_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence
    from autograder.kit.model import Exercise

POINTS = 1.0
"""The points of a question whose author does not say how many it is worth."""
ANSWERED = 5.0
"""Time limit in seconds of wall time for the function to return."""

_THINK = "Think of what you saw while you worked on this task, or try it once more, and then choose again."


@dataclass(frozen=True)
class _Asked(SeenAsItIs):
    """The recipe for a subject without endpoints that is started once, by the scenario."""

    scenario: Callable[[Bench], None]
    roles = ()
    ladder = (*CRASHES, *OTHER_CRASHES, OWN)


@dataclass(frozen=True)
class Question:
    """A question that is answered by a function which returns a choice, or by a program that prints one.

    The text of the lab asks the question. The card lists the choices as long as the answer is not one of them, in an
    order that is different for each student and the same in each session. Case and spaces do not matter.

    Attributes:
        exercise_id: The lab's folder and the file's name, such as ``"bugs_1.dark_display_why"``.
        title: The title of the card.
        task: The question, or one sentence that states the task, as the text of the lab does.
        right: The right choice.
        choices: All choices, or only the wrong ones.
        points: The points of the exercise.

    Example::

        EXERCISE = Question(
            "bugs_1.dark_display_why",
            "Bug hunt · The dark display · Why",
            "What kept the numbers from the display?",
            right="the topic's name",
            choices=("the topic's name", "the message type", "the QoS", "nothing spun the node"),
        ).exercise()
    """

    exercise_id: str
    title: str
    task: str
    right: str
    choices: Sequence[str]
    points: float = POINTS

    def exercise(self) -> Exercise:
        """Return the finished exercise.

        Raises:
            ValueError: There is no wrong choice, or two choices differ only in case or spaces.
        """
        choices = list(dict.fromkeys((*self.choices, self.right)))
        if len(set(map(_plain, choices))) < max(len(choices), 2):
            raise ValueError(f"{self.exercise_id}: write a wrong choice, and no choice twice: {choices}")

        def scenario(bench: Bench) -> None:
            order = Random(f"{_student()} {self.exercise_id}").sample(choices, len(choices))
            bench.part("asked")
            # The order is not stored as an input, since a recording on another computer has another one.
            bench.note("choices", order=order)
            bench.start()
            bench.await_end(ANSWERED)
            bench.stop()

        draft = Draft(self.exercise_id, self.title, self.task, _Asked(scenario), points=self.points)

        @draft.criterion("right", "Names the right choice")
        def right(seen: Evidence, _: Evidence) -> Finding:
            said = answer(seen)
            return Finding(
                _plain(said) == _plain(self.right),
                "the right choice",
                f"“{said}”" if said else "no answer yet",
            )

        def choose(seen: Evidence) -> str:
            noted = seen.main.first("noted")
            listed = "; ".join(f"“{choice}”" for choice in (noted.data["order"] if noted else choices))
            return f"Let your function return the text of one choice: {listed}."

        @draft.mistake("wrong_choice", certain=True)
        def wrong_choice(seen: Evidence, _: Evidence) -> Advice | None:
            said = answer(seen)
            if not said or right(seen, seen).passed:
                return None
            if _plain(said) in map(_plain, choices):
                return Advice(f"“{said}” is not the right choice.", _THINK)
            return Advice(f"Your answer is “{said}”, which is not one of the choices.", choose(seen))

        @draft.mistake("not_written", certain=True)
        def not_written(seen: Evidence, _: Evidence) -> Advice | None:
            return None if answer(seen) else Advice("There is no answer yet.", choose(seen))

        return draft.exercise(recorded=(), text={self.task: "right"}, hides_causes=True, enough={})


def answer(seen: Evidence) -> str:
    """Return the text that the function returned or, for a program, printed last; empty if there is none."""
    returned = seen.main.returned
    if returned is None:
        return "".join(seen.main.said()[-1:]).strip()
    value = value_of(returned)
    return returned if value is None and returned != "None" else str(value or "")


def _plain(text: str) -> str:
    return " ".join(text.casefold().split()).rstrip(".")


def _student() -> str:
    """Return a text that differs between students: the name in a JupyterHub, else the user and the computer."""
    return os.environ.get("JUPYTERHUB_USER") or f"{os.getuid()} {platform.node()}"
