"""On paper, the solution does what the judge has recorded, and a mutant is told by the drawings that can tell it."""

from __future__ import annotations

import pytest

from autograder import exercises
from autograder.authoring.mutants import blind_answers
from autograder.authoring.mutants.solutions import solution
from autograder.authoring.mutants.survey import own_mutants
from autograder.authoring.mutants.trials import NotOnPaper, paper_task, run_all
from autograder.judge import evidence_files
from tests.authoring.mutants.made_up import BRAKE, SOLUTION, by_habit, by_levels, task
from tests.cases import named_cases

pytestmark = pytest.mark.ros

ON_PAPER = [one.id for one in exercises.unbroken() if one.is_drawn and not one.hides_causes]
ACTIONS = [one for one in ON_PAPER if "action_server" in exercises.get(one).roles]


@pytest.mark.parametrize("exercise_id", [one for one in ON_PAPER if one not in ACTIONS])
def test_each_solution_is_on_paper_what_the_judge_has_recorded(exercise_id: str) -> None:
    found = solution(exercise_id)
    assert found is not None
    recorded = evidence_files.load_reference(exercise_id)
    done = paper_task(exercises.get(exercise_id), recorded, found.text, found.root, fresh=1)
    assert done.practice == tuple(part.name for part in recorded.parts)


def test_an_action_is_left_to_the_judge() -> None:
    found = solution(ACTIONS[0])
    assert found is not None
    with pytest.raises(NotOnPaper, match=r"bench\.call_action"):
        paper_task(
            exercises.get(ACTIONS[0]), evidence_files.load_reference(ACTIONS[0]), found.text, found.root
        )


def test_a_solution_that_is_not_as_recorded_is_left_to_the_judge() -> None:
    found = solution("lab_1_2.wall")
    assert found is not None
    other = found.text.replace("0.5", "0.4")
    assert other != found.text
    recorded = evidence_files.load_reference("lab_1_2.wall")
    with pytest.raises(NotOnPaper, match="/cmd_vel"):
        paper_task(exercises.get("lab_1_2.wall"), recorded, other, found.root)


def passed(of: str, drawn: str) -> list[bool]:
    gives = {"habit": by_habit, "levels": by_levels}[drawn]
    ((_, runs),) = run_all(task(gives), [("", of)])
    return [run.passed for run in runs]


def test_only_a_drawing_near_the_limit_tells_a_wrong_limit() -> None:
    wrong = BRAKE.replace("0.8", "0.88")
    assert passed(wrong, "habit") == [True] * 5
    assert passed(wrong, "levels") == [False] * 5


@pytest.mark.parametrize("change", named_cases(__file__, "a_program_that_does_not_work_passes_nowhere"))
def test_a_program_that_does_not_work_passes_nowhere(change: tuple[str, str]) -> None:
    wrong = BRAKE.replace(*change, 1)
    assert wrong != BRAKE
    assert not any(passed(wrong, "habit"))


def test_who_counts_passes_by_habit_and_who_knows_by_heart_passes_practice_alone() -> None:
    runs = {}
    for gives in (by_habit, by_levels):
        one = task(gives)
        made = list(blind_answers.blind_answers(one))
        for mutant, found in run_all(one, [(mutant, mutant.text) for mutant in made]):
            runs[gives.__name__, mutant.kind] = [run.passed for run in found]
    practice, fresh = [True] * 2, [True] * 3
    assert runs["by_habit", blind_answers.COUNTS] == practice + fresh
    assert runs["by_habit", blind_answers.BY_HEART] == practice + [False] * 3
    assert not any(runs["by_levels", blind_answers.COUNTS][2:])
    assert not any(runs["by_levels", blind_answers.USUAL])


def test_mutants_are_made_of_the_students_lines_alone() -> None:
    lines = {mutant.line for mutant in own_mutants(SOLUTION)}
    first = BRAKE[: SOLUTION.own[0][0]].count("\n") + 1
    assert lines
    assert min(lines) >= first
