"""The common part of declared exercises: the author says what is due; steps, verdict and mistakes follow from that.

A ``Relay`` listens on one topic and publishes on another. A ``Machine`` has a state that a service changes and a
topic reports. A common wrong answer is a variant of the function that says what is due.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from typing import TYPE_CHECKING, Any, TypeVar

from autograder.kit.draft import Draft
from autograder.kit.model import Finding
from autograder.kit.recipes.own_scenario import OwnScenario
from autograder.kit.rules import in_words, same

if TYPE_CHECKING:
    from autograder.kit.evidence import Part
    from autograder.kit.model import Bench, Exercise

Function = TypeVar("Function", bound=Callable[..., Any])


class Declared:
    """The common part of declared exercises.

    Args:
        exercise_id: Such as ``"lab_8_1.filter"``.
        title: The title of the card: the lab and the subject.
        task: One sentence that states the task.
        scenario: Drives the bench.
        roles: The endpoints of the subject, the most telling first.
        given: The kind of event of an input that the subject has certainly received. A subject with fewer inputs than
            the reference solution passes no criterion about its outputs.
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        scenario: Callable[[Bench], None],
        *roles: str,
        given: str,
    ) -> None:
        self._subject = OwnScenario(scenario, *roles)
        self._draft = Draft(exercise_id, title, task, self._subject)
        self._text: dict[str, str] = {}
        self._given = given
        self._tolerance = 1e-6

    def asks(self, name: str, points: float, title: str, role: str, words: str = "") -> None:
        """Add a criterion: the endpoints of a role have the names and types of the reference solution's.

        Args:
            name: A stable key.
            points: The points for it.
            title: One line for people.
            role: Such as ``"subscription"``.
            words: The words of the task that the criterion judges, as ``lab.md`` has them.
        """
        self._draft.asks(name, points, title, self._subject.has(role))
        self._judges(name, words)

    def exercise(self) -> Exercise:
        """Return the exercise, after everything was added."""
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
        """Return True if the subject was given as much as the reference solution."""
        return len(seen.of(self._given)) >= len(expected.of(self._given))

    def _judges(self, name: str, words: str) -> None:
        if words:
            self._text[words] = f"{self._text[words]} {name}" if words in self._text else name

    def _knows(self, key: str, found: Callable[[Part], bool], says: str, next_step: str) -> None:
        self._draft.knows(key, lambda seen, _: found(seen), says, next_step, certain=True)


def variant(right: Function, changed: Function | Mapping[str, Any]) -> Function | partial[Any]:
    """Return a wrong function: the given one, or the right one with other values of its arguments."""
    return partial(right, **changed) if isinstance(changed, Mapping) else changed


def fields(seen: Part, kind: str) -> list[Mapping[str, Any]]:
    """Return the fields of each event of a kind."""
    return [event.data["fields"] for event in seen.of(kind)]


def picked(seen: Part, kind: str, path: str) -> list[Any]:
    """Return one field of each event of a kind, by its path."""
    return [pick(one, path) for one in fields(seen, kind)]


def pick(fields: Any, path: str) -> Any:
    """Return the field with a path such as ``"pose.position.x"``."""
    return reduce(lambda part, key: part[key], path.split("."), fields)


def put(fields: dict[str, Any], path: str, given: Any) -> None:
    """Set the field with a path."""
    *above, last = path.split(".")
    reduce(lambda part, key: part.setdefault(key, {}), above, fields)[last] = given
