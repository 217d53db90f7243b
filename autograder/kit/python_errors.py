"""Python's own errors in a beginner's node: one row for each wording, with its meaning and the next step.

The rows were made from what Python 3.11 and 3.12 and rclpy 7.1 print. The first one that fits wins.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import re2

from autograder.kit.python_names import MARKS, NAMES
from autograder.kit.python_syntax import CALLS, READING
from autograder.kit.quoted_names import Name, names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.python_names import Row


class Meaning(NamedTuple):
    """The meaning of an error.

    Attributes:
        why: What is wrong, in a sentence; it may be empty.
        next_step: What to do now.
    """

    why: str
    next_step: str


RUNNING: Sequence[Row] = (
    *NAMES,
    (
        r'^TypeError: can only concatenate str \(not "(?P<kind>list|tuple|dict|array|NoneType)"\)',
        "A string and a value of the type {kind} are joined with +, which joins strings only.",
        "Put the value into an f-string, in braces, as in f'... {{number}}'.",
    ),
    (
        r'^TypeError: can only concatenate str \(not "(?P<type>[A-Z]\w*)"\)',
        "A string and a whole {type} are joined with +.",
        "The string of a message is in its field data: write that field, with a dot, after the name that your method "
        "has for the message, as in message.data.",
    ),
    (
        r"^TypeError: (?:can only concatenate str|unsupported operand type\(s\) for \+=?: '(?:int|float|str)' and "
        r"'(?:int|float|str)')",
        "A string and a number are added.",
        "To join them to a string, write f'... {{number}}'. To add numbers, turn the string into a number "
        "first: int(...).",
    ),
    (
        r"^TypeError: unsupported operand type\(s\) for .*'property'",
        "A field is taken from a type here, and only an object of this type has a value in it.",
        "Take it from what the method was given, as in request.a, and not from AddTwoInts.Request.",
    ),
    (
        r"^TypeError: (?:unsupported operand type\(s\) for|'[<>]=?' not supported between).*'\w+_(?P<part>Request"
        r"|Response|Goal|Result|Feedback)'",
        "A whole {part} is used as if it were a number.",
        "Name its field, with a dot, as in request.a, response.sum or goal.order. If you gave ROS a function of "
        "Python's own as a callback, such as max, write a method of your own.",
    ),
    (
        r"^TypeError: 'NoneType' object is not (?:iterable|subscriptable)",
        "A list is needed here, and the value is None.",
        "append changes the list and returns None: write it alone, as in numbers.append(...), without numbers = before "
        "it. If the value comes from a function of yours, look for a missing return.",
    ),
    (
        rf"\b(?P<table>[A-Za-z_][\w.]*)\[(?P<what>[\w.()]+)\].*{MARKS}TypeError: unhashable type: '(?P<kind>\w+)'",
        "A value of the type {kind} cannot be looked up in a dictionary.",
        "Look up one of its fields, with a dot, as in {table}[{what}.status].",
    ),
    (
        # The executor keeps its nodes in a set; a notebook's traceback leaves rclpy's own lines out.
        r"(?:\A|rclpy/executors\.py\".*\n(?: .*\n){1,2})TypeError: unhashable type: '(?P<class>\w+)'",
        "ROS cannot keep your node: its class {class} has no hash, which @dataclass, or a method __eq__ of the class, "
        "takes away.",
        "A node cannot be a `@dataclass`: delete that word, and write def __init__(self): with "
        "super().__init__('your_node_name') as its first line. Set the fields below that, as in self.count = 0.",
    ),
    (
        r"^TypeError: unhashable type: '(?P<kind>\w+)'",
        "A value of the type {kind} cannot be a key of a dictionary or an element of a set.",
        "Take a number, a string, or one field of the value in its place, as in STATUS_NAMES[answer.status].",
    ),
    (
        # A notebook's traceback leaves out rclpy's own line, which reads node.subscriptions.
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
        rf"(?:\b(?P<list>[A-Za-z_][\w.]*)\.append\(.*{MARKS})?TypeError: list\.append\(\) takes exactly one argument",
        "append puts a single value at the end of a list.",
        "Give it one value, as in {list:numbers}.append({list:numbers}[-2] + {list:numbers}[-1]).",
    ),
    (
        r"^TypeError: can only concatenate list",
        "A list and something that is no list are joined with +.",
        "To put one more value at the end of a list, append it, as in numbers.append(value).",
    ),
    (
        r"^TypeError: '(?P<kind>method|function|builtin_function_or_method)' object is not (?:subscriptable|iterable)",
        "A method is used as if it were its answer.",
        "Write parentheses after its name: that calls it.",
    ),
    (
        rf"\bsum\(.*{MARKS}TypeError: '(?P<kind>int|float|\w+_Request)' object is not iterable",
        "Python's own sum adds up the numbers of a list, and what it got is of the type {kind}.",
        "Two numbers are added with +, as in response.sum = request.a + request.b.",
    ),
    (
        r"^TypeError: '(?P<kind>[A-Z]\w*_?\w*)' object is not (?:subscriptable|iterable)",
        "An object of the type {kind} is no list and no dictionary.",
        "Take its field, with a dot, as in message.data, request.a or answer.result.sequence.",
    ),
    (
        r"^TypeError: type '(?P<kind>\w+)' is not subscriptable",
        "{kind} is a type, and no list and no dictionary.",
        "Take the list or the dictionary that you mean, as in STATUS_NAMES[answer.status].",
    ),
    (
        r"^TypeError: '(?P<kind>int|float|bool)' object is not (?:subscriptable|iterable)",
        "A list is needed here, and the value is a single one, of the type {kind}.",
        "Give it the whole list, as in partial_sequence=numbers, or leave out the square brackets after the value.",
    ),
    (
        r"^TypeError: '[<>]=?' not supported between instances of (?:'list' and|'\w+' and 'list')",
        "A whole list is compared with a single value.",
        "Compare its length, as in len(numbers), or one of its elements, as in numbers[-1].",
    ),
    (
        r"^TypeError: '[<>]=?' not supported between instances of '\w+' and '\w+'",
        "Two things that have no order are compared, such as a string with a number.",
        "Turn the string into a number first: int(...) or float(...).",
    ),
    (
        r"(?:create_timer\((?P<called>[A-Za-z_][\w.]*), *(?P<seconds>[\d.]+)\)(?:.*\n)+?)?"
        r"TypeError: float\(\) argument must be a string or a real number, not '(?:method|function)'",
        "The timer got the method where the period belongs.",
        "First the seconds, then the method: create_timer({seconds:0.5}, {called:self.your_method}).",
    ),
    (
        r"timer period must be non-negative",
        "The period of a timer is less than 0.",
        "Give it in seconds, as in create_timer(0.5, self.your_method).",
    ),
    (
        # Raised where rclpy calls the callback; a notebook's traceback leaves rclpy's own lines out.
        r"(?:\A|rclpy/(?:executors|task)\.py\".*\n(?: .*\n){1,2})TypeError: '(?P<kind>\w+)' object is not callable",
        "ROS was to call a method of yours, and was given a value of the type {kind} in its place.",
        "Look at what create_timer(...), or whatever takes a callback, has in this place: the name of the method, with "
        "self. before it, and without quotation marks or parentheses, as in create_timer(0.5, self.say_hello).",
    ),
    (
        r"^TypeError: 'NoneType' object is not callable",
        "What is called in this line is None.",
        "Look at the line that sets it. If that is to be a function, write the function's name there without "
        "parentheses: with them, it is what the function returns.",
    ),
    (
        r"^TypeError: '(?P<kind>int|float|str|bool|list|dict|array|String|Publisher|Timer|Client|Service)' object "
        r"is not callable",
        "A value of the type {kind} is called as if it were a method.",
        "To read the value, leave out the parentheses; to set it, write = after its name. A list or a dictionary takes "
        "square brackets: names[key]. If you mean a method of this name, give the value another name.",
    ),
    (
        r"^TypeError: '(?P<kind>\w+_(?:Request|Response|Goal|Result|Feedback))' object is not callable",
        "An object of the type {kind} is called as if it were a function.",
        "Leave out the parentheses after it, and name its field with a dot, as in response.sum = ..., or "
        "answer.result.sequence.",
    ),
    (
        r"^TypeError: '(?P<kind>GoalResponse|CancelResponse)' object is not callable",
        "What {kind} holds are constants, and they are not called.",
        "Leave out the parentheses after it: return {kind}.ACCEPT.",
    ),
    (
        r"^TypeError: (?:\w+\.)?(?P<level>debug|info|warning|warn|error|fatal)\(\) takes 2 positional arguments but",
        "{level} takes a single string: it does not join several values, as print does.",
        "Put the values into one f-string, in braces, as in {level}(f'I heard: {{message.data}}').",
    ),
    (
        r"^TypeError: rclpy_logging_rcutils_log\(\): incompatible function arguments",
        "A log line is a string, and the logger got something else, such as a number or a whole message.",
        "Put the value into an f-string, in braces, as in info(f'{{response.sum}}'). Of a message take the field, as "
        "in info(f'{{message.data}}').",
    ),
    *CALLS,
    (
        r"Invalid(?:Topic|Service|Node|Namespace)\w*NameException|InvalidNamespaceException",
        "A name in ROS has letters, digits and underscores only, no digit at its beginning, and no slash at its end.",
        "Change the name: my_topic, in place of `my topic` or `my-topic`.",
    ),
    (
        r"ParameterNotDeclaredException",
        "A parameter is read that the node has not declared.",
        "Declare it in __init__, with its default: self.declare_parameter('name', 1.0).",
    ),
    (
        r"^RecursionError",
        "A method calls itself again and again.",
        "Let ROS call a callback: hand it to a timer or a subscription, and do not call it inside itself.",
    ),
    (
        r"^IndexError: (?P<kind>list|string|tuple|array) (?:assignment )?index out of range",
        "The {kind} has fewer elements than the index asks for: the first element has the index 0, the last one "
        "len(...) - 1.",
        "Ask for an index from 0 to len(...) - 1. In a callback, which is called again and again, a number that grows "
        "with each call becomes too large: stop it with an `if`.",
    ),
    (
        r"^IndexError: pop from (?:an )?empty (?P<kind>list|deque|set)",
        "The {kind} has no element left to take.",
        "A callback is called again and again: what it takes one by one is used up. Do without the {kind}, or let the "
        "callback do something else when none is left.",
    ),
    (
        r"^(?:RuntimeError: (?:coroutine|generator) raised )?StopIteration",
        "next(...) asked for one more, and none was left.",
        "Take the values in a for loop, or give next(...) a second argument, which it returns at the end: "
        "next(values, None).",
    ),
    (
        r"^ValueError: generator already executing",
        "Two threads spin at once by the same executor. rclpy.spin(node) uses one executor for the whole program.",
        "Spin once, by one executor that has all your nodes: executor = MultiThreadedExecutor(), "
        "executor.add_node(...) for each of them, executor.spin(). Or give each thread an executor of its own: "
        "rclpy.spin(node, executor).",
    ),
    (
        r"^ValueError: (?:not enough|too many) values to unpack \(expected (?P<names>\d+)",
        "Left of the = are {names} names, but the value has another number of parts.",
        "Print the value above that line and count its parts: a string without a space, for example, has one part.",
    ),
    (
        r"^ValueError: (?:invalid literal for int\(\) with base \d+|could not convert string to float): (?P<text>.+)",
        "{text} is not a number.",
        "Look where it comes from. On a command line the arguments begin with sys.argv[1]; sys.argv[0] is the program "
        "itself.",
    ),
    (
        r"^KeyError: (?P<key>.+)",
        "The dictionary has no entry {key}.",
        "Compare it with the entries of the dictionary, and add it if it is missing. A name in quotation marks is a "
        "string; to look up the value of a variable, leave them out, as in names[answer.status].",
    ),
    (
        r"^OverflowError: .*(?:greater than|less than|too (?:large|small|big))",
        "A number does not fit into its field: the largest int32 is 2147483647.",
        "Count how many numbers your loop makes: together with the two of the beginning there are order + 1. An order "
        "that is too large is to be rejected.",
    ),
    (
        r"attempted invalid transition from state (?P<state>SUCCEEDED|CANCELED|ABORTED) with",
        "The goal had ended already, as {state}, and this line ends it once more.",
        "End each goal once: below the loop, in the same column as its while, write `if` with canceled() and `else` "
        "with succeed().",
    ),
    (
        r"(?:^ +(?P<handle>[A-Za-z_][\w.]*)\.canceled\((?:.*\n)+?)?.*"
        r"attempted invalid transition from state \w+ with event CANCELED",
        "canceled() was called for a goal that no client has asked to cancel.",
        "Call canceled() only where {handle:your_goal_handle}.is_cancel_requested is True, and succeed() where it is "
        "not.",
    ),
    (
        r"^ZeroDivisionError",
        "What is right of the / or % is 0.",
        "A 0 may arrive, too: check with `if` before you divide, or leave the division out.",
    ),
    (
        r"^TypeError: '(?P<kind>\w+)' object cannot be interpreted as an integer",
        "A value of the type {kind} was given where a whole number belongs.",
        "Leave out the str(...) or the quotation marks around it; int(...) makes a whole number of a string.",
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
"""Python's words about a program that runs."""


def meaning(traceback: str) -> Meaning:
    """The meaning of the error at the end of a traceback."""
    for pattern, why, next_step in (*READING, *RUNNING):
        found = _compiled(pattern).search(traceback)
        if found is not None:
            words = names(traceback) | {name: Name(said or "") for name, said in found.groupdict().items()}
            return Meaning(why.format(**words), next_step.format(**words))
    raise AssertionError("the last row fits everything")


@cache
def _compiled(pattern: str) -> Any:
    return re2.compile(f"(?m){pattern}")
