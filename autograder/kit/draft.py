"""An exercise while it is written: a recipe, then criteria and mistakes, each a decorated function.

A function gets two views of the same kind, made by the recipe: the record of the subject, and the record of the
reference solution. There are two ways to add a mistake. :meth:`Draft.knows` takes two texts, which may quote from
both views, ``"It carries {seen.counters[0]}."``, and what was found, as ``{}``. If texts are not enough,
:meth:`Draft.mistake` decorates a function that returns the advice itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from autograder.kit.common_mistakes import constructor_remark
from autograder.kit.model import Advice, Bench, Criterion, Exercise, Finding, Mistake

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Evidence

View = TypeVar("View")
View_co = TypeVar("View_co", covariant=True)
Judge = Callable[[View, View], Finding]
"""Decides a criterion from the records of the subject and of the reference."""
Told = Callable[[View, View], Advice | None]
"""Returns the advice about a mistake, if it was made."""


class Recipe(Protocol[View_co]):
    """The common part of exercises about one kind of subject."""

    @property
    def roles(self) -> tuple[str, ...]:
        """The roles of the subject's endpoints."""

    @property
    def ladder(self) -> Sequence[Mistake]:
        """The common mistakes, most telling first; :data:`OWN` and :data:`OWN_LATE` hold the exercise's places."""

    def scenario(self, bench: Bench) -> None:
        """Drive the bench through all parts."""

    def seen(self, evidence: Evidence) -> View_co:
        """The subject, as it was seen."""

    def expected(self, evidence: Evidence) -> View_co:
        """The reference solution, as it was recorded."""


class SeenAsItIs:
    """A recipe whose two views are the evidence itself, because there are several runs; it contains the reference."""

    def seen(self, evidence: Evidence) -> Evidence:
        """The subject, as it was seen."""
        return evidence

    def expected(self, evidence: Evidence) -> Evidence:
        """The same evidence: it contains the reference, too."""
        return evidence


OWN = Mistake("", lambda _: None)
"""The place in a ladder for an exercise's own mistakes: before those of nodes that hang or are not spun."""
OWN_LATE = Mistake("", lambda _: None)
"""The place for own mistakes that a node which is not spun would show as well."""


class Draft(Generic[View]):
    """Collects an exercise.

    Args:
        exercise_id: Such as ``"lab_8_1.battery"``: the lab's folder and the file's name.
        title: The title of the card: the lab and the subject.
        task: One sentence that states the task.
        recipe: The recipe for the kind of subject.
    """

    def __init__(self, exercise_id: str, title: str, task: str, recipe: Recipe[View]) -> None:
        self._id, self._title, self._task, self._recipe = exercise_id, title, task, recipe
        self._criteria: list[Criterion] = []
        self._own: dict[int, list[Mistake]] = {id(OWN): [], id(OWN_LATE): []}
        self._before: dict[str, list[Mistake]] = {}

    def asks(self, name: str, points: float, title: str, judge: Callable[[Evidence], Finding]) -> None:
        """Add a criterion of the recipe, in the order of the card.

        Args:
            name: A stable key.
            points: The points for it.
            title: One line for people.
            judge: A criterion of the recipe.
        """
        self._criteria.append(Criterion(name, title, points, judge))

    def criterion(self, name: str, points: float, title: str) -> Callable[[Judge[View]], Judge[View]]:
        """Add a criterion of the exercise's own, in the order of the card.

        Args:
            name: A stable key.
            points: The points for it.
            title: One line for people.
        """

        def add(judge: Judge[View]) -> Judge[View]:
            self._criteria.append(
                Criterion(name, title, points, lambda evidence: judge(*self._views(evidence)))
            )
            return judge

        return add

    def knows(
        self,
        key: str,
        found: Callable[[View, View], object],
        says: str,
        next_step: str,
        *,
        certain: bool | Callable[[View], bool] = False,
        late: bool = False,
        before: str = "",
    ) -> None:
        """Add a known mistake that is described in two texts, most telling first.

        Args:
            key: A stable name, explained in ``docs/mistakes.md``.
            found: Returns what shows the mistake; anything false if nothing does.
            says: What the student is told, with placeholders such as ``{seen.texts[0]}``; ``{}`` is what was found.
            next_step: What to do about it, with the same placeholders.
            certain: True if the record proves it whatever the machine's load was; or a function that decides this.
            late: True if a node that hangs or is not spun would show it as well, so that those are checked first.
            before: The key of the common mistake before which it is checked, if its place is neither of the two.
        """

        def told(seen: View, expected: View) -> Advice | None:
            if not (shown := found(seen, expected)):
                return None
            views = {"seen": seen, "expected": expected}
            return Advice(says.format(shown, **views), next_step.format(shown, **views))

        self.mistake(key, certain=certain, late=late, before=before)(told)

    def mistake(
        self,
        key: str,
        *,
        certain: bool | Callable[[View], bool] = False,
        late: bool = False,
        before: str = "",
    ) -> Callable[[Told[View]], Told[View]]:
        """Add a known mistake whose advice the decorated function returns; the arguments are those of :meth:`knows`."""

        def add(told: Told[View]) -> Told[View]:
            def advice(evidence: Evidence) -> Advice | None:
                return told(*self._views(evidence))

            def proven(evidence: Evidence) -> Advice | None:
                holds = callable(certain) and certain(self._recipe.seen(evidence))
                return advice(evidence) if holds else None

            usual = self._own[id(OWN_LATE if late else OWN)]
            own = self._before.setdefault(before, []) if before else usual
            if callable(certain):
                own.append(Mistake(key, proven, certain=True))
            own.append(Mistake(key, advice, certain=certain is True))
            return told

        return add

    def exercise(self, **more: Any) -> Exercise:
        """Return the exercise, after everything was added.

        Args:
            more: Further attributes of :class:`autograder.kit.model.Exercise`.

        Raises:
            ValueError: A mistake is to come before one that the recipe does not have.
        """
        before, mistakes = dict(self._before), list[Mistake]()
        for common in self._recipe.ladder:
            mistakes += [*before.pop(common.key, ()), *self._own.get(id(common), [common])]
        if before:
            raise ValueError(
                f"the recipe has no mistake {' and no '.join(before)} for another one to come before"
            )
        return Exercise(
            id=self._id,
            title=self._title,
            task=self._task,
            scenario=self._recipe.scenario,
            criteria=tuple(self._criteria),
            mistakes=tuple(mistakes),
            roles=self._recipe.roles,
            remarks=(*more.pop("remarks", ()), constructor_remark),
            **more,
        )

    def _views(self, evidence: Evidence) -> tuple[View, View]:
        return self._recipe.seen(evidence), self._recipe.expected(evidence)
