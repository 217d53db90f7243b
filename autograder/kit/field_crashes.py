"""Mistakes with a message, its type and its fields that a traceback gives away: these rows of ``known_crashes``.

The order matters: the first that fits wins.
"""

from __future__ import annotations

from dataclasses import dataclass

from autograder.kit.python_names import MARKS

_CALLED = r"\n(?: .*\n)*"
"""From a line of code to what Python says of it: a program's traceback has the lines of the message's own module."""


@dataclass(frozen=True)
class Crash:
    """A known traceback.

    Attributes:
        key: The mistake's name.
        pattern: Found in the traceback (multi-line search); its groups may be named in ``text``.
        text: What happened and why.
        next_step: What to do now.
    """

    key: str
    pattern: str
    text: str
    next_step: str


FIELDS = (
    Crash(
        "field_type",
        r"(?:^ +(?P<part>(?:\w+\.)+(?:linear|angular)) *=[^=].*\n(?:.*\n)*)?"
        r".*field must be a sub message of type 'Vector3'"
        r"|publish\(msg\)\n(?:[ ~^]*\n)?AttributeError: '(?:float|int)' object has no attribute 'x'",
        "A part of a message that has three numbers got a single one.",
        "Name the number that you mean: x, y or z, as in {part:command.linear}.x = 0.5.",
    ),
    Crash(
        "field_type",
        r"The '(?P<field>\w+)' field must be of type 'float'",
        "The field {field} of a message takes a decimal number, and got something else.",
        "Write the number with a point and without quotation marks: 0.5, and 1.0 in place of 1. "
        "float(...) makes a number of a string.",
    ),
    Crash(
        "field_type",
        r"The '(?P<field>\w+)' field must be of type 'int'",
        "The field {field} of a message takes one whole number, and got something else.",
        "Give it a single number: int(...) makes one of a string or of 2.0. Without quotation marks, str(...) or a "
        "comma beside it, a number is a whole number already.",
    ),
    Crash(
        "field_type",
        r"The '(?P<field>\w+)' field must be an integer in (?P<range>\[[^\]]*\])",
        "The field {field} of a message got a number that is too large or too small for it: it takes {range}.",
        "Look at what makes this number. A number that has gone through float(...), or a / in place of //, is not "
        "exact any more: add and multiply whole numbers.",
    ),
    Crash(
        "field_type",
        r"The '(?P<field>\w+)' (?:field|numpy\.ndarray) must|bad argument type for built-in operation"
        r"|AssertionError: The '",
        "A field of a message got a value of the wrong type.",
        "Convert it before you assign: int(...) for an int64, str(...) for a string. Command-line arguments "
        "are strings.",
    ),
    Crash(
        "field_type",
        r"SystemError: <(?:function|class|built-in).*returned (?:a result with an exception|NULL)",
        "A field of a message got a value that it cannot take: of another type, or a number that is too large for it.",
        "Print the value, and its type(...), above the line that assigns it. int(...) makes a whole number of a "
        "string; a sum of whole numbers fits if no float(...) has rounded it on the way.",
    ),
    Crash(
        "field_typo",
        r"^NameError: name '(?P<name>linear|angular)' is not defined",
        "{name} is a part of your message, and Python knows it only together with this message.",
        "Write your message before it, with a dot, as in command.linear.x = 0.5.",
    ),
    Crash(
        "callback_signature",
        # What each node has, and no message.
        rf"\bself\.(?:get_logger|get_clock|create_\w+)\b.*{MARKS}AttributeError: '(?P<type>String|Twist|U?Int\d+"
        r"|\w+_(?:Request|Response|Goal|FeedbackMessage)|ServerGoalHandle|Future)' object has no attribute "
        r"'(?:get_logger|get_clock|create_\w+)'",
        "self is of the type {type} here: ROS hands it over behind the node itself, and Python gives the node to the "
        "first name between the parentheses after def.",
        "Write self first, and then the others, as in def on_message(self, message) or def add(self, request, "
        "response).",
    ),
    Crash(
        "field_typo",
        r"AttributeError: 'Twist' object has no attribute '(?P<name>\w+)'",
        "A Twist has no field called {name}: it has two parts, linear and angular, and each has the numbers x, y "
        "and z.",
        "Name the part, too: {owner:command}.linear.x is the speed straight ahead, {owner:command}.angular.z the turn "
        "to the left.",
    ),
    Crash(
        "field_typo",
        r"AttributeError: '\w+_FeedbackMessage' object has no attribute '(?P<name>\w+)'",
        "The message has no field called {name}.",
        "In an action's feedback callback the fields are one level down: {owner:message}.feedback.partial_sequence. "
        "The handle of the goal is not in it: the node that has sent the goal keeps it, as in self.goal_handle.",
    ),
    Crash(
        "field_typo",
        r"AttributeError: '\w+_Goal' object has no attribute 'request'",
        "Your goal_callback is given the goal itself; only a goal handle has the goal in its attribute request.",
        "Write {owner:goal}.order there; in the execute_callback the order is in .request.order of the goal handle. If "
        "this function is to do the work, write execute_callback= before its name, and goal_callback= before the "
        "other.",
    ),
    Crash(
        "field_typo",
        r"AttributeError: '\w+_GetResult_Response' object has no attribute '(?P<name>\w+)'",
        "The answer to get_result_async() has two parts, result and status, and no {name}.",
        "The fields of the result are one level down: {owner:answer}.result.sequence. The number of the status is "
        "{owner:answer}.status.",
    ),
    Crash(
        "field_typo",
        r"(?:(?P<answer>[A-Za-z_][\w.]*(?:\(\))?)\.result\.status\b.*\n(?:[ ~^]*\n)?)?"
        r"AttributeError: '\w+_Result' object has no attribute 'status'",
        "The status is not in the result: it comes beside it.",
        "Take it from what the wait gave you: {answer:answer}.status, and {answer:answer}.result.sequence for the "
        "numbers.",
    ),
    Crash(
        "field_type",
        r"AttributeError: '(?P<type>\w+)_(?P<part>Request|Response|Goal|Result|Feedback)' object attribute "
        r"'(?P<field>\w+)' is read-only",
        "The field {field} was set on the type {type}.{part} itself, by this code or by an older version of it. Now no "
        "object of this type can be filled any more.",
        "Write parentheses after each {type}.{part} that makes an object: {type}.{part}(). Then choose Kernel, Restart "
        "Kernel and Run All Cells: only this makes the type whole again.",
    ),
    Crash(
        "field_type",
        r"AttributeError: '(?P<type>\w+)' object attribute '(?P<field>\w+)' is read-only",
        "The field {field} was set on the type {type} itself, by this code or by an older version of it. Now no "
        "message of this type can be filled any more.",
        "Write parentheses after each {type} that makes a message: {owner:message} = {type}(). Then choose Kernel, "
        "Restart Kernel and Run All Cells: only this makes the type whole again.",
    ),
    Crash(
        "field_typo",
        r"AttributeError: 'AddTwoInts_(?P<part>Request|Response)' object has no attribute '(?P<name>\w+)'"
        rf"|AddTwoInts\.(?P<made>Request|Response)\(.*{_CALLED}.*Invalid arguments passed to constructor: "
        r"'?(?P<keyword>\w+(?:, \w+)*)",
        "The {part}{made} of AddTwoInts has no field called {name}{keyword}.",
        "Its Request has the fields a and b, and its Response has the field sum: write the name exactly so. A "
        "service's callback is given the request first, then the response: def add(self, request, response).",
    ),
    Crash(
        "field_typo",
        r"AttributeError: 'Fibonacci_(?P<part>Goal|Result|Feedback)' object has no attribute '(?P<name>\w+)'"
        rf"|Fibonacci\.(?P<made>Goal|Result|Feedback)\(.*{_CALLED}.*Invalid arguments passed to constructor: "
        r"'?(?P<keyword>\w+(?:, \w+)*)",
        "The {part}{made} of Fibonacci has no field called {name}{keyword}.",
        "Its Goal has the field order, its Result has sequence, and its Feedback has partial_sequence: write the name "
        "exactly so.",
    ),
    Crash(
        "field_typo",
        r"AttributeError: '(?P<type>\w+)_(?P<part>Request|Response|Goal|Result|Feedback)' object has no attribute "
        r"'(?P<name>\w+)'",
        "The {part} of {type} has no field called {name}.",
        "`ros2 interface show` lists the fields: write the name exactly as it is there, and look whether it belongs to "
        "another part.",
    ),
    Crash(
        "field_typo",
        r"AttributeError: '(?P<type>String|U?Int\d+|Float\d+|Bool)' object has no attribute '(?P<name>\w+)'"
        rf"|\b(?P<made>String|U?Int\d+|Float\d+|Bool)\(.*{_CALLED}.*Invalid arguments passed to constructor: "
        r"'?(?P<keyword>\w+(?:, \w+)*)",
        "The message has no field called {name}{keyword}: a {type}{made} has a single one, data.",
        "Write data in its place, as in {owner:message}.data, or {type}{made}(data=...).",
    ),
    Crash(
        "field_typo",
        r"AttributeError: '(?:String|U?Int\d+|Vector3)' object has no attribute '(?P<name>\w+)'"
        r"|Invalid arguments passed to constructor: '?(?P<keyword>\w+(?:, \w+)*)",
        "The message has no field called {name}{keyword}.",
        "`ros2 interface show` lists the fields of a type: write the name exactly as it is there.",
    ),
)
"""What rclpy says of a field that a message does not have, or that does not take such a value."""
