"""``try-exercise``: compares the judge's verdicts on right and wrong answers with what their author expects."""

from __future__ import annotations

import textwrap
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder import exercises
from autograder.authoring import reference_files
from autograder.authoring.answer_bank import Answer, Turn, answers, answers_folder, judge_all, warm_up
from autograder.authoring.answer_tables import BadTable, CannotEdit
from autograder.authoring.author_texts import author_text
from autograder.authoring.exercise_faults import still_to_do, to_do_in_text
from autograder.authoring.mutants import recorded_mutants
from autograder.authoring.mutants.survey import survey, survey_by_judge
from autograder.authoring.mutants.survey_lines import lines
from autograder.authoring.mutants.trials import NotOnPaper
from autograder.authoring.tried_answers import SLOW_STEP, TriedAnswer
from autograder.cards.text_rendering import card_text
from autograder.command_name import COMMAND
from autograder.judge import evidence_files
from autograder.kit.model import UNKNOWN
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from autograder.kit.model import Exercise
    from autograder.verdict import Verdict


JOBS = 4
"""The default number of answers to judge at the same time. It may exceed the number of cores, because judging mostly
waits.
"""


NAMED, LOCATED, NEITHER = "named", "located", "neither"
"""How the card of a wrong answer tells the mistake: by its cause or effect, by the moment of the run, or not at all."""


class NothingToTry(LookupError):
    """No answer has the requested name. The message lists the answers that exist, or says where to write one."""


@dataclass(frozen=True)
class _Surprise:
    """An answer whose verdict differs from what its author expects.

    Attributes:
        name: The name of the answer, such as ``"wrong/counter_stuck.py"``.
        objection: The difference, in words.
        card: The card that a student would see.
    """

    name: str
    objection: str
    card: str


def try_exercise(
    exercise: Exercise,
    *,
    only: Sequence[str] = (),
    jobs: int = JOBS,
    repeat: int = 1,
    transcript: Path | None = None,
    tell: Callable[[str], object],
) -> bool:
    """Try an exercise: check its recording, judge the answers, and print surprises and what is left to do.

    Edits that do not fit are reported before anything runs. A missing reference output is recorded. If the stored
    reference output differs from a new recording, it stays unchanged, and no answer is judged until the author has
    decided. The notebook as students get it must earn no points.

    Args:
        exercise: The exercise.
        only: Only answers whose name contains one of these texts are judged; all answers if empty.
        jobs: The number of answers to judge at the same time.
        repeat: The number of times to judge each answer, each time with different random inputs.
        transcript: The folder for the evidence of each answer from its last run; None to write none.
        tell: Called with each line or card for the author.

    Returns:
        True if everything is as the author expects.

    Raises:
        autograder.authoring.answer_tables.BadTable: A table of the exercise's answers cannot be used.
        autograder.authoring.reference_files.CannotRecord: The master's solution cannot be recorded.
        NothingToTry: No answer has one of the requested names.
    """
    wanted: Sequence[Answer] = _chosen(exercise, only)
    _refuse_edits_that_do_not_fit(wanted)
    is_stored = exercises.reference_path(exercise.id).exists()
    if not (only and is_stored) and not _is_recorded(exercise, is_stored, tell):
        return False
    # `only` asks about single answers, so whatever concerns the whole exercise is left out.
    gifts = [] if only else list(_of_unsolved(exercise, wanted))
    wanted = [TriedAnswer(**vars(answer), folder=transcript) for answer in wanted]
    told: Counter[str] = Counter()
    surprises = _judged(wanted, jobs=jobs, repeat=repeat, tell=tell, told=told)
    for surprise in surprises:
        tell(f"\n{surprise.name}: {surprise.objection}\n{textwrap.indent(surprise.card, '    ')}")
    times = f", each judged {repeat} times" if repeat > 1 else ""
    count = f"{len(wanted)} answer{'s' * (len(wanted) != 1)}{times}"
    tell(f"\n{count}, {len(surprises) or 'none'} not as expected")
    if told:
        how = ", ".join(f"{told[word]} {word}" for word in (NAMED, LOCATED, NEITHER))
        tell(f"cards of wrong answers: {how}")
    for line in gifts:
        tell(f"the unsolved notebook {line}")
    # With a part of the answers, what the bank lacks cannot be told.
    for line in to_do_in_text(exercise) if only else still_to_do(exercise, wanted):
        tell(f"to do: {line}")
    is_kept = bool(only) or evidence_files.load_reference(exercise.id).mutants is not None
    if not only:
        tell(f"{exercise.id}: trying mutants of the solution, which can take some minutes")
    is_ready = bool(only) or try_mutants(exercise, keeps=not is_kept, tell=tell)
    return is_ready and not surprises and not gifts


def try_mutants(
    exercise: Exercise,
    *,
    by_judge: int = 0,
    must_be_recorded: bool = True,
    keeps: bool = False,
    tell: Callable[[str], object],
) -> bool:
    """Run the mutants of an exercise's solution, and print which of them its drawings do not tell.

    Args:
        exercise: The exercise.
        by_judge: If the mutants cannot be run on paper: how many of them the judge checks at the same time; 0 for none.
        must_be_recorded: False if the drawings may differ from the recorded ones.
        keeps: True to write beside the reference output what they do, for the cards of students who do the same.
        tell: Called with each line for the author.

    Returns:
        False if a mutant passes that may not.
    """
    warm_up()
    try:
        found = survey(exercise, must_be_recorded=must_be_recorded)
    except NotOnPaper as why:
        if not by_judge:
            tell(f"{exercise.id}: no mutants on paper: {why}")
            return True
        try:
            found = survey_by_judge(exercise, jobs=by_judge)
        except NotOnPaper as no_mutants:
            tell(f"{exercise.id}: no mutants: {no_mutants}")
            return True
    if keeps and found.practice:
        recorded_mutants.write(exercise, found)
    for line in lines(found):
        tell(line)
    return found.is_ready


def _chosen(exercise: Exercise, only: Sequence[str] = ()) -> list[Answer]:
    """Return the answers to an exercise, in the order in which answers.toml lists them.

    Args:
        exercise: The exercise.
        only: Texts. An answer is returned if its name contains one of them; every answer is, if there are no texts.

    Raises:
        NothingToTry: No answer has a name with one of these parts.
    """
    found = list(answers([exercise.id]))
    if not found and exercise.enough:
        raise NothingToTry(
            author_text("no_answers", exercise=exercise.id, folder=answers_folder(exercise.id))
        )
    wanted = [answer for answer in found if not only or any(part in answer.short_name for part in only)]
    if found and not wanted:
        known = ", ".join(answer.short_name for answer in found)
        wanted_names = " or ".join(only)
        raise NothingToTry(
            author_text("no_such_answer", exercise=exercise.id, wanted=wanted_names, known=known)
        )
    return wanted


def how_told(verdict: Verdict) -> str:
    """Return whether a card names the mistake, or only says where in the run it shows; empty for a pass."""
    if verdict.diagnosis is None:
        return ""
    if verdict.diagnosis.key != UNKNOWN:
        return NAMED
    # The words about a moment of the run do not begin with the title of a criterion.
    return NEITHER if verdict.diagnosis.text.startswith("“") else LOCATED


def _judged(
    wanted: Sequence[Answer],
    *,
    jobs: int = JOBS,
    repeat: int = 1,
    tell: Callable[[str], object],
    told: Counter[str],
) -> list[_Surprise]:
    """Judge answers, and print each result.

    Args:
        wanted: The answers to judge.
        jobs: The number of answers to judge at the same time.
        repeat: The number of times to judge each answer, with different random inputs.
        tell: Called with a line for each result.
        told: Counts how the cards of wrong answers tell the mistake.

    Returns:
        The answers with an unexpected verdict, in the given order. Each is returned once, with its first unexpected
        verdict.
    """
    turns = [Turn(answer, f"try {lap}" if lap else "try") for lap in range(repeat) for answer in wanted]
    surprises: dict[str, _Surprise] = {}
    done = 0

    def take(turn: Turn[Answer], verdict: Verdict) -> None:
        nonlocal done
        done += 1
        answer, objection = turn.subject, turn.subject.objection(verdict)
        sign, points = ("✗" if objection else "✓"), f"{verdict.score:g} of {verdict.max_score:g}"
        key = verdict.diagnosis.key if verdict.diagnosis else ""
        if how := how_told(verdict):
            told[how] += 1
            key = f"{key}: {how}"
        tell(f"{done:>3}/{len(turns)} {sign} {answer.short_name:<40} {points:>8}  {key}".rstrip())
        for remark in verdict.remarks:
            if remark.startswith(SLOW_STEP):
                tell(f"        {verdict.seconds:.0f} s; {remark}")
        if objection:
            surprises.setdefault(answer.name, _Surprise(answer.short_name, objection, card_text(verdict)))

    def fail(turn: Turn[Answer], trouble: str) -> None:
        nonlocal done
        done += 1
        name = turn.subject.short_name
        tell(f"{done:>3}/{len(turns)} ✗ {name:<40} no verdict")
        surprise = _Surprise(name, f"no verdict: {trouble}", "The error stands above.")
        surprises.setdefault(turn.subject.name, surprise)

    # Each answer is judged in a fork of this process, which would have to import everything itself.
    warm_up()
    judge_all(turns, jobs=jobs, done=take, failed=fail)
    return [surprises[answer.name] for answer in wanted if answer.name in surprises]


def _refuse_edits_that_do_not_fit(wanted: Sequence[Answer]) -> None:
    """Unpack each answer once, to find edits that do not fit their bases.

    Raises:
        BadTable: An edit does not fit its base. The message has a line for each such edit.
    """
    troubles = []
    for answer in wanted:
        with HeldFolder("autograder-answer-") as folder:
            try:
                answer.unpack(folder.path)
            except BadTable as error:
                troubles.append(str(error))
            except CannotEdit as error:
                troubles.append(f"{answer.short_name}: the edit does not fit: {error}")
    if troubles:
        raise BadTable("\n".join(troubles))


def _of_unsolved(exercise: Exercise, listed: Sequence[Answer]) -> Iterator[str]:
    """Yield what is wrong with a notebook as students get it: a criterion that it meets, or an unexpected failure."""
    verdict = reference_files.unsolved(exercise)
    for one in verdict.criteria if verdict is not None else ():
        if one.passed:
            yield author_text("earns_points", points=one.points, title=one.title)
    key = verdict.diagnosis.key if verdict is not None and verdict.diagnosis is not None else "no diagnosis"
    is_repair = exercise.hides_causes and exercise.enough
    if is_repair and not any(key in answer.diagnoses for answer in listed):
        yield author_text("fails_otherwise", key=key)


def _is_recorded(exercise: Exercise, is_stored: bool, tell: Callable[[str], object]) -> bool:
    """Return True if the stored reference output equals a new recording. If none is stored, store the new one."""
    changed = reference_files.record([exercise], only_check=is_stored, tell=tell)
    if not (is_stored and changed):
        return True
    tell(author_text("not_recorded", command=COMMAND, exercise=exercise.id))
    return False
