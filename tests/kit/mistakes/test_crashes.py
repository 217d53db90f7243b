"""What Python says of a beginner's slip, and what the card makes of it."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.model import Advice

SAID = cases(__file__, "SAID")


@pytest.mark.parametrize("last", SAID)
def test_the_card_names_what_to_mend(last: str) -> None:
    words = told(f'Traceback (most recent call last):\n  File "talker.py", line 3, in f\n    here()\n{last}')
    assert SAID[last] in words
    examples = ("{number}", "{five}", "{message.data}", "{response.sum}")
    assert "{" not in functools.reduce(lambda text, example: text.replace(example, ""), examples, words)


@pytest.mark.parametrize(
    ("code", "last", "advice"), cases(__file__, "the_line_that_raised_tells_what_to_write")
)
def test_the_line_that_raised_tells_what_to_write(code: str, last: str, advice: str) -> None:
    frames = (
        f'Traceback (most recent call last):\n  File "talker.py", line 3, in __init__\n    {code}\n    ^^^^\n'
    )
    assert advice in told(f"{frames}{last}")


@pytest.mark.parametrize(("file", "future"), cases(__file__, "only_a_line_of_the_students_own_tells_a_name"))
def test_only_a_line_of_the_students_own_tells_a_name(file: str, future: str) -> None:
    lines = f'  File "{file}", line 3, in f\n    print(fut.sum)\n'
    last = "AttributeError: 'Future' object has no attribute 'sum'"
    assert f"read {future}.result().sum" in told(f"Traceback (most recent call last):\n{lines}{last}")


IN_THE_EXECUTOR = (
    'Traceback (most recent call last):\n  File "talker.py", line 12, in <module>\n    rclpy.spin(Talker)\n'
    '  File "/venv/lib/python3.11/site-packages/rclpy/executors.py", line 601, in _wait_for_ready_callbacks\n'
    "    subscriptions.extend(filter(self.can_execute, node.subscriptions))\n"
    "TypeError: 'property' object is not iterable"
)
IN_A_CALLBACK = (
    'Traceback (most recent call last):\n  File "talker.py", line 12, in <module>\n    rclpy.spin(node)\n'
    '  File "/venv/lib/python3.11/site-packages/rclpy/executors.py", line 108, in await_or_execute\n'
    "    return callback(*args)\n"
    '  File "talker.py", line 7, in tick\n    1 / 0\nZeroDivisionError: division by zero'
)


def test_only_what_a_callback_raised_is_called_an_exception_in_a_callback() -> None:
    assert diagnosed(IN_A_CALLBACK) == "exception_in_callback"
    assert diagnosed(IN_THE_EXECUTOR) == "crashed"
    head, _, executor = IN_THE_EXECUTOR.partition('  File "/venv')
    for traceback in (IN_THE_EXECUTOR, head + executor.splitlines()[-1]):
        assert "rclpy.spin(Talker())" in told(traceback)


def test_what_ros_raised_of_a_notebooks_node_names_the_node_and_no_traceback_that_is_not_there() -> None:
    """The traceback of a notebook has the student's lines only, and here is none of them."""
    made, no_hash = Event(0.1, "subject", "constructed"), "TypeError: unhashable type: 'Talker'"
    assert diagnosed(no_hash, made) == "crashed"
    assert "A node cannot be a `@dataclass`" in told(no_hash, made)
    for words in (told("RuntimeError: nothing known", made), told("ValueError: neither")):
        assert "Look at what your code passes to ROS" in words
        assert "Read the traceback" not in words


def test_a_program_s_traceback_has_lines_of_the_generated_module_in_it() -> None:
    frames = (
        'Traceback (most recent call last):\n  File "talker.py", line 3, in tick\n    message = String(dat="x")\n'
        '              ^^^^^^^^^^^^^^^\n  File "/ros/std_msgs/msg/_string.py", line 68, in __init__\n'
        "    assert all('_' + key in self.__slots__ for key in kwargs.keys()), \\\n"
    )
    assert "has no field called dat." in told(
        f"{frames}AssertionError: Invalid arguments passed to constructor: dat"
    )


@pytest.mark.parametrize(
    ("code", "last", "says"), cases(__file__, "self_is_the_message_only_where_the_line_says_self")
)
def test_self_is_the_message_only_where_the_line_says_self(code: str, last: str, says: str) -> None:
    frames = f'Traceback (most recent call last):\n  File "talker.py", line 3, in tick\n    {code}\n'
    assert says in told(f"{frames}AttributeError: {last}")


NONE_HAS_NO_SUM = (
    'Traceback (most recent call last):\n  File "client.py", line 9, in main\n    print(node.answer.sum)\n'
    "AttributeError: 'NoneType' object has no attribute 'sum'"
)


@pytest.mark.parametrize(
    ("late", "is_told"), [((1.0, 1.0), True), ((0.05, 1.0), False), ((-0.05, 1.0), True)]
)
def test_an_answer_was_left_lying_only_if_it_was_so_in_each_run(
    late: tuple[float, ...], is_told: bool
) -> None:
    """In one run of several a busy machine may be why the client ended so late, or why the answer came after that."""
    runs = [
        Part(
            f"run {number}",
            {},
            [
                Event(1.0, "response", "/add", {"fields": {"sum": 3}}),
                Event(1.0 + seconds, "subject", "raised", {"traceback": NONE_HAS_NO_SUM}),
            ],
        )
        for number, seconds in enumerate(late)
    ]
    first = next(mistake for mistake in CRASHES if mistake.key == "call_never_spun")
    assert (first.recognize(Evidence(runs, Reference("x", {}))) is not None) == is_told


SEGMENTATION_FAULT = cases(__file__, "SEGMENTATION_FAULT")
"""What Python 3.14 prints; earlier versions print neither the thread's name nor the C stack."""


def test_the_c_stack_of_a_crash_in_compiled_code_is_neither_its_traceback_nor_its_words() -> None:
    lines = ["before", *SEGMENTATION_FAULT.splitlines()]
    part = Part("part", {}, [Event(0.1, "output", "stderr", {"text": line}) for line in lines])
    first, outermost, *_, last = part.traceback.splitlines()
    assert (first, last) == ("Traceback (most recent call last):", "Segmentation fault")
    assert outermost == '  File "talker.py", line 5, in <module>'
    assert [line for line in part.said() if line] == ["before"]


def told(traceback: str, *before: Event) -> str:
    """What the diagnosis of a subject says that ended with this traceback."""
    _, advice = _found(traceback, before)
    return f"{advice.text} {advice.next_step}"


def diagnosed(traceback: str, *before: Event) -> str:
    """The key of that diagnosis."""
    return _found(traceback, before)[0]


def _found(traceback: str, before: Sequence[Event]) -> tuple[str, Advice]:
    event = Event(0.1, "subject", "raised", {"traceback": traceback})
    evidence = Evidence([Part("part", {}, [*before, event])], Reference("x", {}))
    asked = ((mistake.key, mistake.recognize(evidence)) for mistake in (*CRASHES, *OTHER_CRASHES))
    return next((key, advice) for key, advice in asked if advice is not None)
