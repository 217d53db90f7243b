"""The comparison of two commits: what counts as a difference, and a short run over two real ones."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import pytest

from autograder.verdict import CriterionResult, Diagnosis, State, Verdict
from tests.copies import copied
from tests.measure import __main__ as measure
from tests.measure import compare

if TYPE_CHECKING:
    from pathlib import Path

    from tests.measure.compare import Outcomes

ALWAYS: Outcomes = {"answer": {"1": "passed", "2": "passed"}}
WAVERS: Outcomes = {"answer": {"1": "passed", "2": "failed"}}
OTHERS: Outcomes = {"answer": {"1": "failed", "2": "failed"}}


@pytest.mark.parametrize(
    ("first", "second", "differs"),
    [(ALWAYS, OTHERS, True), (ALWAYS, WAVERS, True), (WAVERS, ALWAYS, False), (ALWAYS, {}, False)],
)
def test_what_the_first_commit_never_said_is_a_difference(
    first: Outcomes, second: Outcomes, differs: bool
) -> None:
    doubtful = compare.unlike(first, second)
    assert bool(compare.differing(first, second, doubtful)) is differs


def test_an_answer_that_is_gone_is_a_difference_and_a_new_one_is_none(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert compare.told({}, ALWAYS, [])
    assert not compare.told(ALWAYS, {}, [])
    assert "answer: gone" in capsys.readouterr().out


def test_points_criteria_and_diagnosis_are_compared_and_texts_where_asked_for() -> None:
    rate = CriterionResult("rate", "", 3, False, "", "")
    found = Verdict(
        "x.y", "", State.FAILED, 7, 10, (rate,), Diagnosis("wrong_rate", "Every 3 s: no", "Mend 2")
    )
    assert compare.outcome(found, texts=False) == "failed 7/10 [rate] wrong_rate"
    told = "failed 7/10 [rate] wrong_rate: Every # s: no | Mend #"
    assert compare.outcome(found, texts=True) == told


@pytest.mark.parametrize("words", [["HEAD"], ["HEAD", "HEAD", "--seeds", "no"]])
def test_bad_usage_is_told(words: list[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        measure.main(["compare", *words])
    assert ended.value.code == 2


def test_two_commits_are_judged_each_by_its_own_judge(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    course = tmp_path / "course"
    for folder in ("autograder", "solutions"):
        copied(compare.ROOT / folder, course / folder)

    def commit(words: str) -> None:
        git = ["git", "-c", "user.name=x", "-c", "user.email=x", "-c", "core.hooksPath=/dev/null"]
        for command in (["init", "-q"], ["add", "-f", "."], ["commit", "-q", "-m", words]):
            subprocess.run([*git, *command], cwd=course, check=True)

    commit("before")
    exercise = course / "solutions" / "01_ros2_fundamentals" / "lab_1_2" / "talker.py"
    exercise.write_text(exercise.read_text(encoding="utf-8") + WORTH_MORE, encoding="utf-8")
    commit("another point")
    monkeypatch.setattr(compare, "ROOT", course)
    answers = ["lab_1_2.talker/right/usual.py", "lab_1_3.server/right/module_level_lambda.py"]
    assert measure.main(["compare", "HEAD~1", "HEAD", *answers, "--seeds", "1"]) == 1
    said = capsys.readouterr().out
    assert "lab_1_2.talker/right/usual.py: differs" in said
    assert "times passed 10/10 []" in said
    assert "times passed 11/11 []" in said
    assert "2 answers compared, 1 differ, none gone" in said
    assert not list((course / ".git").glob("worktrees/*"))
    assert measure.main(["compare", "HEAD", "nonsense"]) == 2
    assert "no work tree of nonsense can be made" in capsys.readouterr().err


WORTH_MORE = """
from dataclasses import replace

_first, *_others = EXERCISE.criteria
EXERCISE = replace(EXERCISE, criteria=(replace(_first, points=_first.points + 1), *_others))
"""
