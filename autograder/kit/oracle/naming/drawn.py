"""The recipe of a subject that is compared with the solution, and how it is named what such a subject does wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING

from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.action_server_mistakes import CANCEL_REFUSED, CANCEL_UNREAD
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES
from autograder.kit.mistakes.hangs import ENDLESS_LOOP
from autograder.kit.mistakes.role_mistakes import ladder
from autograder.kit.mistakes.uncalled import METHOD_UNCALLED
from autograder.kit.model import UNKNOWN, Advice, Mistake
from autograder.kit.oracle.naming import mutant_words
from autograder.kit.oracle.naming.deltas import differences, meanings_of, rows
from autograder.kit.oracle.naming.effects import Effect, effect
from autograder.kit.oracle.naming.located import first_apart, located
from autograder.kit.oracle.outputs import Kind
from autograder.kit.oracle.standing_clock import KEY, on_another_clock
from autograder.kit.recipes.own_scenario import ENDPOINTS, OwnScenario

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.oracle.outputs import Output

EXCHANGED, KEPT = "exchanged", "kept_for_ever"
"""The keys of mutants of which the sentence about the whole output says more."""
MUTANT, EFFECT = "mutant", "effect"
"""The entries of the ladder for what a mutant of the solution does, and for what is wrong with an output as a whole."""
Recognized = Callable[["Evidence"], Advice | None]
BY_A_THREAD = ("one_late",)
"""The keys of what a right node does, too, if a thread of its own publishes while the judge steps the clock."""

RIGHT_THERE = (
    "With the inputs of your notebook your code is right, but not with the other ones of your class."
)


class Drawn(OwnScenario):
    """A subject that was given one drawing of the inputs; it is compared with the solution in the same drawing.

    Args:
        outputs: What is compared.
        is_timed: True if time alone decides some of it, on any clock. A right node with a clock of its own may then do
            the same as a wrong one while the judge moves its clock, so no wrong answer is proven before the look in
            real time.
    """

    def __init__(
        self,
        scenario: Callable[[Bench], None],
        outputs: Sequence[Output],
        roles: Sequence[str],
        *,
        is_timed: bool,
    ) -> None:
        super().__init__(scenario, *roles)
        self._outputs, self._is_timed = outputs, is_timed
        self.law: Mapping[str, str] = {}
        """The sentences of the task, each with the names of the criteria that judge it."""

    def expected(self, evidence: Evidence) -> Part:
        """Return the record of the solution in the drawing that the subject was given.

        Raises:
            KeyError: The reference does not have this drawing.
        """
        reference = evidence.reference
        if not reference.parts:  # the solution is being recorded
            return evidence.main
        # A subject that was given no drawing did nothing, which is wrong in each of them.
        if not evidence.parts:
            return reference.parts[0]
        return reference.part(evidence.main.name)

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, and among them what an exercise's recordings know.

        First comes that the subject does the same as a recorded wrong answer, for which a person has written the words.
        Only after an exercise's own mistakes and whatever happened to the program comes what a mutant does.
        """
        clock = Mistake(KEY, self._on_another_clock, certain=True)
        variant, likely_variant = self._as_recorded("variant", self._same_as_a_variant)
        mutants = self._as_recorded(
            MUTANT, self._same_as_mutants, partial(self._same_as_mutants, surely=True)
        )
        # A right node with a thread of its own may look wrong as a whole in simulated time: nothing proves an effect.
        whole, last = Mistake(EFFECT, self._effect), Mistake(UNKNOWN, self._located)
        if not self.roles:  # plain Python, which has no node
            return (
                *CRASHES,
                ENDLESS_LOOP,
                *OTHER_CRASHES,
                METHOD_UNCALLED,
                OWN,
                variant,
                likely_variant,
                *mutants,
                OWN_LATE,
                whole,
                last,
            )
        usual = tuple(map(self._with_its_input, ladder(self.roles, late=(*mutants, OWN_LATE, whole))))
        at = usual.index(unfinished.NEVER_CONSTRUCTED)
        # Whether a cancel request is read and accepted is seen on the wire, and a recorded answer may do the same.
        canceled = (CANCEL_REFUSED, CANCEL_UNREAD) if "action_server" in self.roles else ()
        return (*usual[:at], METHOD_UNCALLED, *canceled, variant, clock, likely_variant, *usual[at:], last)

    def _with_its_input(self, known: Mistake) -> Mistake:
        """Return the mistake. That of a crash also says after which input the run first leaves the solution's."""
        if known not in OTHER_CRASHES:
            return known

        def recognize(evidence: Evidence) -> Advice | None:
            told, run, due = known.recognize(evidence), evidence.main, self.expected(evidence)
            where = first_apart(self._outputs, run, due) if told and run.name == due.name else ""
            return replace(told, text=f"{told.text} {where}".rstrip()) if told else None

        return replace(known, recognize=recognize)

    def _as_recorded(
        self, key: str, likely: Recognized, sure: Recognized | None = None
    ) -> tuple[Mistake, Mistake]:
        """Return a mistake twice: certain if simulated time proves it, and as what is likely.

        Args:
            key: The key.
            likely: Recognizes the mistake.
            sure: Recognizes it where chance has no part; by default as ``likely``.
        """

        def proven(evidence: Evidence) -> Advice | None:
            told = (sure or likely)(evidence) if self._is_proven(evidence) else None
            return None if told and told.key in BY_A_THREAD else told

        return Mistake(key, proven, certain=True), Mistake(key, likely)

    def _is_proven(self, evidence: Evidence) -> bool:
        noted, due = evidence.main.of("noted"), self.expected(evidence).of("noted")
        # A right node that is slow in real time is cut short in simulated time, perhaps at the step of a wrong one.
        is_cut = len(noted) < len(due)
        return not (is_cut or self._is_timed or any(event.sim is None for event in noted))

    def _runs(self, evidence: Evidence) -> list[Part]:
        """Return the runs that may show what the subject does; none if it did nothing, or what is right."""
        mine = evidence.main
        if not mine.of("noted") or self._agree(mine, self.expected(evidence)):
            return []
        # In real time a node may say the same once more or less, so what it did in simulated time comes first.
        return [*([evidence.before.main] if evidence.before else []), mine]

    def _same_as_a_variant(self, evidence: Evidence) -> Advice | None:
        for run, variant in product(self._runs(evidence), evidence.reference.variants):
            part = next((part for part in variant.parts if part.name == run.name), None)
            if part and self._agree(run, part) and self._agree(part, run):
                return Advice(variant.text, variant.next_step, key=variant.key)
        return None

    def _on_another_clock(self, evidence: Evidence) -> Advice | None:
        told = on_another_clock(self._outputs, evidence.main, self.expected(evidence))
        # A mutant that does the same by the robot's clock is not a matter of the clock.
        by_another = self._same_as_mutants(evidence) if told else None
        return None if by_another and by_another.key != KEY else told

    def _agree(self, seen: Part, expected: Part) -> bool:
        made, due = ([e.data["made"] for e in part.of("noted", ENDPOINTS)] for part in (seen, expected))
        # The rate of a recorded answer is not known, because a recording keeps no messages.
        compared = [output for output in self._outputs if output.kind is not Kind.RATE]
        return made == due and all(output.compared(seen, expected).passed for output in compared)

    def _same_as_mutants(self, evidence: Evidence, *, surely: bool = False) -> Advice | None:
        mutants = evidence.reference.mutants
        if mutants is None:
            return None
        for run, due in self._with_practice(evidence):
            apart = differences(self._outputs, run, due)
            # Why a node says nothing at all, other mistakes say.
            if not apart.is_whole or run.traceback or self._is_silent(run, due):
                continue
            found = meanings_of(mutants, apart, self._outputs[0].tolerance)
            whole = self._effects(run, due)
            if whole and mutant_words.are_of_several_kinds(found):
                continue
            told = mutant_words.advice(found, mutants)
            if told and whole and told.key == EXCHANGED:
                continue
            if told and whole and whole.is_once and told.key == KEPT:
                # Which condition or value it is, the mutants only guess.
                told = replace(told, text=whole.text)
            # One level of a ladder may be all that tells another number. But a busy machine may lose one step, too.
            if told and (apart.tells or (mutant_words.is_one_limit(found) and not surely)):
                where = first_apart(self._outputs, run, due)
                return replace(told, text=f"{told.text} {where}".rstrip())
        return None

    def _is_silent(self, run: Part, due: Part) -> bool:
        """Return True if there is nothing at all of an output of the solution."""
        return any(
            not any(rows(output, run).values()) and any(rows(output, due).values())
            for output in self._outputs
            if output.kind is not Kind.RATE
        )

    def _with_practice(self, evidence: Evidence) -> Iterator[tuple[Part, Part]]:
        """Yield each run in a practice drawing, with the solution's in the same one."""
        mutants = evidence.reference.mutants
        practice = {part.name: part for part in mutants.solution} if mutants else {}
        for run in self._runs(evidence):
            if run.name in practice:
                yield run, practice[run.name]

    def _effect(self, evidence: Evidence) -> Advice | None:
        """Return what is wrong with a whole output; None if no single sentence is true of it."""
        for run, due in self._whole_runs(evidence):
            if self._effects(run, due):
                return self._located(evidence)
        return None

    def _effects(self, run: Part, due: Part) -> Effect | None:
        told = (effect(one, rows(one, run), rows(one, due)) for one in self._outputs)
        return next(filter(None, told), None)

    def _located(self, evidence: Evidence) -> Advice | None:
        """Return the step at which the run leaves the solution's."""
        mutants, due = evidence.reference.mutants, self.expected(evidence)
        runs = [run for run in self._runs(evidence) if run.name == due.name and run.of("noted")]
        mine = next((run for run in runs if not self._agree(run, due)), None)
        if mine is None:
            return None
        near = ""
        if mutants is not None:
            apart = differences(self._outputs, mine, due)
            quotes = {one.quote for one in meanings_of(mutants, apart, self._outputs[0].tolerance)} - {""}
            near = quotes.pop() if len(quotes) == 1 else ""
        told = located(self._outputs, mine, due, self.law, near)
        is_right_there = any(
            run.name != mine.name and self._agree(run, practice)
            for run, practice in self._with_practice(evidence)
        )
        return replace(told, text=f"{RIGHT_THERE} {told.text}") if told and is_right_there else told

    def _whole_runs(self, evidence: Evidence) -> Iterator[tuple[Part, Part]]:
        due = self.expected(evidence)
        for run in self._runs(evidence):
            is_whole = run.name == due.name and differences(self._outputs, run, due).is_whole
            if is_whole and not self._is_silent(run, due):
                yield run, due
