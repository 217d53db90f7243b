"""The common part of declared exercises: the author declares the right output, and the kit makes everything else.

The kit makes the scenario, the criteria and the mistakes. For example, a ``Relay`` is a node that listens on one topic
and publishes on another, and a ``Machine`` is a node with a state that a service changes and a topic reports. The
author declares the right output as a function, and each common wrong answer as a variant of this function.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from typing import TYPE_CHECKING, Any, TypeVar

from autograder.kit.draft import Draft
from autograder.kit.model import Finding
from autograder.kit.recipes.own_scenario import OwnScenario, Spoken
from autograder.kit.rules import got_through, in_words, same

if TYPE_CHECKING:
    from autograder.kit.evidence import Part
    from autograder.kit.model import Bench, Exercise

SILENCE = object()
"""The author's function returns this if the subject must not publish anything."""
Function = TypeVar("Function", bound=Callable[..., Any])


class Declared:
    """The base class of exercises in which the author declares the right output.

    Args:
        exercise_id: The lab's folder and the file's name, such as ``"lab_8_1.filter"``.
        title: The title of the card, naming the lab and the subject.
        task: One sentence that states the task.
        scenario: The function that runs all parts of the exercise on a bench.
        roles: The roles of the subject's endpoints. The first role is the one whose endpoint shows most about the
            subject.
        given: The kind of event that records an input that the subject has certainly received. If a subject got fewer
            inputs than the reference solution, it fails the criteria about its outputs.
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        scenario: Callable[[Bench], None],
        *roles: str,
        given: str,
        words: Sequence[str] = (),
    ) -> None:
        self._subject = Spoken(scenario, words, *roles) if words else OwnScenario(scenario, *roles)
        self._draft = Draft(exercise_id, title, task, self._subject)
        self._text: dict[str, str] = {}
        self._given = given
        self._tolerance = 1e-6

    def asks(self, name: str, points: float, title: str, role: str, words: str = "") -> None:
        """Add the criterion that the subject's endpoints of a role have the same names and types as the reference's.

        Args:
            name: A stable key for the criterion.
            points: The points that the criterion is worth.
            title: The criterion in one line, as the card shows it.
            role: The role of the endpoints, such as ``"subscription"``.
            words: The sentence of the task that the criterion judges, exactly as in ``lab.md``.
        """
        self._draft.asks(name, points, title, self._subject.has(role))
        self._judges(name, words)

    def exercise(self) -> Exercise:
        """Return the finished exercise. Call this after adding all criteria and mistakes."""
        return self._draft.exercise(text=self._text)

    def _compares(
        self,
        name: str,
        points: float,
        title: str,
        due: Callable[[Part], Sequence[Any]],
        came: Callable[[Part], Sequence[Any]],
        words: str,
    ) -> None:
        def judge(seen: Part, expected: Part) -> Finding:
            wanted, made = due(seen), came(seen)
            if not wanted:
                return Finding(False, f"such as {in_words(due(expected))}", in_words(made))
            whole = self._got_through(seen, expected)
            more = "" if whole else ", and more after that"
            passed = whole and same(list(wanted), list(made), self._tolerance)
            return Finding(passed, in_words(wanted) + more, in_words(made))

        self._draft.criterion(name, points, title)(judge)
        self._judges(name, words)

    def _got_through(self, seen: Part, expected: Part) -> bool:
        return got_through(seen, expected, self._given)

    def _judges(self, name: str, words: str) -> None:
        if words:
            self._text[words] = f"{self._text[words]} {name}" if words in self._text else name

    def _knows(
        self, key: str, found: Callable[[Part], object], says: str, next_step: str, *, certain: bool = True
    ) -> None:
        self._draft.knows(key, lambda seen, _: found(seen), says, next_step, certain=certain)


def variant(right: Function, changed: Function | Mapping[str, Any]) -> Function | partial[Any]:
    """Return a wrong function: ``changed`` itself, or ``right`` with other values for some of its arguments."""
    return partial(right, **changed) if isinstance(changed, Mapping) else changed


def fields(seen: Part, kind: str) -> list[Mapping[str, Any]]:
    """Return the fields of each event of a kind."""
    return [event.data["fields"] for event in seen.of(kind)]


def picked(seen: Part, kind: str, path: str) -> list[Any]:
    """Return the value of one field of each event of a kind."""
    return [pick(one, path) for one in fields(seen, kind)]


def pick(fields: Any, path: str) -> Any:
    """Return the value of a field, given by its path, such as ``"pose.position.x"``."""
    return reduce(lambda part, key: part[key], path.split("."), fields)


def put(fields: dict[str, Any], path: str, given: Any) -> None:
    """Set the value of a field, given by its path."""
    *above, last = path.split(".")
    reduce(lambda part, key: part.setdefault(key, {}), above, fields)[last] = given
