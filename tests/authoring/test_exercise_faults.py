"""What a new exercise still lacks is told by the name of its rule; the examples break none."""

from __future__ import annotations

import functools
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder import course, exercises
from autograder.authoring import exercise_faults
from autograder.authoring.answer_bank import answers
from autograder.authoring.exercise_faults import broken_rules, still_to_do, unasked_outputs
from autograder.authoring.new_exercise import EXAMPLES, new_exercise, recipes
from autograder.judge import evidence_files
from autograder.masters.source_notebooks import named_cells
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

ID = "lab_9_1.battery"
FOR_ITS_AUTHOR = ("answers: the bank has only ", "text: map words of the task ")
"""What an example leaves to whoever copies it."""


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder of a new exercise, in a course with a page of mistakes; its modules are forgotten behind it."""
    monkeypatch.setenv(course.VARIABLE, str(tmp_path))
    new_exercise(tmp_path, ID, "publisher", chapter="01_first")
    (tmp_path / "docs").mkdir()
    keys = sorted({mistake.key for mistake in exercises.get(ID).mistakes})
    (tmp_path / "docs/mistakes.md").write_text("".join(f"### `{key}`\n" for key in keys))
    yield tmp_path / "solutions/01_first/lab_9_1"
    forget()


def forget() -> None:
    """Have the exercise imported anew, as another process would."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "lab_9_1"]:
        del sys.modules[name]


def told() -> list[str]:
    lines = still_to_do(exercises.get(ID), list(answers([ID])))
    return [line for line in lines if not line.startswith(FOR_ITS_AUTHOR)]


@pytest.mark.parametrize("recipe", recipes())
def test_an_example_keeps_every_rule(recipe: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(course.VARIABLE, str(EXAMPLES))
    example = next(name for name in exercises.all_ids() if name.startswith(f"{recipe}."))
    lines = list(still_to_do(exercises.get(example), list(answers([example]))))
    assert [line for line in lines if not line.startswith(FOR_ITS_AUTHOR)] == []


LEFT = {"lab_2_2.finite": ["endpoints: no criterion asks for /stop"]}
"""What stays to do: that notebook gives its students the red button, and points for it would be for nothing."""


def test_nothing_is_left_to_do_of_the_courses_own_exercises(monkeypatch: pytest.MonkeyPatch) -> None:
    # The exercises of a lab share its text, which is read once.
    monkeypatch.setattr(exercise_faults, "named_cells", functools.cache(named_cells))
    of_a_lab = functools.cache(lambda master: list(broken_rules(master)))
    monkeypatch.setattr(exercise_faults, "broken_rules", of_a_lab)
    left = {
        one: [line for line in still_to_do(exercises.get(one), list(answers([one]))) if not known(one, line)]
        for one in exercises.all_ids()
    }
    assert {one: lines for one, lines in left.items() if lines} == {}


def known(exercise_id: str, line: str) -> bool:
    return line.startswith((*FOR_ITS_AUTHOR, *LEFT.get(exercise_id, ())))


def test_folded_text_does_not_delay_the_first_task(lab: Path) -> None:
    master = lab / "lab.md"
    fold = f"<details>\n<summary>More</summary>\n\n{'Robots ' * 401}\n\n</details>\n\nRobots tell"
    master.write_text(master.read_text().replace("Robots tell", fold, 1))
    assert not [line for line in told() if line.startswith("lab.md")]


def test_a_check_and_a_stop_need_no_sentence_before_them(lab: Path) -> None:
    master = lab / "lab.md"
    text = master.read_text().replace("The judge listens on `battery` while your node spins.\n\n", "", 1)
    master.write_text(text.replace("## Going", "```{code-cell} ipython3\nrobot.stop()\n```\n\n## Going", 1))
    assert not [line for line in told() if line.startswith("lab.md")]


@pytest.mark.parametrize(
    ("file", "old", "new", "rule"),
    [
        *cases(__file__, "a_rule_that_is_broken_is_named"),
        ("lab.md", "Robots tell", "Robots " * 151 + "tell", "lab.md: begin by doing: "),
        ("lab.md", "Robots tell", "Robots " * 401 + "tell", "lab.md: the first task comes soon: "),
    ],
)
def test_a_rule_that_is_broken_is_named(lab: Path, file: str, old: str, new: str, rule: str) -> None:
    text = (lab / file).read_text()
    assert old in text
    (lab / file).write_text(text.replace(old, new, 1))
    forget()
    assert any(line.startswith(rule) for line in told()), told()


def test_a_sentence_may_go_on_in_the_next_line(lab: Path) -> None:
    (lab / "battery.py").write_text(
        (lab / "battery.py").read_text().replace('"every 0.5 s"', '"every\\n0.5 s"')
    )
    forget()
    assert told() == []


def test_an_output_that_no_criterion_asks_for_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(course.VARIABLE, str(EXAMPLES))
    careful = exercises.get("oracle.careful")
    recorded = evidence_files.load_reference(careful.id)
    assert unasked_outputs(careful, recorded) == []
    (drives,) = (criterion for criterion in careful.criteria if criterion.name == "cmd_vel")
    assert unasked_outputs(replace(careful, criteria=[drives]), recorded) == ["/state"]
