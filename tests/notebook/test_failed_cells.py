"""A class whose cell ended with an error, in a kernel: a check says so, and does not judge the class of before."""

from __future__ import annotations

from itertools import accumulate, count
from typing import TYPE_CHECKING, Any

import pytest

from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

# A judge that is reached has said enough.
JUDGE = cases(__file__, "JUDGE")
RIGHT = "class Talker:\n    pass"
CHECK = "check('lab', Talker)"


def text_of(output: Any) -> str:
    if output.output_type == "error":
        assert output.ename in {
            "NameError",
            "ModuleNotFoundError",
            "StaleCodeError",
            "SyntaxError",
            "TypeError",
        }
    if output.output_type == "stream":
        return " ".join(output.text.split())
    text = "\n".join(output.traceback) if output.output_type == "error" else output.data["text/plain"]
    return " ".join(text.replace("│", "").split())


@pytest.fixture(scope="module")
def said(run_in_one_kernel: Callable[..., list[Any]]) -> Callable[..., list[str]]:
    """Run groups of cells below JUDGE, each about a Talker of its own; what the last cell of each shows.

    In a test its Talkers are numbered from 0; in the kernel no two have one name.
    """
    used = count()
    run_in_one_kernel(JUDGE)

    def run(*groups: Sequence[str]) -> list[str]:
        names = [f"Talker{next(used)}" for _ in groups]
        cells = [
            cell.replace("Talker", name) for name, group in zip(names, groups, strict=True) for cell in group
        ]
        shown = run_in_one_kernel(*cells, allow_errors=True)
        last = [" ".join(map(text_of, shown[end - 1])) for end in accumulate(map(len, groups))]
        return [
            words.replace(name, f"Talker{number}")
            for number, (name, words) in enumerate(zip(names, last, strict=True))
        ]

    return run


def test_a_class_whose_newest_code_did_not_run_is_not_judged(said: Callable[..., list[str]]) -> None:
    broken = {
        "class Talker:\n    def talk(self)\n        pass": "SyntaxError in line 2, expected ':'",
        "class Talker:\n    x = 1 / 0": "ZeroDivisionError in line 2, division by zero",
        "import nothing_like_it\nclass Talker:\n    pass": "ModuleNotFoundError in line 1",
    }
    told = said(*((RIGHT, cell, CHECK) for cell in broken))
    for number, (words, error) in enumerate(zip(told, broken.values(), strict=True)):
        assert (
            f"Your cell that defines Talker{number} stopped before Talker{number} was defined: {error}"
            in words
        )
        assert "Correct that cell and run it" in words
        assert "the judge was asked" not in words
        assert "Traceback" not in words


def test_code_of_elsewhere_is_told_below_the_cell_and_by_the_check(said: Callable[..., list[str]]) -> None:
    tutorial = "from example_interfaces.srv import AddTwoInts\nclass Talker:\n    pass"
    ros1 = "class Talker:\n    pub = rospy.Publisher('chatter')"
    shown, checked, old = said((tutorial,), (tutorial, CHECK), (RIGHT, ros1, CHECK))
    assert "No module named 'example_interfaces'" in shown
    for words in (shown, checked):
        assert "my_robot_interfaces instead of example_interfaces" in words
    assert "Write self.create_publisher(String, 'chatter', 10)" in old
    assert "The notebook still has an older Talker2. Correct that cell" in old


def test_a_class_that_the_checked_function_uses_must_not_be_older_than_its_cell(
    said: Callable[..., list[str]],
) -> None:
    broken = "class Talker:\n    if x = 3:\n        pass"
    uses = {
        "make": "def make():\n    return Talker()",
        "Maker": "class Maker:\n    def make(self):\n        return [Talker for _ in range(2)]",
    }
    told = said(*((RIGHT, use, broken, f"check('lab', {name})") for name, use in uses.items()))
    for number, words in enumerate(told):
        assert f"Your cell that defines Talker{number} stopped before Talker{number} was defined" in words


def test_a_check_of_files_says_that_the_cell_with_the_entry_points_failed(
    said: Callable[..., list[str]],
) -> None:
    files = "check('lab', 'ros2_ws')"
    broken = "entry_points = [\n    'talker = my_robot_pkg.talker:main\n]\nprint(entry_points)"
    question = "entry_points = []\nif entry_points = []:\n    pass"
    told, unbroken, asked = said((broken, files), (broken, "entry_points = []", files), (question, files))
    assert "Your cell that defines entry_points" in told
    assert "SyntaxError in line 2, unterminated string literal" in told
    assert "So setup.py lacks the entry points of that cell" in told
    assert "the judge was asked" in told
    assert "So setup.py" not in unbroken
    assert "instead of '='. So setup.py" in asked


def test_any_other_class_is_judged(said: Callable[..., list[str]]) -> None:
    cells = {
        "mended": (RIGHT, "class Talker:\n    1 +", RIGHT),
        "error below the class": (RIGHT + "\n1 / 0",),
        "another class": (RIGHT, "class Listener:\n    1 +"),
        "another cell": (RIGHT, "Talker.tick()"),
        "an attribute of that name": (
            "class Talker:\n    def talk(self):\n        return self.tell()",
            "def tell(): pass",
            "def tell():\n    1 +",
        ),
        "text of a file": (RIGHT, "%%nothing\nclass Talker:\n    1 +"),
        "a grader's kernel": (
            RIGHT,
            "class Talker:\n    1 +",
            "import os; os.environ['AUTOGRADER_JUDGE_SOCKET'] = 'there'",
        ),
    }
    told = said(*((*group, CHECK) for group in cells.values()))
    said(("import os; del os.environ['AUTOGRADER_JUDGE_SOCKET']",))
    assert [name for name, words in zip(cells, told, strict=True) if "the judge was asked" not in words] == []


def test_a_class_that_is_not_there_is_named_with_its_cell(said: Callable[..., list[str]]) -> None:
    nothing, never_ran = said((CHECK,), ("class Talker:\n    1 +", CHECK))
    assert "Run the cell that defines Talker0 first" in nothing
    assert "there is no Talker1 yet. Your cell that defines Talker1" in never_ran


def test_other_name_errors_keep_their_traceback(said: Callable[..., list[str]]) -> None:
    sources = ["Talker()", "def make():\n    return Talker()\nmake()", "# check(Talker)\nTalker()"]
    for number, shown in enumerate(said(*((source,) for source in sources))):
        assert f"there is no Talker{number} yet" not in shown
        assert f"name 'Talker{number}' is not defined" in shown


def test_a_known_error_of_a_cell_is_told_below_it_without_lines_of_ipython(
    said: Callable[..., list[str]],
) -> None:
    command, awaits, magic, quoted = said(
        ["ros2 topic list"],
        ["def f():\n    await g()"],
        ["# my file\n%%writefile talker.py\nimport rclpy"],
        [RIGHT, "check('lab', 'Talker')"],
    )
    assert "Write %%bash --no-raise-error as the first line of the cell" in command
    assert "interactiveshell" not in command
    assert "instead of `await your_future`" in awaits
    assert "Move %%writefile to the first line of the cell" in magic
    assert "takes your class or function itself, without quotation marks" in quoted
