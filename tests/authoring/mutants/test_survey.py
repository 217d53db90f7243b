"""An exercise is ready if each mutant that passes has a row that says why it may, and each row is needed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from autograder import exercises
from autograder.authoring import exercise_trial, reference_files
from autograder.authoring.answer_tables import AnswerSettings
from autograder.authoring.mutants import survey
from autograder.cli.author_commands import record, try_exercise
from tests.authoring.mutants.test_trials import ACTIONS, ON_PAPER

if TYPE_CHECKING:
    from autograder.kit.model import Exercise

pytestmark = pytest.mark.ros

EXERCISE = "lab_2_3.asks"
"""One mutant of its solution passes, and may."""
KEY = "seldom:13a3c939"


def tried(monkeypatch: pytest.MonkeyPatch, accepts: dict[str, str]) -> tuple[int, str]:
    """Return the exit code of `try-exercise --mutants`, and what it prints, if these rows stand beside the answers."""
    monkeypatch.setattr(survey, "answer_settings", lambda _: AnswerSettings(accepts=accepts))
    done = CliRunner().invoke(try_exercise, [EXERCISE, "--mutants"])
    return done.exit_code, done.output


def test_a_mutant_that_passes_needs_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    code, said = tried(monkeypatch, {})
    assert (code, KEY in said, "Not ready: draw inputs" in said) == (1, True, True)


def test_a_row_accepts_it(monkeypatch: pytest.MonkeyPatch) -> None:
    code, said = tried(monkeypatch, {"seldom:*": "no question comes twice"})
    assert (code, KEY in said, "Not ready" in said) == (0, False, False)


def test_a_row_that_nothing_needs_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    code, said = tried(monkeypatch, {"seldom:*": "no question comes twice", "number:00000000": "free"})
    assert (code, "accepts number:00000000, which is not made" in said) == (1, True)


@pytest.mark.parametrize("names", [[], [EXERCISE]], ids=["all", "one"])
def test_record_fails_if_an_exercise_is_not_ready(monkeypatch: pytest.MonkeyPatch, names: list[str]) -> None:
    asked: list[str] = []

    def is_ready(exercise: Exercise, **_: object) -> bool:
        asked.append(exercise.id)
        return exercise.id != EXERCISE

    monkeypatch.setattr(reference_files, "record", lambda *_, **__: [])
    monkeypatch.setattr(exercise_trial, "try_mutants", is_ready)
    assert CliRunner().invoke(record, names).exit_code == 1
    assert asked == (names or list(exercises.all_ids()))


@pytest.mark.parametrize("exercise_id", [one for one in ON_PAPER if one not in ACTIONS])
def test_each_exercise_of_the_course_is_ready(exercise_id: str) -> None:
    said: list[str] = []
    assert exercise_trial.try_mutants(exercises.get(exercise_id), tell=said.append), "\n".join(said)
