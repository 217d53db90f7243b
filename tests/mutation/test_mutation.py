"""What mutants are made, what they are called, and how they are counted; a sample of them is judged."""

from __future__ import annotations

import ast
import fnmatch
import os
import subprocess
import sys
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import msgspec
import pytest

from autograder import exercises
from autograder.authoring.mutants.operators import PYTHON
from autograder.verdict import State
from tests.cases import cases
from tests.mutation import equivalents
from tests.mutation.given_code import given_lines
from tests.mutation.line_operators import LINES
from tests.mutation.mutants import Mutant, mutants, sampled
from tests.mutation.report import Report, report
from tests.mutation.results import Result, keep, kept
from tests.mutation.subjects import Subject, subjects

if TYPE_CHECKING:
    from pathlib import Path

    from autograder.authoring.answer_bank import Answer

TALKER = cases(__file__, "TALKER")
SUBJECT = Subject("exercise_1_2.three_ints", "made_up.py", TALKER)


@cache
def everything() -> tuple[Mutant, ...]:
    return tuple(mutant for subject in subjects() for mutant in mutants(subject))


def made_by(operator: str, subject: Subject = SUBJECT) -> list[str]:
    """What stands on the changed lines of the mutants that an operator makes."""
    return [
        "\n".join(line[1:].strip() for line in mutant.difference().splitlines() if line.startswith("+"))
        for mutant in mutants(subject)
        if mutant.operator == operator
    ]


def test_edits_stand_in_their_place_behind_files_that_are_removed() -> None:
    text = f"=== src/old.py (removed)\n=== src/older.py (removed)\n=== src/talker.py\n{TALKER}"
    workspace = Subject("lab_1_2.programs", "made_up.workspace", text, listed=any_listed())
    assert made_by("endpoint_name", workspace) == made_by("endpoint_name")


def any_listed() -> Answer:
    return next(subject.listed for subject in subjects() if subject.listed is not None)


def test_a_mutant_differs_in_one_small_thing() -> None:
    assert made_by("endpoint_name") == [
        "publisher = node.create_publisher(String, 'chatte', 10)",
        "publisher = node.create_publisher(String, '~/chatter', 10)",
    ]
    assert "node.create_timer(0.4, say)" in made_by("number")
    assert made_by("hardly_spun") == ["__import__('rclpy').spin_once(node)"]
    assert 'publisher.publish(String(date=f"Hello {word}"))' in made_by("field_name")
    assert made_by("only_once") == ['for word in list(("é", "b"))[:1]:']


def test_no_two_mutants_mean_the_same_and_none_means_the_original() -> None:
    for subject in subjects():
        found = mutants(subject)
        assert len({mutant.text for mutant in found} | {subject.text}) == len(found) + 1
        if subject.answer.endswith(".py"):
            meanings = {ast.dump(ast.parse(mutant.text)) for mutant in found}
            assert len(meanings | {ast.dump(ast.parse(subject.text))}) == len(found) + 1


def test_an_unrelated_edit_leaves_the_ids_as_they_are() -> None:
    other = replace(
        SUBJECT, text=TALKER.replace('"""Right."""', '"""Right, and said better."""\n# A comment.\n')
    )
    assert [mutant.id for mutant in mutants(other)] == [mutant.id for mutant in mutants(SUBJECT)]


def test_what_a_notebook_has_before_a_task_is_not_changed() -> None:
    text = """
class Hands(Node):
    def __init__(self) -> None:
        self.declare_parameter("max_turn", 1.0, within(0.0, 2.0))
        self.watchdog = self.create_timer(0.5, self.on_silence)

class OtherHands(Node):
    def __init__(self) -> None:
        self.declare_parameter("max_turn", 1.0, within(0.0, 2.0))
"""
    given = given_lines("lab_2_2.watchdog", text)
    named = [
        number for number, line in enumerate(text.splitlines(), 1) if "self." in line and number in given
    ]
    assert named == [4]
    # A task that comes first has nothing before it, and one about files no class.
    assert not given_lines("lab_1_1.hello", text)


def test_every_operator_makes_something() -> None:
    names = {operator.__name__ for operator in PYTHON} | {operator.__name__ for operator in LINES}
    assert {mutant.operator for mutant in everything()} == names


def test_ids_are_unique_and_every_exercise_has_its_mutants() -> None:
    found = everything()
    assert len({mutant.id for mutant in found}) == len(found)
    # A repair is judged by another exercise, whose answers have the mutants.
    assert {mutant.exercise for mutant in found} == {
        one.id for one in exercises.unbroken() if not one.hides_causes
    }


def test_every_equivalent_is_still_made() -> None:
    ids = [mutant.id for mutant in everything()]
    assert [form for form in equivalents.table() if not fnmatch.filter(ids, form)] == []
    assert all(why for why in equivalents.table().values())


def test_a_sample_is_the_same_each_time_and_takes_from_every_exercise() -> None:
    found = list(everything())
    sample = sampled(found, 60, 0)
    assert sample == sampled(list(reversed(found)), 60, 0)[::-1]
    assert {mutant.exercise for mutant in sample} == {mutant.exercise for mutant in found}
    assert len(sampled(found, 60, 0) + sampled(found, 60, 1)) == 120
    assert sampled(found, 60, 1) != sample
    # Without one mutant most of the sample is as it was.
    rest = [mutant for mutant in found if mutant != sample[0]]
    assert set(sample) - set(sampled(rest, 60, 0)) == {sample[0]}


def result(mutant: Mutant, state: State, *, diagnosis: str = "", seed: str = "0") -> Result:
    return Result(mutant.id, mutant.digest, seed, state, 0.0, diagnosis, 1.0)


def test_killed_survived_equivalent_and_not_checked_are_different_things(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first, second, third, fourth, fifth = mutants(SUBJECT)[:5]
    monkeypatch.setattr(equivalents, "table", lambda: {third.id: "it is right", fifth.id: "said to be right"})
    found = report(
        9,
        [first, second, third, fourth, fifth],
        [
            result(first, State.FAILED, diagnosis="topic_name"),
            result(second, State.FAILED, diagnosis="crashed"),
            result(second, State.PASSED, seed="1"),
            result(third, State.PASSED),
            result(fourth, State.NOT_CHECKED),
            result(fifth, State.FAILED, diagnosis="crashed"),
        ],
    )
    total = found.total
    counts = (total.killed, total.told, total.survived, total.equivalent, total.not_checked)
    assert counts == (2, 1, 1, 1, 1)
    assert total.share == pytest.approx(2 / 3)
    assert [(survivor.id, survivor.seeds, survivor.caught) for survivor in found.survivors] == [
        (second.id, ("1",), 1)
    ]
    assert found.caught_equivalents == (fifth.id,)


def test_a_run_goes_on_with_what_is_kept(tmp_path: Path) -> None:
    first, second = mutants(SUBJECT)[:2]
    file = tmp_path / "results"
    assert kept(file, [first, second]) == []
    keep(result(first, State.FAILED), file)
    keep(result(second, State.PASSED), file)
    changed = replace(second, text=second.text + "\n")
    assert [one.id for one in kept(file, [first, changed])] == [first.id]


OPERATORS = ("endpoint_name", "message_type", "field_name", "qos", "answer", "hardly_spun", "not_awaited")
SAMPLE = (*(f".py:{operator}:" for operator in OPERATORS), "--sample", "30", "--seed", "0")
"""Quick ones: with an error in what others see of them."""


@pytest.mark.ros
@pytest.mark.slow
def test_a_sample_of_mutants_is_caught() -> None:
    """Where one survives that does what the task asks for, enter it in equivalent.toml; else mend the exercise."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.measure", "mutants", *SAMPLE, "--jobs", "6", "--json"],
        capture_output=True,
        text=True,
        check=False,
        env={name: value for name, value in os.environ.items() if name != "ROS_PYTHON_CHECK_FIELDS"},
    )
    assert done.stdout, done.stderr
    found = msgspec.json.decode(done.stdout, type=Report)
    assert [(survivor.id, survivor.difference) for survivor in found.survivors] == []
    assert found.caught_equivalents == ()
    assert found.total.not_checked == 0
    assert found.total.killed >= 25
