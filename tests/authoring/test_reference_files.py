"""The reference output follows from the reference solution, and from nothing else."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, cast

import pytest

from autograder import exercises
from autograder.authoring import reference_files
from autograder.authoring.answer_bank import answers
from autograder.kit.recipes.own_scenario import Met
from autograder.verdict import CriterionResult
from tests.cases import cases
from tests.copies import copied
from tests.measure import evidence
from tests.tiers import due

if TYPE_CHECKING:
    from autograder.kit.model import Exercise

ROOT = Path(__file__).parents[2]
INPUTS = "random.sample(range(1001, 99_999), 2)"
OTHER_INPUTS = "random.sample(range(101, 999), 2)"
CHANGED = evidence.exercises_of_another_bench()
LAUNCHED = "project_2.whole"
"""Its programs ask when they have found each other, and until then the robot has waited for longer or shorter."""
RUNS = Counter(answer.exercise for answer in answers() if answer.advice)
"""The wrong answers of an exercise that are recorded beside its solution, five seconds of a processor each."""
MANY = 2
EXERCISES = [
    due(exercise_id, "many-" * (RUNS[exercise_id] > MANY) + exercise_id, exercise_id in CHANGED)
    for exercise_id in exercises.all_ids()
    if exercise_id != LAUNCHED
]
TALKER = cases(__file__, "TALKER")


def _autograder(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "autograder", *words], capture_output=True, text=True, check=False
    )


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize("exercise_id", EXERCISES)
def test_recording_again_gives_the_same_file(exercise_id: str) -> None:
    """What ``./course record --check`` says: nobody has changed inputs or a solution and left the reference behind."""
    done = _autograder("record", "--check", exercise_id)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == f"{exercise_id}: unchanged\n"


@pytest.mark.ros
def test_inputs_that_were_changed_and_not_recorded_again_are_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copied(ROOT / "solutions", tmp_path / "solutions")
    exercise = tmp_path / "solutions" / "01_ros2_fundamentals" / "lab_1_3" / "server.py"
    text = exercise.read_text(encoding="utf-8")
    assert text.count(INPUTS) == 1
    exercise.write_text(text.replace(INPUTS, OTHER_INPUTS), encoding="utf-8")
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path))
    done = _autograder("record", "--check", "lab_1_3.server")
    assert done.returncode == 1, done.stdout + done.stderr
    assert "lab_1_3.server: differs from" in done.stdout


@pytest.mark.ros
def test_a_changed_reference_solution_changes_what_is_expected(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copied(ROOT / "solutions", tmp_path / "solutions")
    master = tmp_path / "solutions" / "01_ros2_fundamentals" / "lab_1_2" / "lab.md"
    text = master.read_text(encoding="utf-8")
    assert '"chatter"' in text
    master.write_text(text.replace('"chatter"', '"gossip"'), encoding="utf-8")
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path))
    recorded = _autograder("record", "lab_1_2.talker")
    assert recorded.returncode == 0, recorded.stderr

    codes = {}
    for topic in ("chatter", "gossip"):
        program = tmp_path / f"{topic}.py"
        program.write_text(TALKER.format(topic=topic), encoding="utf-8")
        codes[topic] = _autograder("check", "lab_1_2.talker", "--", sys.executable, str(program)).returncode
    assert codes == {"chatter": 1, "gossip": 0}


def test_a_master_that_cannot_be_used_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    copied(ROOT / "solutions", tmp_path / "solutions")
    master = tmp_path / "solutions" / "01_ros2_fundamentals" / "lab_1_2" / "lab.md"
    master.write_text(master.read_text(encoding="utf-8").replace("### END SOLUTION", ""), encoding="utf-8")
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path))
    done = _autograder("record", "lab_1_2.talker")
    assert (done.returncode, "lab.md" in done.stderr, "Traceback" in done.stderr) == (2, True, False)


def test_a_solution_without_an_endpoint_that_the_recipe_judges_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    criterion = CriterionResult("lost", "Says lost", 3, False, "lost, 4 times", "lost, 0 times")
    failed = SimpleNamespace(passed=False, criteria=(criterion,))
    report = SimpleNamespace(reference='{"interface": {"subscription": {}}}', verdict=failed, trouble="")
    exercise = SimpleNamespace(id="lab_8_1.dog", roles=("subscription", "publisher"))
    monkeypatch.setattr(reference_files, "program", lambda _: "")
    monkeypatch.setattr(reference_files, "judged", lambda *_, **__: (report, ""))
    with pytest.raises(reference_files.CannotRecord) as raised:
        reference_files.recording(cast("Exercise", exercise))
    said = str(raised.value)
    assert "The solution has no publisher, which this recipe judges." in said
    assert "Says lost: expected lost, 4 times; seen lost, 0 times" in said


def test_a_subject_without_a_topic_was_heard_not_once() -> None:
    assert Met(bench=object(), topics=(), speakers=(), callers=()).heard == 0  # type: ignore[arg-type]


def test_of_many_differences_the_first_are_printed(tmp_path: Path) -> None:
    text = exercises.reference_path("lab_2_1.map").read_text(encoding="utf-8")
    stored = tmp_path / "map.reference.json"
    stored.write_text(text.replace('"step": ', '"step": 1'), encoding="utf-8")
    *first, last = reference_files._different(stored, text, 1e-6)
    assert len(first) == reference_files._DIFFERENCES
    assert last.startswith("and ")
    assert last.endswith(" more differences")
