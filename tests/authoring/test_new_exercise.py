"""A new exercise is a copy of its recipe's example, with a name of its own."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from autograder import course
from autograder.authoring.new_exercise import EXAMPLES, CannotMake, new_exercise, recipes
from autograder.exercises import REFERENCE
from autograder.masters.source_notebooks import named_cells

if TYPE_CHECKING:
    from pathlib import Path

ID = "lab_9_1.battery_of_mine"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A course with a chapter in which there is nothing."""
    (tmp_path / "solutions/01_first").mkdir(parents=True)
    (tmp_path / "solutions/01_first/chapter.toml").write_text('title = "First"\n')
    return tmp_path


def autograder(root: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a command of the autograder in a course."""
    environ = os.environ | {"AUTOGRADER_COURSE": str(root)}
    return subprocess.run(
        [sys.executable, "-m", "autograder", *words], env=environ, capture_output=True, text=True, check=False
    )


def test_it_is_written_into_the_newest_chapter_or_the_one_that_is_named(root: Path) -> None:
    (root / "solutions/02_second").mkdir()
    (root / "solutions/02_second/chapter.toml").write_text('title = "Second"\n')
    made = new_exercise(root, ID, "publisher")
    assert {path.parent for path in made} >= {root / "solutions/02_second/lab_9_1"}
    made = new_exercise(root, "lab_9_2.other", "publisher", chapter="03_my_third")
    assert made[0] == root / "solutions/03_my_third/chapter.toml"
    assert root / "solutions/03_my_third/lab_9_2/other.py" in made
    assert [chapter.title for chapter in course.chapters(root)] == ["First", "Second", "My third"]


@pytest.mark.parametrize(
    "description",
    ["labs = 5", 'interfaces = "mine"', "title = 1", 'exercises = ["a"]', "[exercises]\nlab_1 = [1]"],
)
def test_a_chapter_whose_facts_have_another_form_is_broken(root: Path, description: str) -> None:
    (root / "solutions/01_first/chapter.toml").write_text(description)
    with pytest.raises(course.BrokenChapter, match="lists of names"):
        course.chapters(root)


def examples(recipe: str) -> list[str]:
    """The names of a recipe's exercises: a ticket has no file of its own."""
    return [path.name.removesuffix(REFERENCE) for path in recipes()[recipe].glob(f"*{REFERENCE}")]


@pytest.mark.parametrize("recipe", recipes())
def test_nothing_in_it_bears_the_name_of_the_example(root: Path, recipe: str) -> None:
    made = new_exercise(root, ID, recipe)
    example = min(examples(recipe))
    kept = [path for path in recipes()[recipe].iterdir() if path.suffix in (".py", ".toml")]
    files = {path.name.replace(example, "battery_of_mine") for path in kept}
    assert {path.name for path in made if path.parent.name == "lab_9_1"} == {"lab.md", *files}
    assert not [path for path in made if re.search(rf"{recipe}\._?{example}", path.read_text())]
    assert (root / "solutions/01_first/lab_9_1/lab.md").read_text().count(f'check("{ID}"') == 1
    assert "\n# Lab 9.1: " in (root / "solutions/01_first/lab_9_1/lab.md").read_text()


@pytest.mark.parametrize("recipe", recipes())
def test_an_example_has_at_most_a_hundred_lines(recipe: str) -> None:
    files = recipes()[recipe].glob("*.py")
    assert sum(len(file.read_text().splitlines()) for file in files) <= 100


@pytest.mark.parametrize(
    ("exercise_id", "recipe", "chapter", "said"),
    [
        ("lab_9_1", "publisher", None, "is not an id"),
        ("Lab_9_1.battery", "publisher", None, "is not an id"),
        ("../lab.battery", "publisher", None, "is not an id"),
        ("lab_9_1.battery", "telepathy", None, "The recipes are: "),
        ("lab_9_1.battery", "publisher", "../elsewhere", "not a valid name for a chapter"),
        ("json.battery", "publisher", None, "Python already has a module json"),
    ],
)
def test_a_bad_name_is_refused(
    root: Path, exercise_id: str, recipe: str, chapter: str | None, said: str
) -> None:
    before = sorted(root.rglob("*"))
    with pytest.raises(CannotMake, match=said):
        new_exercise(root, exercise_id, recipe, chapter=chapter)
    assert sorted(root.rglob("*")) == before


def test_a_second_exercise_of_a_lab_comes_after_the_first(root: Path) -> None:
    new_exercise(root, ID, "publisher")
    lab = root / "solutions/01_first/lab_9_1"
    made = new_exercise(root, "lab_9_1.converter_of_mine", "relay", to_lab=True)
    assert lab / "converter_of_mine.answers/right/usual.py" in made
    assert lab / "battery_of_mine.py" not in made
    text = (lab / "lab.md").read_text()
    parts = [
        "# Lab 9.1: ",
        f'check("{ID}"',
        "\n+++\n\n## ",
        'check("lab_9_1.converter_of_mine"',
        "## Going further",
    ]
    assert [text.count(part) for part in parts] == [1] * len(parts)
    assert sorted(parts, key=text.index) == parts
    assert text.count("· for ") == 1  # the minutes of the lab
    assert [
        one.check.exercise for one in named_cells(lab / "lab.md", points=lambda _: 10.0) if one.check
    ] == [
        ID,
        "lab_9_1.converter_of_mine",
    ]


@pytest.mark.parametrize(
    ("exercise_id", "said"),
    [("lab_9_2.other", "no lab lab_9_2 with a lab.md"), (ID, "battery_of_mine.answers already exists")],
)
def test_what_cannot_be_added_to_a_lab_leaves_it_as_it_is(root: Path, exercise_id: str, said: str) -> None:
    new_exercise(root, ID, "publisher")
    before = {path: path.read_bytes() for path in root.rglob("*") if path.is_file()}
    with pytest.raises(CannotMake, match=said):
        new_exercise(root, exercise_id, "relay", to_lab=True)
    assert {path: path.read_bytes() for path in root.rglob("*") if path.is_file()} == before


def test_a_lab_that_is_there_is_left_as_it_is(root: Path) -> None:
    lab = root / "solutions/01_first/lab_9_1"
    lab.mkdir()
    (lab / "lab.md").write_text("mine")
    for chapter in ("01_first", "02_second"):
        with pytest.raises(CannotMake, match="already exists"):
            new_exercise(root, "lab_9_1.other", "publisher", chapter=chapter)
    assert [path.name for path in lab.iterdir()] == ["lab.md"]


def test_a_course_without_a_chapter_needs_one_to_be_named(tmp_path: Path) -> None:
    (tmp_path / "solutions").mkdir()
    with pytest.raises(CannotMake, match="--chapter"):
        new_exercise(tmp_path, ID, "publisher")


def test_the_command_says_what_to_do_next_and_refuses_with_exit_code_2(root: Path) -> None:
    made = autograder(root, "new-exercise", ID)
    assert made.returncode == 0, made.stderr
    assert "written    solutions/01_first/lab_9_1/battery_of_mine.py" in made.stdout
    assert f"./course try-exercise {ID}" in made.stdout
    again = autograder(root, "new-exercise", ID)
    assert (again.returncode, again.stdout) == (2, "")
    assert "already exists" in again.stderr


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize("recipe", recipes())
def test_an_example_is_in_step_and_judged_as_its_author_expects(recipe: str, tmp_path: Path) -> None:
    # In a copy, because `try-exercise` keeps what it found out about mutants beside an exercise.
    copy = shutil.copytree(EXAMPLES, tmp_path / "examples")
    for example in sorted(examples(recipe)):
        tried = autograder(copy, "try-exercise", f"{recipe}.{example}")
        assert tried.returncode == 0, tried.stdout + tried.stderr
        assert "unchanged" in tried.stdout


@pytest.mark.ros
@pytest.mark.slow
def test_a_new_exercise_works_and_shows_what_its_author_got_wrong(root: Path) -> None:
    new_exercise(root, ID, "publisher")
    tried = autograder(root, "try-exercise", ID)
    assert tried.returncode == 0, tried.stdout + tried.stderr
    assert f"{ID}: recorded in solutions/01_first/lab_9_1/battery_of_mine.reference.json" in tried.stdout
    table = root / "solutions/01_first/lab_9_1/battery_of_mine.answers/wrong/answers.toml"
    table.write_text(table.read_text().replace('diagnosis = "topic_name"', 'diagnosis = "message_type"'))
    seen_of_each = ("--transcript", str(root / "seen"))
    chosen = ("--only", "topic_name", "--only", "no_class", "--repeat", "2", *seen_of_each)
    tried = autograder(root, "try-exercise", ID, *chosen)
    assert tried.returncode == 1, tried.stdout + tried.stderr
    assert "wrong/topic_name.py: diagnosed as topic_name, not as message_type" in tried.stdout
    assert "Your node publishes on /batery, but the task asks for the topic /battery." in tried.stdout
    assert tried.stdout.count("wrong/topic_name.py: diagnosed as") == 1
    assert "  4/4 " in tried.stdout
    assert "2 answers, each judged 2 times, 1 not as expected" in tried.stdout
    seen = {path.name: path.read_text() for path in (root / "seen").rglob("*.txt")}
    assert set(seen) == {"topic_name.py.txt", "no_class.py.txt"}
    assert " message /battery {'fields': {'data': 99}" in seen["no_class.py.txt"]


@pytest.mark.ros
@pytest.mark.slow
def test_an_exception_of_the_exercise_is_named_with_its_line(root: Path) -> None:
    new_exercise(root, ID, "publisher")
    file = root / "solutions/01_first/lab_9_1/battery_of_mine.py"
    # In a known mistake: the criteria are asked of the solution, too.
    wrong = 'battery.knows("odd", lambda *_: 1 / 0, "", "")'
    file.write_text(file.read_text().replace("\nEXERCISE", f"\n{wrong}\nEXERCISE"))
    tried = autograder(root, "try-exercise", ID, "--only", "counter_step")
    assert tried.returncode == 1, tried.stdout + tried.stderr
    fault = "The exercise has a fault: ZeroDivisionError: division by zero (battery_of_mine.py, line "
    assert f"wrong/counter_step.py: could not be checked: {fault}" in tried.stdout
    assert "Show this card to your instructor" in tried.stdout
    assert "again" not in tried.stdout
    assert "1 answer, 1 not as expected" in tried.stdout


def test_all_edits_that_fit_no_line_are_told_before_anything_runs(root: Path) -> None:
    new_exercise(root, ID, "publisher")
    lab = root / "solutions/01_first/lab_9_1"
    table = lab / "battery_of_mine.answers/wrong/answers.toml"
    table.write_text(table.read_text().replace("-        self.charge -= 1", "-        self.charge -= 7"))
    tried = autograder(root, "try-exercise", ID)
    assert tried.returncode == 2, tried.stdout + tried.stderr
    assert tried.stderr.count("the edit does not fit usual.py") == 2
    assert "counter_step.py" in tried.stderr
    assert "counter_stuck.py" in tried.stderr
    assert not list(lab.glob("*.reference.json"))


@pytest.mark.ros
@pytest.mark.slow
def test_a_point_for_what_is_given_is_found(root: Path) -> None:
    new_exercise(root, ID, "hub")
    lab = root / "solutions/01_first/lab_9_1"
    (lab / "battery_of_mine.answers/wrong/answers.toml").unlink()
    text = (lab / "lab.md").read_text(encoding="utf-8")
    # The first class is given as a whole, and with it what the service answers.
    for marker in (
        r":tags: \[solution\]\n\n",
        r"        ### BEGIN SOLUTION\n        # TODO.*\n",
        r"        ### END SOLUTION\n",
    ):
        text = re.sub(marker, "", text, count=1)
    right = "        response.success = self.left is not None and self.right is not None\n"
    text = text.replace("        return response", f"{right}        return response", 1)
    (lab / "lab.md").write_text(text, encoding="utf-8")
    tried = autograder(root, "try-exercise", ID)
    assert tried.returncode == 1, tried.stdout + tried.stderr
    assert ", none not as expected" in tried.stdout, tried.stdout
    assert "the unsolved notebook earns points: 5 for “Says the right success on /tare”" in tried.stdout


@pytest.mark.ros
@pytest.mark.slow
def test_each_recipe_makes_a_lab_that_is_recorded_built_and_executed(root: Path) -> None:
    for number, recipe in enumerate(recipes(), 1):
        new_exercise(root, f"lab_9_{number}.mine", recipe)
    for command in ("record", "build", "execute"):
        done = autograder(root, command)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.ros
@pytest.mark.slow
def test_what_is_expected_does_not_change_unasked(root: Path) -> None:
    new_exercise(root, ID, "publisher")
    recorded = (EXAMPLES / "solutions/recipes/publisher/battery.reference.json").read_text(encoding="utf-8")
    reference = root / "solutions/01_first/lab_9_1/battery_of_mine.reference.json"
    reference.write_text(recorded.replace('{"data": 97}', '{"data": 7}'), encoding="utf-8")
    tried = autograder(root, "try-exercise", ID)
    assert tried.returncode == 1, tried.stdout + tried.stderr
    assert f"./course record {ID}" in tried.stdout
    assert "answers" not in tried.stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["lab_9_1.nothing"], "no exercise is called"),
        ([ID, "--only", "nobody"], "The answers are: right/usual.py"),
    ],
)
def test_what_is_not_there_is_said(root: Path, words: list[str], said: str) -> None:
    new_exercise(root, ID, "publisher")
    tried = autograder(root, "try-exercise", *words)
    assert tried.returncode == 2
    assert said in tried.stderr
