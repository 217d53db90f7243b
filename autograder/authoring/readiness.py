"""Lists for an author the faults of an exercise that the project's tests and linters would report."""

from __future__ import annotations

import os
import re  # noqa: TID251  (not what a student handed in)
import subprocess
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course, exercises
from autograder.authoring.house_rules import broken_rules
from autograder.masters.source import named_cells
from environment.installation import installing
from environment.python_child import installed_program

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.authoring.answers import Answer
    from autograder.kit.model import Exercise

ENOUGH = {"right": 5, "wrong": 8}
"""The minimum numbers of right and wrong answers that an exercise needs in the bank. An exercise with fewer answers
works, but its author cannot know whether its verdicts are fair.
"""
MISTAKES = "docs/mistakes.md"
"""The page that explains each diagnosis to students. The key of the diagnosis is the heading of its paragraph."""
_PACKAGE = Path(course.__file__).resolve().parents[1]
_SETTINGS = _PACKAGE / "pyproject.toml"


def still_to_do(exercise_id: str, listed: Sequence[Answer]) -> Iterator[str]:
    """Yield a line for each thing that an exercise still lacks before it can be committed.

    Args:
        exercise_id: The exercise's id, such as ``"lab_1_2.talker"``.
        listed: All answers to the exercise in the bank.

    Raises:
        autograder.exercises.UnknownExercise: The exercise does not exist.
        autograder.exercises.BrokenExercise: The exercise's file is not a valid exercise.
        autograder.masters.master_errors.MasterError: The lab's master cannot be used.
    """
    yield from _of_answers(listed)
    yield from _of_mistakes(exercise_id, listed)
    lab = exercises.path(exercise_id).parent
    yield from _of_text(exercise_id, lab / course.LAB)
    yield from (f"{course.LAB}: {rule}" for rule in broken_rules(lab / course.LAB))
    yield from _of_linters(lab)


def _of_answers(listed: Sequence[Answer]) -> Iterator[str]:
    there = Counter(answer.file.parent.name for answer in listed)
    few = [f"{there[kind]} {kind}" for kind, enough in ENOUGH.items() if there[kind] < enough]
    if few:
        yield (
            f"answers: the bank has only {' and '.join(few)} answers; before students get a new exercise, write at "
            f"least {ENOUGH['right']} right answers in different styles and {ENOUGH['wrong']} wrong answers"
        )
    for answer in listed:
        if answer.diagnoses and not answer.file.name.startswith(answer.diagnoses[0]):
            yield (
                f"answers: rename {answer.short_name}, so that its name begins with its diagnosis, "
                f"{answer.diagnoses[0]}"
            )


def _of_mistakes(exercise_id: str, listed: Sequence[Answer]) -> Iterator[str]:
    page = course.root() / MISTAKES
    if page.is_file():
        told = set(re.findall(r"^### `(\w+)`$", page.read_text(encoding="utf-8"), re.MULTILINE))
        used = {mistake.key for mistake in exercises.get(exercise_id).mistakes}
        used |= {key for answer in listed for key in answer.diagnoses}
        yield from (f"{MISTAKES}: no paragraph about `{key}` yet" for key in sorted(used - told))


def _of_text(exercise_id: str, master: Path) -> Iterator[str]:
    """Yield a line for each fault in ``Exercise.text``, which maps sentences of the lab to criteria."""
    exercise = exercises.get(exercise_id)
    if not exercise.text:
        yield "text: map words of the task to the criteria that judge them (the argument text of the exercise)"
        return
    said = "\n".join(one.cell.source for one in named_cells(master))
    yield from (f"text: {fault}" for fault in faults_of_text(exercise, said))


def faults_of_text(exercise: Exercise, said: str) -> Iterator[str]:
    """Yield the faults of ``Exercise.text``: sentences that the lab does not contain, missing or unknown criteria.

    Args:
        exercise: The exercise.
        said: All texts of the lab, in one string.
    """
    whole = " ".join(said.split())
    sentences = (" ".join(words.split()) for words in exercise.text)
    yield from (f"{course.LAB} does not say “{words}”" for words in sentences if words not in whole)
    judged = {name for names in exercise.text.values() for name in names.split()}
    known = {criterion.name for criterion in exercise.criteria}
    yield from (
        f"the criterion {name} is not mapped to any words of the task" for name in sorted(known - judged)
    )
    yield from (f"the criterion {name} does not exist" for name in sorted(judged - known))


def _of_linters(lab: Path) -> Iterator[str]:
    """Yield what ruff and mypy report about a lab's files, and a line for each linter that is not installed."""
    if not _SETTINGS.is_file():
        return
    programs = {name: installed_program(name) for name in ("ruff", "mypy")}
    for name, program in programs.items():
        if not program.is_file():
            yield f"{name}: not installed, so nothing was checked. Type: {installing('dev', clone='--tests')}"
    files = [str(file) for file in sorted(lab.glob("*.py"))]
    for name, *words in (
        ("ruff", "check", "--quiet", "--output-format=concise", f"--config={_SETTINGS}"),
        ("ruff", "format", "--check", "--quiet", f"--config={_SETTINGS}"),
        ("mypy", "--no-error-summary", f"--config-file={_SETTINGS}"),
    ):
        if programs[name].is_file():
            done = subprocess.run(
                [programs[name], *words, *files],
                cwd=_PACKAGE,
                env=os.environ | {"MYPYPATH": str(lab.parent)},
                capture_output=True,
                text=True,
                check=False,
            )
            if words[0] == "format" and done.returncode == 1:  # ruff's output would be a long diff
                yield f"ruff: a file is not formatted. Type: {programs[name]} format --config={_SETTINGS} {lab}"
            else:
                yield from (f"{name}: {line}" for line in (done.stdout + done.stderr).splitlines())
