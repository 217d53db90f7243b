"""The tables of the bank: what a right one gives, and what is said of a broken one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.authoring.answer_tables import BadTable, answer_settings, listed_answers
from tests.cases import cases, named_cases

if TYPE_CHECKING:
    from pathlib import Path

RIGHT = '"""Right: counts."""\ni = 0\nwhile True:\n    print(i)\n    i += 1\n'
WHOLE = '"usual.py" = { why = "counts" }\n'
EDIT = cases(__file__, "EDIT")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of answers with a right one and one that changes it."""
    for kind in ("right", "wrong"):
        (tmp_path / kind).mkdir()
    (tmp_path / "right" / "usual.py").write_text(RIGHT)
    (tmp_path / "right" / "answers.toml").write_text(WHOLE)
    (tmp_path / "wrong" / "answers.toml").write_text(EDIT)
    return tmp_path


def texts(folder: Path) -> dict[str, str]:
    return {answer.file.name: answer.text() for answer in listed_answers(folder)}


def test_an_edit_is_a_whole_program_with_its_own_first_line(folder: Path) -> None:
    wrong = RIGHT.replace("Right: counts.", "Wrong: counts from 1.").replace("i = 0", "i = 1")
    assert texts(folder) == {"usual.py": RIGHT, "counter_start.py": wrong}


def test_its_first_line_is_like_that_of_its_base_and_says_why(folder: Path) -> None:
    (folder / "right" / "usual.py").write_text(RIGHT.replace('"""', "# ", 1).replace('"""', ""))
    table = folder / "wrong" / "answers.toml"
    table.write_text(EDIT.replace('shows = "Wrong: counts from 1."\n', ""))
    assert texts(folder)["counter_start.py"].startswith("# Wrong: 1, 2, 3\ni = 1\n")


def test_a_base_without_a_comment_loses_nothing(folder: Path) -> None:
    (folder / "right" / "usual.py").write_text("import rclpy\ni = 0\n")
    assert texts(folder)["counter_start.py"] == "# Wrong: counts from 1.\nimport rclpy\ni = 1\n"


@pytest.mark.parametrize(
    ("old", "new", "words"), named_cases(__file__, "an_edit_that_does_not_fit_is_named_when_it_is_used")
)
def test_an_edit_that_does_not_fit_is_named_when_it_is_used(
    folder: Path, old: str, new: str, words: str
) -> None:
    table = folder / "wrong" / "answers.toml"
    table.write_text(EDIT.replace(old, new))
    with pytest.raises(BadTable, match=f"wrong/answers.toml: counter_start.py: .*{words}"):
        texts(folder)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        *named_cases(__file__, "a_broken_table_is_named"),
        pytest.param(
            EDIT, '"a.py" = { why = "?", diagnosis = "a" }', "the file .*a.py does not exist", id="no file"
        ),
    ],
)
def test_a_broken_table_is_named(folder: Path, old: str, new: str, words: str) -> None:
    (folder / "wrong" / "answers.toml").write_text(EDIT.replace(old, new))
    with pytest.raises(BadTable, match=f"wrong/answers.toml: .*{words}"):
        list(listed_answers(folder))


def test_a_workspace_is_told_by_what_it_changes(folder: Path) -> None:
    table = folder / "wrong" / "answers.toml"
    table.write_text(EDIT.replace(".py", ".workspace").replace('base = "usual.workspace"\n', ""))
    assert texts(folder)["counter_start.workspace"] == "Wrong: counts from 1.\n-i = 0\n+i = 1\n"
    table.write_text(EDIT.replace("counter_start.py", "counter_start.workspace"))
    with pytest.raises(BadTable, match=r"counter_start\.workspace: remove base: settings"):
        list(listed_answers(folder))


def test_a_folder_without_settings_holds_python_programs(folder: Path) -> None:
    assert answer_settings(folder).command == ("python3", "{file}")
    (folder / "settings.toml").write_text('command = ["{file}"]\nbase = "base"\n')
    assert (answer_settings(folder).command, answer_settings(folder).base) == (("{file}",), "base")
    (folder / "settings.toml").write_text('comand = ["{file}"]\n')
    with pytest.raises(BadTable, match=r"settings\.toml: .*unknown field `comand`"):
        answer_settings(folder)


def test_an_answer_is_told_once_and_either_whole_or_as_an_edit(folder: Path) -> None:
    (folder / "wrong" / "more.toml").write_text(EDIT)
    with pytest.raises(BadTable, match=r"more\.toml: counter_start.py: the answer is listed twice"):
        list(listed_answers(folder))
    (folder / "wrong" / "more.toml").unlink()
    (folder / "wrong" / "counter_start.py").write_text(RIGHT)
    with pytest.raises(BadTable, match="exists: remove one of the two"):
        list(listed_answers(folder))
    (folder / "wrong" / "counter_start.py").unlink()
    (folder / "right" / "answers.toml").write_text('"usual.py" = { why = "counts", diagnosis = "crashed" }\n')
    with pytest.raises(BadTable, match="a right answer must not have a diagnosis"):
        list(listed_answers(folder))
