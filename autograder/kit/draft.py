"""A builder for exercises: it takes a recipe, and then criteria and mistakes as decorated functions.

Each function gets two views, which the recipe makes from the evidence: one of the student's subject, and one of the
reference solution. A view is an object whose attributes are facts about a subject, such as the messages it sent. There
are two ways to add a mistake. :meth:`Draft.knows` takes two texts with placeholders: ``{seen.counters[0]}`` quotes from
the subject's view, and ``{}`` stands for the value that was found. If a text needs more than placeholders,
:meth:`Draft.mistake` decorates a function that returns the advice.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from autograder.kit.in_words import with_placeholders
from autograder.kit.mistakes.runner_mistakes import with_those_of
from autograder.kit.mistakes.unfinished import constructor_remark
from autograder.kit.model import Advice, Criterion, Exercise, Finding, Mistake

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence

POINTS = 10.0
"""The points of an exercise whose author does not say how many it is worth."""
SHARE = 0.0
"""In place of points: an equal share of those that are left."""
PART = 0.5
"""The points of which each share is a multiple, so that a card shows no thirds."""
View = TypeVar("View")
View_co = TypeVar("View_co", covariant=True)
Judge = Callable[[View, View], Finding]
"""A function that decides a criterion, given the view of the subject and the view of the reference solution."""
Told = Callable[[View, View], Advice | None]
"""A function that returns the advice about a mistake; None if the subject did not make this mistake. It gets the same
two views as a :data:`Judge`.
"""


class Recipe(Protocol[View_co]):
    """The interface of a recipe, which contains what exercises about one kind of subject have in common."""

    @property
    def roles(self) -> tuple[str, ...]:
        """The roles of the endpoints that the subject must have, such as ``"publisher"``."""

    @property
    def ladder(self) -> Sequence[Mistake]:
        """The recipe's mistakes, most specific first, with the placeholders :data:`OWN` and :data:`OWN_LATE`."""

    def scenario(self, bench: Bench) -> None:
        """Run the scenario: tell the bench what to do in each part."""

    def seen(self, evidence: Evidence) -> View_co:
        """Return the student's subject as an object from which criteria and mistakes decide."""

    def expected(self, evidence: Evidence) -> View_co:
        """Return the recorded reference solution as an object of the same type as :meth:`seen` returns."""


class SeenAsItIs:
    """The base class of a recipe whose criteria and mistakes get the whole evidence, not an extract from it."""

    def seen(self, evidence: Evidence) -> Evidence:
        """Return the evidence unchanged."""
        return evidence

    def expected(self, evidence: Evidence) -> Evidence:
        """Return the evidence unchanged, because it also contains the record of the reference solution."""
        return evidence


OWN = Mistake("", lambda _: None)
"""A placeholder in a recipe's list of mistakes. An exercise's mistakes go here, before those of nodes that hang or are
not spun.
"""
OWN_LATE = Mistake("", lambda _: None)
"""A second placeholder, after the mistakes of nodes that hang or are not spun. An exercise's mistakes go here if such a
node would show them, too.
"""


class Draft(Generic[View]):
    """A builder that collects the criteria and mistakes of an exercise.

    Args:
        exercise_id: The lab's folder and the name of the exercise's file, such as ``"lab_8_1.battery"``.
        title: The title of the card; it names the lab and the subject.
        task: One sentence that states the task.
        recipe: The recipe for the kind of subject.
        points: The points of the exercise. The criteria for which no points are given share the rest equally, in whole
            and half points, the first ones more if it does not come out even.

    Example::

        heard = Publisher()
        battery = Draft("lab_8_1.battery", "Lab 8.1 · The battery", "Publish the charge every 0.5 s.", heard)
        battery.asks("topic", "Publishes on the right topic", heard.on_topic, points=3)
        battery.asks("charge", "Counts down from 100", heard.counts("self.charge"), points=7)
        EXERCISE = battery.exercise(limit=120.0)
    """

    def __init__(
        self, exercise_id: str, title: str, task: str, recipe: Recipe[View], *, points: float = POINTS
    ) -> None:
        self._id, self._title, self._task, self._recipe = exercise_id, title, task, recipe
        self._points = points
        self._criteria: list[Criterion] = []
        self._own: dict[int, list[Mistake]] = {id(OWN): [], id(OWN_LATE): []}
        self._before: dict[str, list[Mistake]] = {}

    def asks(
        self,
        name: str,
        title: str,
        judge: Callable[[Evidence], Finding],
        *,
        points: float = SHARE,
        uses: Sequence[str] = (),
    ) -> None:
        """Add a criterion that the recipe provides. The card shows the criteria in the order in which they were added.

        Args:
            name: A stable key for the criterion.
            title: The criterion in one line, as the card shows it.
            judge: The recipe's function that decides the criterion.
            points: The points that the criterion is worth; by default an equal share.
            uses: As in :class:`autograder.kit.model.Criterion`.

        Example::

            heard = Publisher()
            talker = Draft("lab_8_1.talker", "Lab 8.1 · The talker", "Publish a greeting every 0.5 s.", heard)
            talker.asks("rate", "Keeps the rate", heard.keeps_rate, points=3)
        """
        self._criteria.append(Criterion(name, title, points, judge, uses))

    def criterion(
        self, name: str, title: str, *, points: float = SHARE
    ) -> Callable[[Judge[View]], Judge[View]]:
        """Add a criterion of this exercise only. The card shows the criteria in the order in which they were added.

        Args:
            name: A stable key for the criterion.
            title: The criterion in one line, as the card shows it.
            points: The points that the criterion is worth; by default an equal share.

        Example::

            door = Draft("lab_8_1.door", "Lab 8.1", "Count who comes.", Asks(lambda _: [{}] * 3, lambda _: {}))

            @door.criterion("success", "Answers that all went well", points=2)
            def success(seen: ServerSeen, expected: ServerSeen) -> Finding:
                said = [answer["success"] for answer in seen.answers.values()]
                return Finding(bool(said) and all(said), "success is true", f"success was {said or 'never sent'}")
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
        """Add a known mistake, described in two texts. Add specific mistakes first, because the first match counts.

        Args:
            key: A stable name, explained in ``docs/mistakes.md``.
            found: Returns whatever shows the mistake; a false value, such as None or "", if the mistake was not made.
            says: The text about the mistake, with placeholders such as ``{seen.texts[0]}``; ``{}`` is the value that
                ``found`` returned.
            next_step: What the student should do now, with the same placeholders.
            certain: True if the evidence proves the mistake however busy the machine was; or a function of the
                subject's view that decides this.
            late: True if a node that hangs or is not spun would show this mistake, too. In that case the mistakes of
                such nodes are checked before this one.
            before: The key of a mistake of the recipe, just before which the new mistake is checked; by default at one
                of the two placeholders.

        Raises:
            ValueError: A text has a single brace, or a placeholder that cannot be filled in.

        Example::

            hello = Draft("lab_8_1.hello", "Lab 8.1", "Say hello.", Program("my_robot_pkg", "hello", "greeting"))
            hello.knows(
                "wrong_text",
                lambda seen, expected: bool(seen.words) and not seen.says_it,
                "Your node says “{seen.nearest}”; the task asks for “{seen.line}”.",
                "{seen.first_difference} Every letter counts.",
                late=True,
            )
        """
        for text in (says, next_step):
            with_placeholders(text, "seen", "expected")

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
        """Add a known mistake; the decorated function returns the advice. For the arguments see :meth:`knows`.

        Example::

            door = Draft("lab_8_1.door", "Lab 8.1", "Count who comes.", Asks(lambda _: [{}] * 3, lambda _: {}))

            @door.mistake("counter_stuck", certain=True)
            def counter_stuck(seen: ServerSeen, expected: ServerSeen) -> Advice | None:
                texts = [answer["message"] for answer in seen.answers.values()]
                if len(texts) < 3 or len(set(texts)) > 1:
                    return None
                return Advice(f"Every answer is “{texts[0]}”.", "Count in an attribute: self.visitors += 1.")
        """

        def add(told: Told[View]) -> Told[View]:
            def advice(evidence: Evidence) -> Advice | None:
                return told(*self._views(evidence))

            def proven(evidence: Evidence) -> Advice | None:
                holds = callable(certain) and certain(self._recipe.seen(evidence))
                return advice(evidence) if holds else None

            usual = self._own[id(OWN_LATE if late else OWN)]
            own = self._before.setdefault(before, []) if before else usual
            # Added twice: the first copy recognizes the mistake only if the evidence proves it, the second one in all
            # other evidence.
            if callable(certain):
                own.append(Mistake(key, proven, certain=True))
            own.append(Mistake(key, advice, certain=certain is True))
            return told

        return add

    def exercise(self, **more: Any) -> Exercise:
        """Return the finished exercise. Call this after adding all criteria and mistakes.

        Args:
            more: Other attributes of :class:`autograder.kit.model.Exercise`.

        Raises:
            ValueError: ``before`` names a mistake that the recipe does not have, or the criteria with points leave
                none for the others.
        """
        before, mistakes = dict(self._before), list[Mistake]()
        for common in with_those_of(more.get("runner"), self._recipe.ladder):
            # Both placeholders have an empty key, so they are told apart by identity.
            mistakes += [*before.pop(common.key, ()), *self._own.get(id(common), [common])]
        if before:
            raise ValueError(
                f"the recipe has no mistake {' and no '.join(before)}: correct the argument before=..."
            )
        return Exercise(
            id=self._id,
            title=self._title,
            task=self._task,
            scenario=self._recipe.scenario,
            criteria=self._with_points(),
            mistakes=tuple(mistakes),
            roles=self._recipe.roles,
            remarks=(*more.pop("remarks", ()), constructor_remark),
            **more,
        )

    def _with_points(self) -> tuple[Criterion, ...]:
        without = [one.name for one in self._criteria if one.points == SHARE]
        given = sum(one.points for one in self._criteria if one.points != SHARE)
        parts = (self._points - given) / PART
        if parts < len(without):
            raise ValueError(
                f"{self._id}: the other criteria have {given:g} of {self._points:g} points already: write points=... "
                f"for {' and '.join(without)}"
            )
        each, more = divmod(parts, max(1, len(without)))
        # The first criteria get half a point more, as long as there is some; what is given may leave less than a half.
        shares = {name: PART * (each + min(1.0, max(0.0, more - n))) for n, name in enumerate(without)}
        return tuple(replace(one, points=shares.get(one.name, one.points)) for one in self._criteria)

    def _views(self, evidence: Evidence) -> tuple[View, View]:
        return self._recipe.seen(evidence), self._recipe.expected(evidence)
