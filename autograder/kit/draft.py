"""An exercise while it is written: a recipe, then criteria and mistakes, each a decorated function.

A function is given two views of the same kind that the recipe makes: what was seen of the subject, and what was
recorded of the reference solution. A mistake is spelt in one of two ways. :meth:`Draft.knows` takes two texts, which
may quote from both views, ``"It carries {seen.counters[0]}."``, and what was found, as ``{}``. Where texts do not do,
:meth:`Draft.mistake` decorates a function that gives the advice itself.
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
"""Decides a criterion from what was seen and from what was recorded."""
Told = Callable[[View, View], Advice | None]
"""Says what is to be told of a mistake, if it was made."""


class Recipe(Protocol[View_co]):
    """The common part of exercises about one kind of subject."""

    @property
    def roles(self) -> tuple[str, ...]:
        """The endpoints that make up the subject's public face."""

    @property
    def ladder(self) -> Sequence[Mistake]:
        """The common mistakes, most telling first; :data:`OWN` and :data:`OWN_LATE` stand for the exercise's."""

    def scenario(self, bench: Bench) -> None:
        """Drive the bench through all parts."""

    def seen(self, evidence: Evidence) -> View_co:
        """The subject, as it was seen."""

    def expected(self, evidence: Evidence) -> View_co:
        """The reference solution, as it was recorded."""


class SeenAsItIs:
    """Both views of such a recipe are the evidence itself, which has the reference in it: there are several runs."""

    def seen(self, evidence: Evidence) -> Evidence:
        """The subject, as it was seen."""
        return evidence

    def expected(self, evidence: Evidence) -> Evidence:
        """The same: it holds what was recorded, too."""
        return evidence


OWN = Mistake("", lambda _: None)
"""The place in a ladder of an exercise's own mistakes: before anything is said of nodes that hang or are not spun."""
OWN_LATE = Mistake("", lambda _: None)
"""The place of those that a node which is not spun would show as well."""


class Draft(Generic[View]):
    """Collects an exercise.

    Args:
        exercise_id: Such as ``"lab_8_1.battery"``: the lab's folder and the file's name.
        title: For the card: the lab and what the subject is.
        task: One sentence: what is asked for.
        recipe: For the kind of subject.
    """

    def __init__(self, exercise_id: str, title: str, task: str, recipe: Recipe[View]) -> None:
        self._id, self._title, self._task, self._recipe = exercise_id, title, task, recipe
        self._criteria: list[Criterion] = []
        self._own: dict[int, list[Mistake]] = {id(OWN): [], id(OWN_LATE): []}
        self._before: dict[str, list[Mistake]] = {}

    def asks(self, name: str, points: float, title: str, judge: Callable[[Evidence], Finding]) -> None:
        """Add a criterion of the recipe's, in the order of the card.

        Args:
            name: A stable key.
            points: Points it carries.
            title: One line for a person.
            judge: What the recipe offers.
        """
        self._criteria.append(Criterion(name, title, points, judge))

    def criterion(self, name: str, points: float, title: str) -> Callable[[Judge[View]], Judge[View]]:
        """Add a criterion of the exercise's own, in the order of the card.

        Args:
            name: A stable key.
            points: Points it carries.
            title: One line for a person.
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
        """Add a known mistake that is told in two texts, most telling first.

        Args:
            key: A stable name, explained in ``docs/mistakes.md``.
            found: Gives what shows the mistake; anything that is false if nothing does.
            says: What the student is told, with places such as ``{seen.texts[0]}``; ``{}`` stands for what was found.
            next_step: What to do about it, with the same places.
            certain: What was seen proves it whatever the machine's load was; or on what that depends.
            late: A node that hangs or is not spun would show it as well, so that is asked first.
            before: The key of the common mistake before which it is asked, where its place is neither of the two.
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
        """Add a known mistake whose words the decorated function gives; the arguments are those of :meth:`knows`."""

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
        """The exercise, once everything is said of it.

        Args:
            more: Further attributes of :class:`autograder.kit.model.Exercise`.

        Raises:
            ValueError: A mistake is to come before one that the recipe does not know.
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
