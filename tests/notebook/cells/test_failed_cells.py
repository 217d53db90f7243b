"""A class whose cell ended with an error, in a kernel: a check says so, and does not judge the class of before."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

# A judge that is reached has said enough.
JUDGE = """
import importlib
from autograder.notebook import check
checking = importlib.import_module("autograder.notebook.checking.check")

class Link:
    def __init__(self):
        raise checking.JudgeUnreachable("the judge was asked")

checking.JudgeLink = Link
"""
RIGHT = "class Talker:\n    pass"
CHECK = "check('lab', Talker)"


@pytest.fixture
def said(run_cells: Callable[..., list[Any]]) -> Callable[..., str]:
    """Run cells below JUDGE; what the last of them says, on a card or as an error."""

    def run(*sources: str) -> str:
        first = run_cells(JUDGE, *sources, allow_errors=True)[-1][0]
        if first.output_type == "error":
            assert first.ename in {"NameError", "StaleCodeError"}
        text = "\n".join(first.traceback) if first.output_type == "error" else first.data["text/plain"]
        return " ".join(text.replace("│", "").split())

    return run


@pytest.mark.parametrize(
    ("broken", "error"),
    [
        ("class Talker:\n    def talk(self)\n        pass", "SyntaxError in line 2, expected ':'"),
        ("class Talker:\n    x = 1 / 0", "ZeroDivisionError in line 2, division by zero"),
        ("import nothing_like_it\nclass Talker:\n    pass", "ModuleNotFoundError in line 1"),
    ],
)
def test_a_class_whose_newest_code_did_not_run_is_not_judged(
    said: Callable[..., str], broken: str, error: str
) -> None:
    words = said(RIGHT, broken, CHECK)
    assert f"Your cell that defines Talker did not run to its definition: {error}" in words
    assert "Mend that cell and run it" in words
    assert "the judge was asked" not in words
    assert "Traceback" not in words


@pytest.mark.parametrize(
    "cells",
    [
        pytest.param((RIGHT, "class Talker:\n    1 +", RIGHT), id="mended"),
        pytest.param((RIGHT + "\n1 / 0",), id="error below the class"),
        pytest.param((RIGHT, "class Listener:\n    1 +"), id="another class"),
        pytest.param((RIGHT, "Talker.tick()"), id="another cell"),
        pytest.param((RIGHT, "%%nothing\nclass Talker:\n    1 +"), id="text of a file"),
        pytest.param(
            (RIGHT, "class Talker:\n    1 +", "import os; os.environ['AUTOGRADER_JUDGE_SOCKET'] = 'there'"),
            id="a grader's kernel",
        ),
    ],
)
def test_any_other_class_is_judged(said: Callable[..., str], cells: tuple[str, ...]) -> None:
    assert "the judge was asked" in said(*cells, CHECK)


def test_a_check_of_no_class_says_which_cell_to_run(said: Callable[..., str]) -> None:
    assert "Run the cell that defines Talker first" in said(CHECK)


def test_a_check_of_a_class_that_never_ran_says_why(said: Callable[..., str]) -> None:
    assert "there is no Talker yet. Your cell that defines Talker" in said("class Talker:\n    1 +", CHECK)


@pytest.mark.parametrize(
    "source", ["Talker()", "def make():\n    return Talker()\nmake()", "# check(Talker)\nTalker()"]
)
def test_other_name_errors_keep_their_traceback(said: Callable[..., str], source: str) -> None:
    shown = said(source)
    assert "there is no Talker yet" not in shown
    assert "name 'Talker' is not defined" in shown
