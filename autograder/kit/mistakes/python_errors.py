"""Explains Python's own errors in beginners' programs, with the names that the student's code uses.

Each entry of the lists matches a message of Python 3.11 and 3.12 or of rclpy 7.1, and the first entry that matches
decides. Add an entry only if two answers in the bank, or a question asked in public, need it, because the card quotes
Python's own message anyway. The names come from the line of code that a traceback quotes: advice on a card says
``fut.result()`` if the program calls its future ``fut``. If the quoted line does not show the name, the advice uses a
general term.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import re2

if TYPE_CHECKING:
    from collections.abc import Sequence


MARKS = r"\n(?:[ ~^]*\n)?"
"""Matches the text between a quoted line of code and Python's message: a line break, and possibly a line of ``^`` and
``~``.
"""
Row = tuple[str, str, str]
"""A pattern to search for in a traceback, the meaning, and the next step. Both texts may use the pattern's named
groups.
"""


class Meaning(NamedTuple):
    """The meaning of an error and the next step, as texts for the student.

    Attributes:
        why: A sentence that says what is wrong; empty if Python's message already says it.
        next_step: What the student should do now.
    """

    why: str
    next_step: str


_READS = r"^(?:SyntaxError|IndentationError|TabError): "
READING: Sequence[Row] = (
    (
        rf"{_READS}expected ':'",
        "A colon is missing.",
        "Write a colon at the end of that line. Lines that begin with class, def, if, else, for, while, try or with "
        "end with a colon.",
    ),
    (
        rf"{_READS}(?:'.' was never closed|unmatched|incomplete input)",
        "",
        "Count the brackets in that line: each opening bracket needs a closing one.",
    ),
    (
        rf"{_READS}(?:unterminated|EOL while scanning|f-string: expecting)",
        "A string does not end.",
        "End the string with the same quotation mark that it begins with. In an f-string, close each {{ with a }}.",
    ),
    (
        rf"{_READS}invalid (?:non-printable )?character",
        "That line contains a character that is not Python. It may have been copied from a word processor or a web "
        "page.",
        "Type the line again by hand: quotation marks are ' or \", and a minus is -.",
    ),
    (
        r"^(?:IndentationError|TabError): |^SyntaxError: 'return' outside",
        "",
        "After a line that ends with a colon, indent the lines that belong to it by four spaces. Do not use tabs. "
        "All lines of one block begin in the same column.",
    ),
    (
        _READS,
        "",
        "Go to the line that the message names. In this line or just before it, a bracket, a quotation mark, a colon "
        "or the indentation is wrong.",
    ),
)
"""The rows for messages with which Python reports that it cannot parse a program."""

_IMPORTED_FROM = {
    "action_msgs.msg": "GoalStatus",
    "geometry_msgs.msg": "Twist",
    "rclpy.action": "ActionClient|ActionServer|CancelResponse|GoalResponse",
    "rclpy.callback_groups": "MutuallyExclusiveCallbackGroup|ReentrantCallbackGroup",
    "rclpy.executors": "ExternalShutdownException|MultiThreadedExecutor|SingleThreadedExecutor",
    "rclpy.node": "Node",
    "rclpy.qos": "DurabilityPolicy|QoSProfile|ReliabilityPolicy",
    "std_msgs.msg": "String",
}
"""Names that beginners often forget to import, or import from the wrong module; the key is the right module."""
_NOT_STUDENTS = (
    r"list|dict|tuple|set|str|bytes|bool|int|float|\w+GoalHandle|Publisher|Subscription|Timer|Client|Service"
    r"|ActionClient|ActionServer|RcutilsLogger"
)
"""Matches the names of types that come from libraries, not from the student."""

RUNNING: Sequence[Row] = (
    *(
        (
            rf"^(?:NameError: name|ImportError: cannot import name|AttributeError: module 'rclpy' has no attribute) "
            rf"'(?P<name>{names})'",
            f"{{name}} comes from the module {module}.",
            f"Write `from {module} import {{name}}` at the top of the program, and delete {{name}} from any other "
            "import. In a notebook, run the cell with the imports.",
        )
        for module, names in _IMPORTED_FROM.items()
    ),
    (
        r"^NameError: name '(?P<name>\w+_(?:msgs|srvs|interfaces)|math|random|rclpy|sys|threading|time)'",
        "{name} is a module that your code does not import.",
        "Write import {name} at the top of the program. In a notebook, write the import in the cell with the "
        "imports, and run that cell. If your code imports a type with `from`, write only the name of the type: "
        "String instead of std_msgs.msg.String.",
    ),
    (
        r"^NameError: name 'self'",
        "Python knows self only inside a method whose first parameter is self.",
        "In a method, write self as the first parameter, as in def say_hello(self), and indent the method's lines by "
        "eight spaces. A function has no self: write the name that the node has there, such as node or client.",
    ),
    (
        r"^NameError: name '(?P<name>\w+)' is not defined\. Did you mean: '(?P<meant>[\w.]+)'",
        "Python does not know the name {name}, but it knows {meant}.",
        "If you mean {meant}, write {meant}. If {name} belongs to your node, write self.{name}. In a notebook, run "
        "the cell that defines {name}. In a program, define {name} in this file.",
    ),
    (
        r"^NameError: name '(?P<name>\w+)'",
        "Python does not know the name {name}.",
        "Check the spelling of {name} first. If it is a value or method of your node, write self.{name}, also in the "
        "line that sets it. If it is a field of a message or goal, write the message and a dot before it. In a "
        "notebook, run the cell that defines {name}. In a program, define or import {name} in this file.",
    ),
    (
        r"^(?:UnboundLocalError: )(?:cannot access local variable|local variable) '(?P<name>\w+)'",
        "Without self. before it, {name} is a variable that exists only in this method, and it has no value yet.",
        "If {name} is a value of the node, write self.{name} here and in every other line that uses it.",
    ),
    (
        r"^ImportError: cannot import name",
        "",
        "Compare the import with the lab's text, letter by letter: .msg, .srv or .action, capital letters, and "
        "missing letters.",
    ),
    (
        r"'NoneType' object (?:has no attribute '\w+'|is not (?:iterable|subscriptable))",
        "{owner:A value in this line} is None. Either it was not set yet, or it was set to what a function returned "
        "that returns nothing, such as the append of a list.",
        "Find the line that sets this value, and check whether it has run before this line.",
    ),
    (
        r"'(?:builtin_function_or_method|function|method)' object (?:has no attribute|is not)",
        "{owner:A value in this line} is a method that your code did not call, and not the value that the method "
        "returns.",
        "Write parentheses after the method's name, as in self.get_logger().info(...). The name may be in this line "
        "or in the line that sets the value.",
    ),
    (
        rf"AttributeError: '(?P<class>{_NOT_STUDENTS})' object has no attribute '(?P<name>\w+)'",
        "{owner:The value before .{name}} has the type {class}, and this type has no {name}.",
        "Look at the line that sets this value: it may not be the value that you expect. If it is, compare the "
        "spelling of {name}, letter by letter. If {name} is a function of the notebook or program, write {name}(...) "
        "without anything before it.",
    ),
    (
        r"^AttributeError: '(?P<class>\w+)' object has no attribute '(?P<name>\w+)'\. Did you mean: '(?P<meant>\w+)'",
        "{class} has no {name}, but it has {meant}.",
        "If you mean {meant}, write {meant}. Otherwise define {name} in the class: a value as self.{name} = ... in "
        "__init__, a method as def {name}(self, ...).",
    ),
    (
        r"^AttributeError: '(?P<class>\w+)' object has no attribute '(?P<name>\w+)'",
        "{class} has no {name} at this point of the program.",
        "If {name} is a value, set it in __init__, above the line that needs it. Write self.{name} = ... there, "
        "because Python forgets a variable without self. at the end of the method. If {name} is a method, check the "
        "spelling, and indent its def line like def __init__. If {name} is a variable or function outside of the "
        "class, delete the part before {name}, with the dot.",
    ),
    (
        r"^AttributeError: property '(?P<name>\w+)' of '(?P<class>\w+)' object has no setter",
        "The value {name} of {class} can be read but not set.",
        "To store your own value, choose a name other than {name}.",
    ),
    (
        r"AttributeError: partially initialized module '(?P<name>[\w.]+)'",
        "One of your files has the same name as the module {name}, and Python imports your file instead of the module.",
        "Rename your file.",
    ),
    (
        r"^AttributeError: ",
        "The value before the dot has nothing with this name.",
        "Compare the name with the lab's text, letter by letter. Constants are written in capital letters, such as "
        "GoalResponse.ACCEPT.",
    ),
    (
        r"^TypeError: (?:can only concatenate str|unsupported operand type\(s\) for \+=?: '(?:int|float|str)' and "
        r"'(?:int|float|str)')",
        "Your code joins a string and another value with +, but + joins a string only with a string.",
        "Put the value into an f-string, inside braces, as in f'... {{number}}'. If the value is a message, use its "
        "field, as in {{message.data}}. To add numbers, first convert the string to a number with int(...).",
    ),
    (
        # The executor stores its nodes in a set, so each node needs a hash. The pattern matches only the error, because
        # a notebook's traceback omits the lines of rclpy.
        r"(?:\A|rclpy/executors\.py\".*\n(?: .*\n){1,2})TypeError: unhashable type: '(?P<class>\w+)'",
        "ROS cannot store your node, because the class {class} has no hash. A class loses its hash if it has "
        "@dataclass or a method __eq__.",
        "A node cannot be a `@dataclass`: delete `@dataclass`. Then write def __init__(self): with "
        "super().__init__('your_node_name') as its first line, and set the fields below that, as in self.count = 0. "
        "If your class has a method __eq__, delete it.",
    ),
    (
        # In a program, the traceback shows the line of rclpy that reads node.subscriptions, but a notebook's traceback
        # omits it.
        rf"(?:\bspin\w*\((?P<class>[A-Za-z_]\w*)[,)].*\n(?:.*\n)*?|node\.subscriptions.*{MARKS})"
        r"TypeError: 'property' object is not iterable",
        "spin needs a node, but your code passed the class.",
        "Write parentheses after the name of the class, to make a node of it: rclpy.spin({class:YourNode}()).",
    ),
    (
        r"^TypeError: (?P<class>\w+) is not a Node: write class",
        "",
        "The check makes a node from your class, so the class must be a Node. Write class {class}(Node):. Make "
        "super().__init__('your_node_name') the first line of its __init__, and write self.create_... below that.",
    ),
    (
        r"^TypeError: '(?P<kind>\w+)' object is not (?:subscriptable|iterable)",
        "Your code uses a value of the type {kind} like a list or a dictionary, but it is neither.",
        "If the value is a message, use its field, as in message.data or answer.result.sequence. If a list is "
        "needed, pass the whole list. Add two numbers with +, not with sum.",
    ),
    (
        # rclpy raises this error when it calls the callback. A notebook's traceback, however, omits the lines of rclpy.
        r"(?:\A|rclpy/(?:executors|task)\.py\".*\n(?: .*\n){1,2})TypeError: '(?P<kind>\w+)' object is not callable",
        "ROS needs a method as the callback, but got a value of the type {kind}.",
        "Look at the line that passes the callback, such as create_timer(...). Pass the method's name with self. "
        "before it, without quotation marks and without parentheses, as in create_timer(0.5, self.say_hello).",
    ),
    (
        r"^TypeError: '(?P<kind>\w+)' object is not callable",
        "Your code calls a value of the type {kind} as if it were a method.",
        "To read the value, delete the parentheses. To set it, write = after its name. A list or a dictionary needs "
        "square brackets: names[key]. If a method has the same name, rename the value.",
    ),
    (
        r"^TypeError: rclpy_logging_rcutils_log\(\): incompatible function arguments",
        "The logger needs a string, but got something else, such as a number or a whole message.",
        "Put the value into an f-string, inside braces, as in info(f'{{response.sum}}'). If the value is a message, "
        "use its field, as in info(f'{{message.data}}').",
    ),
    (
        r"^TypeError: (?:\w+\.)*?(?P<what>\w+)(?:\.__init__)?\(\) (?:takes|missing|got an unexpected)",
        "",
        "Compare your call of {what} with its definition, the line that begins with def, or with the lab's text. The "
        "call needs the same number of values in the same order, and the same names before each =. In a method, self "
        "is the first parameter; Python passes it for you. If ROS should call {what} later, pass only its name, "
        "without parentheses.",
    ),
    (
        r"Invalid(?:Topic|Service|Node|Namespace)\w*NameException|InvalidNamespaceException|due to invalid topic name",
        "A name in ROS consists of letters, digits and underscores. It does not begin with a digit or end with a "
        "slash.",
        "Change the name, for example `my name` or `my-name` to my_name.",
    ),
    (
        r"^IndexError: (?P<kind>list|string|tuple|array) (?:assignment )?index out of range",
        "The {kind} has no element with this index: the first element has the index 0, the last one len(...) - 1.",
        "Use an index from 0 to len(...) - 1. If a callback increases the index each time it is called, the index "
        "becomes too large: check it with an `if`.",
    ),
    (
        r"^(?:IndexError: pop from (?:an )?empty|(?:RuntimeError: (?:coroutine|generator) raised )?StopIteration)",
        "Your code takes an element, but none is left.",
        "A callback is called many times. If it takes one element each time, none is left in the end. Check with an "
        "`if` whether an element is left, or count instead.",
    ),
    (
        r"^ValueError: generator already executing",
        "Two threads spin the same executor at the same time. rclpy.spin(node) uses one executor for the whole "
        "program.",
        "Call spin in one place only, on one executor with all your nodes: executor = MultiThreadedExecutor(), "
        "executor.add_node(...) for each node, executor.spin(). Or give each thread its own executor: "
        "rclpy.spin(node, executor).",
    ),
    (
        r"^ValueError: (?:invalid literal for int\(\) with base \d+|could not convert string to float): (?P<text>.+)",
        "{text} is not a number.",
        "Find the line that sets this value. On a command line, the arguments begin with sys.argv[1]; sys.argv[0] is "
        "the name of the program.",
    ),
    (
        r"attempted invalid transition from state",
        "Your code ended a goal twice, or ended it as canceled although no client had asked for that.",
        "End each goal exactly once, below the loop: call canceled() if is_cancel_requested of the goal handle is "
        "True; otherwise call succeed().",
    ),
    (
        r"^ +File ",
        "",
        "Read the traceback from the bottom. The last line says what went wrong; the lines above it say where. "
        "Correct the line that is in your code.",
    ),
    (
        r"",
        "",
        "This error was raised inside ROS. Look at what your code passes to ROS: at each create_... and each spin, "
        "compare the types, names and methods, and their order, with the lab's text.",
    ),
)
"""The entries for errors in a running program, of which the last matches every traceback."""


def meaning(traceback: str) -> Meaning:
    """Return the meaning of the error with which a traceback ends."""
    for pattern, why, next_step in (*READING, *RUNNING):
        found = _compiled(pattern).search(traceback)
        if found is not None:
            words = names(traceback) | {name: Name(said or "") for name, said in found.groupdict().items()}
            return Meaning(why.format(**words), next_step.format(**words))
    raise AssertionError("the last row matches every traceback")


@cache
def _compiled(pattern: str) -> Any:
    return re2.compile(f"(?m){pattern}")


_FRAME_WITH_CODE = re2.compile(r'(?m)^ {2}File "(?P<file>[^"]*)", line \d+.*\n {4,}(?P<code>\S.*)$')
"""Matches a frame of a traceback and the line of code quoted below it."""
_LIBRARY = re2.compile(r"/lib/python3(?:\.\d+)?/|/(?:site|dist)-packages/|^/opt/ros/|^<frozen")
_BUILT = re2.compile(
    r"/install/(?:[^/.]+/)?(?:local/)?lib/python3[^/]*/(?:site|dist)-packages/(?P<package>\w+)"
)
"""Matches the path of a package that colcon has installed: the student's package, or a package of ROS if ROS was built
from source.
"""
_ROS = ("rclpy", "launch", "launch_ros", "ros2cli", "ros2run")
_MISSED = re2.compile(r"AttributeError: .*(?:has no attribute|object attribute) '(?P<name>\w+)'")
_OWNER = r"(?:^|[^\w.)\]])(?P<owner>[A-Za-z_][\w.]*(?:(?:\(\)|\[[^\[\]]*\])[\w.]*)*)\.{name}\b"
"""Matches the expression before a dot and a given name, if it consists of names, dots, calls without arguments and
indexes.
"""
_RESULT = ".result()"


class Name(str):
    """A name for a template. In ``{owner:your future}``, the text after the colon is used if the name is empty."""

    __slots__ = ()

    def __format__(self, otherwise: str) -> str:
        return str(self) or otherwise


def is_a_library(file: str) -> bool:
    """Return True for a file of Python, ROS or an installed package, but False for a student's own package."""
    built = _BUILT.search(file)
    return _LIBRARY.search(file) is not None and (built is None or built["package"] in _ROS)


def own_line(traceback: str) -> str:
    """Return the innermost line of code in a traceback if it is the student's; otherwise an empty text."""
    frames = list(_FRAME_WITH_CODE.finditer(traceback))
    return "" if not frames or is_a_library(frames[-1]["file"]) else str(frames[-1]["code"])


def names(traceback: str) -> dict[str, Name]:
    """Return the names from a traceback that templates can use: ``owner`` and ``future``; each is empty if unknown.

    Suppose that ``fut.result().sum`` fails because ``sum`` does not exist. Then the owner is ``fut.result()``, and the
    future is ``fut``. If the future is itself a call, such as ``make().result()``, its name stays empty, because each
    call would return a different future.
    """
    owner = _owner(traceback)
    future = owner.removesuffix(_RESULT) if owner.endswith(_RESULT) else ""
    return {"owner": Name(owner), "future": Name("" if "(" in future else future)}


def _owner(traceback: str) -> str:
    """Return the expression before the missing attribute in the student's line; empty if there are several."""
    missed = _MISSED.search(traceback)
    if missed is None:
        return ""
    pattern = _OWNER.replace("{name}", missed["name"])
    found = {one["owner"] for one in re2.finditer(pattern, own_line(traceback))}
    return str(found.pop()) if len(found) == 1 else ""
