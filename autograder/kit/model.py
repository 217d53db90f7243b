"""The data that describes an exercise: what the judge does (the scenario), the requirements, and known mistakes."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autograder.kit.in_words import with_placeholders

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence
    from autograder.kit.runners import Runner


UNKNOWN = "unknown"
"""The key of the diagnosis if the mistake is unknown."""
ENOUGH: Mapping[str, int] = {"right": 5, "wrong": 8}
"""The numbers of right and wrong answers that the bank needs. With fewer answers, an exercise works, but its author
cannot know whether its verdicts are fair.
"""


@dataclass(frozen=True)
class Finding:
    """The decision on a criterion, with the expected and the observed behavior in words for the card."""

    passed: bool
    expected: str
    seen: str


@dataclass(frozen=True)
class Criterion:
    """One requirement of an exercise.

    Attributes:
        name: A stable key for the criterion.
        title: The criterion in one line, as students read it.
        points: The points that the criterion is worth.
        judge: Decides from the evidence. It is called once, after the scenario has ended.
        uses: Names of methods or classes, such as ``is_cancel_requested``. If the criterion is not met and nothing says
            more about the mistake, the card quotes the student's lines that use these names.
    """

    name: str
    title: str
    points: float
    judge: Callable[[Evidence], Finding]
    uses: Sequence[str] = ()


@dataclass(frozen=True)
class Advice:
    """The text for the student about a recognized mistake.

    Attributes:
        text: What happened, and why.
        next_step: What the student should do now.
        traceback: The traceback that shows the mistake, for the card; empty if the mistake was recognized from
            something else.
        key: The key of the mistake if only the recording of the exercise has it; empty for the key of the
            :class:`Mistake`.
        uses: Names of methods or classes, such as ``create_timer``. The card quotes the student's lines that use these
            names, and says if no line does. ``def tick`` and ``count =`` are names, too: of a definition, and of an
            assignment.
    """

    text: str
    next_step: str
    traceback: str = ""
    key: str = ""
    uses: Sequence[str] = ()


@dataclass(frozen=True)
class Mistake:
    """A known mistake, and how to recognize it.

    Attributes:
        key: A stable name, listed in ``docs/mistakes.md``.
        recognize: Returns the advice if the evidence shows this mistake, otherwise None.
        certain: True if the evidence proves the mistake however busy the machine was. Then no second look in real time
            is needed.
    """

    key: str
    recognize: Callable[[Evidence], Advice | None]
    certain: bool = False


def mistake(
    key: str,
    found: Callable[[Evidence], object],
    text: str,
    next_step: str,
    *,
    certain: bool = False,
    uses: Sequence[str] = (),
) -> Mistake:
    """Return a known mistake whose advice consists of two texts with placeholders.

    Args:
        key: A stable name, listed in ``docs/mistakes.md``.
        found: Returns whatever shows the mistake; a false value, such as None or "", if the evidence does not show
            it.
        text: What happened, and why. ``{}`` stands for the value that was found, ``{0[1]}`` for an element of it.
        next_step: What the student should do now, with the same placeholders.
        certain: True if the evidence proves the mistake however busy the machine was.
        uses: As in :class:`Advice`.

    Raises:
        ValueError: A text has a single brace, or a placeholder that cannot be filled in.
    """
    for words in (text, next_step):
        with_placeholders(words)

    def recognize(evidence: Evidence) -> Advice | None:
        shown = found(evidence)
        return Advice(text.format(shown), next_step.format(shown), uses=uses) if shown else None

    return Mistake(key, recognize, certain)


def card_words(module: str) -> dict[str, tuple[str, str]]:
    """Return the two texts of each mistake that a module knows, from the TOML file beside it, for :func:`mistake`.

    Args:
        module: The path of the module, its ``__file__``.
    """
    rows = tomllib.loads(Path(module).with_suffix(".toml").read_text(encoding="utf-8"))
    return {name: (row["text"], row["next_step"]) for name, row in rows.items()}


def filled_in(words: tuple[str, str], /, *, traceback: str = "", **values: object) -> Advice:
    """Return the advice with two texts of :func:`card_words`, whose placeholders stand for the given values."""
    text, next_step = (one.format(**values) for one in words)
    return Advice(text, next_step, traceback)


def unless(
    expected: str, wrong: Callable[[Evidence], str], right: str = "it did"
) -> Callable[[Evidence], Finding]:
    """Return a function that decides a criterion: it is met unless something is wrong.

    Args:
        expected: The expected behavior in words for the card.
        wrong: Returns what is wrong, in words; empty if nothing is.
        right: The observed behavior in words if nothing is wrong.

    Example::

        def too_many(evidence: Evidence) -> str:
            return f"{count} calls" if (count := len(evidence.main.of("request"))) > 1 else ""

        client.asks("once", "Calls once", unless("at most one call", too_many), points=2)
    """

    def judge(evidence: Evidence) -> Finding:
        seen = wrong(evidence)
        return Finding(not seen, expected, seen or right)

    return judge


@dataclass(frozen=True)
class Exercise:
    """A graded exercise.

    Attributes:
        id: The exercise's id, such as ``"lab_1_2.talker"``.
        title: The title that students read.
        task: One sentence that states the task.
        scenario: The function that runs all parts of the exercise on a bench.
        criteria: The requirements, in the order in which the card shows them.
        mistakes: The known mistakes, most specific first.
        text: Maps each sentence of the task's text to the names of the criteria that judge it, separated by spaces. A
            sentence without names is not graded, and the card says so.
        counts: For criteria by their names, one or two short sentences about what else is accepted. The card shows them
            below the criterion. Under the name ``""``, the same about the exercise as a whole.
        hides_causes: True if finding the cause is the task. Then no look uses the subject's own names, and until the
            pass the card tells no cause (:mod:`autograder.kit.hunts.repairs`). The site shows no solution.
        enough: The numbers of right and wrong answers that the bank needs; no numbers if it needs none.
        remarks: Functions that return a sentence for the card that costs no points, or an empty text.
        roles: The roles of the subject's endpoints, such as ``("publisher",)``. `record` waits for one of them.
        unasked: The names of the solution's endpoints that the task does not ask for. The recording leaves them out, so
            a subject need not have them.
        limit: The time limit of a check in seconds of wall time, for both looks together. A command gets more time,
            because it may build first (`autograder/judge/command_check.py`).
        arguments: A description of the arguments that a command takes; empty if it takes none.
        sample_arguments: Example arguments with which ``record`` starts the reference solution to see its endpoints.
        second_look: True if a subject that fails in simulated time gets a second look in real time.
        runner: How `autograder.workspaces` runs a path that is given instead of a command; None if the subject cannot
            be a path.
        wraps_commands: True if ``runner`` also runs commands.
        recorded: The kinds of events that a reference output keeps; None for the kinds that every exercise keeps.
        tolerance: The tolerance for numbers when two recordings of the solution are compared, absolute or relative.
        is_drawn: True if the recording has several drawings of the inputs, and a check gives one of them. A class has
            drawings of its own.
    """

    id: str
    title: str
    task: str
    scenario: Callable[[Bench], None]
    criteria: Sequence[Criterion]
    mistakes: Sequence[Mistake]
    roles: tuple[str, ...]
    unasked: Sequence[str] = ()
    limit: float = 60.0
    arguments: str = ""
    sample_arguments: tuple[Any, ...] = field(default=())
    second_look: bool = True
    runner: Runner | None = None
    wraps_commands: bool = False
    recorded: tuple[str, ...] | None = None
    tolerance: float = 1e-6
    remarks: Sequence[Callable[[Evidence], str]] = ()
    text: Mapping[str, str] = field(default_factory=dict)
    counts: Mapping[str, str] = field(default_factory=dict)
    hides_causes: bool = False
    enough: Mapping[str, int] = field(default_factory=lambda: ENOUGH)
    is_drawn: bool = False

    @property
    def points(self) -> float:
        """The points of all criteria together."""
        return sum(criterion.points for criterion in self.criteria)

    @property
    def counts_as_a_whole(self) -> str:
        """The sentences about the exercise as a whole, then those of the task that are not graded."""
        free = "; ".join(f"“{words}”" for words, names in self.text.items() if not names)
        return f"{self.counts.get('', '')} {free and f'Not graded: {free}.'}".strip()

    def judge_as_one(self, evidence: Evidence, right: str) -> Finding:
        """Return the finding of the first criterion that fails; if all criteria hold, a finding that says so.

        Args:
            evidence: Everything that the judge recorded.
            right: The observed behavior in a few words, for the case that all criteria hold.
        """
        findings = [criterion.judge(evidence) for criterion in self.criteria]
        holds = Finding(True, findings[0].expected, right)
        return next((finding for finding in findings if not finding.passed), holds)
