"""Python's own errors in beginners' programs: for each wording of an error, its meaning and the next step.

The rows match messages of Python 3.11 and 3.12 and of rclpy 7.1. The first match wins. Add a row only if two answers
in the bank, or a question asked in public, need it: the card quotes Python's own message anyway.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import re2

from autograder.kit.mistakes.names_in_tracebacks import MARKS, Name, names

if TYPE_CHECKING:
    from collections.abc import Sequence

Row = tuple[str, str, str]
"""A pattern to search for in a traceback, the meaning, and the next step. Both texts may use the pattern's groups."""


class Meaning(NamedTuple):
    """What an error means, and what to do about it.

    Attributes:
        why: A sentence that says what is wrong; it may be empty.
        next_step: What the student should do now.
    """

    why: str
    next_step: str


_READS = r"^(?:SyntaxError|IndentationError|TabError): "
READING: Sequence[Row] = (
    (
        rf"{_READS}expected ':'",
        "A colon is missing.",
        "Write a colon at the end of that line: class, def, if, else, for, while, try and with all end with one.",
    ),
    (
        rf"{_READS}(?:'.' was never closed|unmatched|incomplete input)",
        "",
        "Count the brackets of that line: each one that is opened must be closed.",
    ),
    (
        rf"{_READS}(?:unterminated|EOL while scanning|f-string: expecting)",
        "A string does not end.",
        "Close it with the quotation mark that it begins with, and each {{ in an f-string with a }}.",
    ),
    (
        rf"{_READS}invalid (?:non-printable )?character",
        "That line has a character of a word processor or a web page in it.",
        "Type the line yourself: quotation marks are ' or \" and a minus is -.",
    ),
    (
        r"^(?:IndentationError|TabError): |^SyntaxError: 'return' outside",
        "",
        "Indent by four spaces, without tabs, the lines that belong to a line with a colon at its end. All lines of "
        "one block begin in the same column.",
    ),
    (
        _READS,
        "",
        "Go to the line that the message names; a bracket, a quote, a colon or the indentation is off there or just "
        "before it.",
    ),
)
"""Messages with which Python reports that it cannot parse a program."""

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
"""Names that beginners often import from the wrong module, or forget to import, by the right module."""
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
            f"Write `from {module} import {{name}}` at the top of the program, and take {{name}} out of any other "
            "import. In a notebook, run the cell with the imports.",
        )
        for module, names in _IMPORTED_FROM.items()
    ),
    (
        r"^NameError: name '(?P<name>\w+_(?:msgs|srvs|interfaces)|math|random|rclpy|sys|threading|time)'",
        "{name} is a module, and it is not imported.",
        "Write import {name} at the top of the program. In a notebook, write it in the cell with the imports, and run "
        "that cell. A type that has an import of its own is written alone: String in place of std_msgs.msg.String.",
    ),
    (
        r"^NameError: name 'self'",
        "Python knows self only inside a method whose first argument is self.",
        "In a method write self first between its parentheses, as in def say_hello(self), and indent its lines by "
        "eight spaces. In a function there is no self: write the name that the node has there, such as node or client.",
    ),
    (
        r"^NameError: name '(?P<name>\w+)' is not defined\. Did you mean: '(?P<meant>[\w.]+)'",
        "Python does not know {name}, and knows {meant}.",
        "If that is what you mean, write {meant}. If {name} belongs to your node, write self.{name}. In a notebook, "
        "run the cell that defines it, if there is one. In a program, write or copy its definition into this file.",
    ),
    (
        r"^NameError: name '(?P<name>\w+)'",
        "Python does not know {name}.",
        "If it belongs to your node, as a value or a method, write self.{name}, also in the line that sets it. If it "
        "is part of a message or a goal, write that before it, with a dot. In a notebook, run the cell that defines "
        "it, if there is one. In a program, write, copy or import it in this file. Otherwise compare the spelling.",
    ),
    (
        r"^(?:UnboundLocalError: )(?:cannot access local variable|local variable) '(?P<name>\w+)'",
        "Without self. before it, {name} is a variable of this method alone, and has no value yet.",
        "If it is a value of the node, write self.{name}, here and in all other lines that use it.",
    ),
    (
        r"^ImportError: cannot import name",
        "",
        "Compare the import with the lab's text, letter by letter: is it .msg, .srv or .action, are the capitals the "
        "same, and is no letter missing?",
    ),
    (
        r"'NoneType' object (?:has no attribute '\w+'|is not (?:iterable|subscriptable))",
        "{owner:A value of this line} is None: it was not set yet, or it is what a function without a return gives, as "
        "append of a list does.",
        "Look where it gets its value, and whether that line has run before this one.",
    ),
    (
        r"'(?:builtin_function_or_method|function|method)' object (?:has no attribute|is not)",
        "{owner:A value of this line} is a method that was not called, and not what it returns.",
        "Write parentheses after the method's name, in this line or in the line that sets the value, as in "
        "self.get_logger().info(...).",
    ),
    (
        rf"AttributeError: '(?P<class>{_NOT_STUDENTS})' object has no attribute '(?P<name>\w+)'",
        "{owner:The value before .{name}} is of the type {class} here, which has nothing called {name}.",
        "Look at the line that sets it: the value may not be the one that you mean. If it is the right one, compare "
        "the name, letter by letter. If {name} is a function of the notebook or program, write it alone: {name}(...).",
    ),
    (
        r"^AttributeError: '(?P<class>\w+)' object has no attribute '(?P<name>\w+)'\. Did you mean: '(?P<meant>\w+)'",
        "{class} has nothing called {name}, and has {meant}.",
        "If that is what you mean, write {meant}. If {name} is something else, write it in the class: a value as "
        "self.{name} = ... in __init__, a method as def {name}(self, ...).",
    ),
    (
        r"^AttributeError: '(?P<class>\w+)' object has no attribute '(?P<name>\w+)'",
        "{class} has nothing called {name} so far.",
        "If it is a value, set it in __init__, above the line that needs it, with self. before it there, too: without "
        "self. it is forgotten at the end of the method. If it is a method, compare its name and its indentation, "
        "which is that of def __init__. If it is a variable or a function outside of the class, leave out what is "
        "before the dot.",
    ),
    (
        r"^AttributeError: property '(?P<name>\w+)' of '(?P<class>\w+)' object has no setter",
        "{name} of {class} can only be read.",
        "If you want to store a value of your own, give it a name other than {name}.",
    ),
    (
        r"AttributeError: partially initialized module '(?P<name>[\w.]+)'",
        "A file of yours is called like the module {name}, and Python imports that instead.",
        "Give your file another name.",
    ),
    (
        r"^AttributeError: ",
        "There is nothing of this name there.",
        "Compare the name with the lab's text, letter by letter: constants have capitals only, such as "
        "GoalResponse.ACCEPT.",
    ),
    (
        r"^TypeError: (?:can only concatenate str|unsupported operand type\(s\) for \+=?: '(?:int|float|str)' and "
        r"'(?:int|float|str)')",
        "A string and another value are joined with +, which joins strings only.",
        "Put the value into an f-string, in braces, as in f'... {{number}}'; of a message take the field, as in "
        "{{message.data}}. To add numbers, turn the string into a number first: int(...).",
    ),
    (
        # The executor keeps its nodes in a set, which needs a hash. A notebook's traceback omits rclpy's own lines.
        r"(?:\A|rclpy/executors\.py\".*\n(?: .*\n){1,2})TypeError: unhashable type: '(?P<class>\w+)'",
        "ROS cannot keep your node: its class {class} has no hash, which @dataclass, or a method __eq__ of the class, "
        "takes away.",
        "A node cannot be a `@dataclass`: delete that word, and write def __init__(self): with "
        "super().__init__('your_node_name') as its first line. Set the fields below that, as in self.count = 0.",
    ),
    (
        # A notebook's traceback omits rclpy's own line, in which node.subscriptions is read.
        rf"(?:\bspin\w*\((?P<class>[A-Za-z_]\w*)[,)].*\n(?:.*\n)*?|node\.subscriptions.*{MARKS})"
        r"TypeError: 'property' object is not iterable",
        "A spin takes a node, and got the class of one.",
        "Write parentheses after the class, which makes a node of it: rclpy.spin({class:YourNode}()).",
    ),
    (
        r"^TypeError: (?P<class>\w+) is not a Node: write class",
        "",
        "A check spins your class, so the class is the node: write class {class}(Node):, "
        "super().__init__('your_node_name') as the first line of its __init__, and self.create_... below that.",
    ),
    (
        r"^TypeError: '(?P<kind>\w+)' object is not (?:subscriptable|iterable)",
        "A value of the type {kind} is neither a list nor a dictionary.",
        "Of a message take the field, with a dot, as in message.data or answer.result.sequence. If a list is "
        "needed, give the whole list. Two numbers are added with +, and not with sum.",
    ),
    (
        # The error is raised where rclpy calls the callback; a notebook's traceback omits rclpy's own lines.
        r"(?:\A|rclpy/(?:executors|task)\.py\".*\n(?: .*\n){1,2})TypeError: '(?P<kind>\w+)' object is not callable",
        "ROS was to call a method of yours, and was given a value of the type {kind} in its place.",
        "Look at what create_timer(...), or whatever takes a callback, has in this place: the name of the method, with "
        "self. before it, and without quotation marks or parentheses, as in create_timer(0.5, self.say_hello).",
    ),
    (
        r"^TypeError: '(?P<kind>\w+)' object is not callable",
        "A value of the type {kind} is called as if it were a method.",
        "To read the value, leave out the parentheses; to set it, write = after its name. A list or a dictionary takes "
        "square brackets: names[key]. If you mean a method of this name, give the value another name.",
    ),
    (
        r"^TypeError: rclpy_logging_rcutils_log\(\): incompatible function arguments",
        "A log line is a string, and the logger got something else, such as a number or a whole message.",
        "Put the value into an f-string, in braces, as in info(f'{{response.sum}}'). Of a message take the field, as "
        "in info(f'{{message.data}}').",
    ),
    (
        r"^TypeError: (?:\w+\.)*?(?P<what>\w+)(?:\.__init__)?\(\) (?:takes|missing|got an unexpected)",
        "",
        "Compare your call with the first line of {what}, def ..., or with the lab's text. The call needs as many "
        "values in the same order, and the same name left of each =. In a method, self counts as one of the values. "
        "If ROS is to call {what} later, write its name alone, without parentheses.",
    ),
    (
        r"Invalid(?:Topic|Service|Node|Namespace)\w*NameException|InvalidNamespaceException|due to invalid topic name",
        "A name in ROS has letters, digits and underscores only, no digit at its beginning, and no slash at its end.",
        "Change the name: my_name instead of `my name` or `my-name`.",
    ),
    (
        r"^IndexError: (?P<kind>list|string|tuple|array) (?:assignment )?index out of range",
        "The {kind} has fewer elements than the index asks for: the first element has the index 0, the last one "
        "len(...) - 1.",
        "Ask for an index from 0 to len(...) - 1. In a callback, which is called again and again, a number that grows "
        "with each call becomes too large: stop it with an `if`.",
    ),
    (
        r"^(?:IndexError: pop from (?:an )?empty|(?:RuntimeError: (?:coroutine|generator) raised )?StopIteration)",
        "There is no element left to take.",
        "A callback is called again and again: what it takes one by one is used up. Let it count, or do something else "
        "when nothing is left.",
    ),
    (
        r"^ValueError: generator already executing",
        "Two threads spin at once by the same executor. rclpy.spin(node) uses one executor for the whole program.",
        "Spin in one place only, by one executor that has all your nodes: executor = MultiThreadedExecutor(), "
        "executor.add_node(...) for each of them, executor.spin(). Or give each thread an executor of its own: "
        "rclpy.spin(node, executor).",
    ),
    (
        r"^ValueError: (?:invalid literal for int\(\) with base \d+|could not convert string to float): (?P<text>.+)",
        "{text} is not a number.",
        "Look where it comes from. On a command line the arguments begin with sys.argv[1]; sys.argv[0] is the program "
        "itself.",
    ),
    (
        r"attempted invalid transition from state",
        "A goal ends once, and as canceled only if a client has asked for that.",
        "End each goal once: below the loop, call canceled() if is_cancel_requested of the goal handle is True, and "
        "succeed() if it is not.",
    ),
    (
        r"^ +File ",
        "",
        "Read the traceback from the bottom: the last line says what, the lines above it where. Correct the line "
        "that is yours.",
    ),
    (
        r"",
        "",
        "ROS raised this in code of its own. Compare what your code gives to ROS, between the parentheses of each "
        "create_... and of what spins, with the lab's text: types, names, methods and their order.",
    ),
)
"""Messages with which Python reports an error in a running program."""


def meaning(traceback: str) -> Meaning:
    """Return the meaning of the error with which a traceback ends."""
    for pattern, why, next_step in (*READING, *RUNNING):
        found = _compiled(pattern).search(traceback)
        if found is not None:
            words = names(traceback) | {name: Name(said or "") for name, said in found.groupdict().items()}
            return Meaning(why.format(**words), next_step.format(**words))
    raise AssertionError("the last row fits everything")


@cache
def _compiled(pattern: str) -> Any:
    return re2.compile(f"(?m){pattern}")
