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

TRANSITION = "RCLError: Failed to update goal state: goal_handle attempted invalid transition from state"
SAID = {
    "SyntaxError: incomplete input": "Count the brackets",
    "SyntaxError: invalid syntax": "just before it",
    "SyntaxError: invalid character '“' (U+201C)": "quotation marks are",
    "IndentationError: expected an indented block after 'if' statement on line 4": "begin in the same column",
    "SyntaxError: 'return' outside function": "indent the lines that belong to it",
    "ImportError: cannot import name 'Strng' from 'std_msgs.msg' (/opt/ros/x/__init__.py)": "does not contain Strng",
    "AttributeError: module 'rclpy' has no attribute 'Node'": "`from rclpy.node import Node`",
    "NameError: name 'time' is not defined": "Write import time",
    "NameError: name 'std_msgs' is not defined": "String instead of std_msgs.msg.String",
    "NameError: name 'self' is not defined": "such as node or client",
    "NameError: name 'count' is not defined. Did you mean: 'self.count'?": "Write self.count",
    "NameError: name 'comand' is not defined. Did you mean: 'command'?": "it knows command",
    "NameError: name 'publisher' is not defined": "also in the line that sets it",
    "NameError: name 'linear' is not defined": "A Twist has two parts",
    "UnboundLocalError: local variable 'i' referenced before assignment": "write self.i",
    "AttributeError: 'Talker' object has no attribute 'cuont'. Did you mean: 'count'?": "write count.",
    "AttributeError: 'Talker' object has no attribute 'Counter'": "Talker has no Counter at this point",
    "AttributeError: 'Talker' object has no attribute 'publisher'. Did you mean: 'publishers'?": "self.publisher = ...",
    "AttributeError: 'Fibonacci_GetResult_Response' object has no attribute 'sequence'": "answer.result.sequence",
    "rclpy._rclpy_pybind11.InvalidHandle: cannot use Destroyable because destruction was requested": "destroy_node()",
    "AttributeError: 'Timer' object has no attribute 'publish'": "has the type Timer",
    "AttributeError: 'NoneType' object has no attribute 'order'": "has run before this line",
    "TypeError: 'NoneType' object is not iterable": "such as the append of a list",
    "AttributeError: 'function' object has no attribute 'add_done_callback'": "a method that your code did not call",
    "TypeError: 'method' object is not iterable": "Write parentheses after the method's name",
    "AttributeError: type object 'GoalResponse' has no attribute 'Accept'": "written in capital letters",
    'TypeError: can only concatenate str (not "NoneType") to str': "Put the value into an f-string",
    "TypeError: unsupported operand type(s) for +: 'int' and 'str'": "convert the string to a number",
    "TypeError: 'Fibonacci_Result' object is not iterable": "answer.result.sequence",
    "TypeError: Talker is not a Node: write class Talker(Node)": "Write class Talker(Node):",
    "TypeError: rclpy_logging_rcutils_log(): incompatible function arguments. The": "info(f'{message.data}')",
    "TypeError: ask() missing 3 required positional arguments: 'a', 'b', and 'patience_sec'": "call of ask with its",
    "TypeError: ActionServer.__init__() takes 5 positional arguments but 7 were given": "call of ActionServer with its",
    "TypeError: spin() got an unexpected keyword argument 'nod'": "the same names before each =",
    "rclpy.exceptions.InvalidTopicNameException: Invalid topic name": "or end with a slash",
    "ValueError: Failed to create action client due to invalid topic name 'fibonacci/' : topic name must not contain "
    "repeated '/'": "or end with a slash",
    "IndexError: pop from empty list": "none is left",
    "StopIteration": "none is left",
    "ValueError: invalid literal for int() with base 10: '{five}'": "'{five}' is not a number",
    "ValueError: could not convert string to float: 'five'": "'five' is not a number",
    f"{TRANSITION} CANCELED with event SUCCEED, at goal_handle.c:100": "End each goal exactly once",
    "LookupError: nothing": "Read the traceback from the bottom",
    "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'": "Write def __init__(self):",
    "TypeError: descriptor '__init__' requires a 'super' object": "super().__init__('your_node_name') the first line",
    "TypeError: Expected QoSProfile or int, but received <class 'str'>: 10": "do not put the 10 in quotation marks",
    "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'std_msgs.msg._string.Metaclass_String'>": (
        "not an object of the type String"
    ),
    "AttributeError: type object 'type' has no attribute '_TYPE_SUPPORT'": "Python's own str is not String",
    "AssertionError: The 'linear' field must be a sub message of type 'Vector3'": "whole name: command.linear.x = 0.5",
    "AssertionError: The 'data' field must be of type 'str'": "str(...)",
    "SystemError: <built-in method publish of x> returned a result with an exception set": "or a number that is too",
    "AttributeError: 'Fibonacci_Feedback' object attribute 'partial_sequence' is read-only": "Run All Cells",
    "AttributeError: 'String' object has no attribute 'date'": "single field, `data`",
    "AttributeError: 'AddTwoInts_Response' object has no attribute 'a'": "the request first and then the response",
    "AttributeError: 'Fibonacci_Feedback' object has no attribute 'sequence'": "Fibonacci_Feedback has no field called",
    "AttributeError: 'Fibonacci_FeedbackMessage' object has no attribute 'goal_handle'": "as in self.goal_handle",
}


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
