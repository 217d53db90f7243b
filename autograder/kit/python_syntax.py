"""What Python says of a text that it cannot read, and of arguments that do not fit: rows of ``python_errors``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.python_names import MARKS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.python_names import Row

_READS = r"^(?:SyntaxError|IndentationError|TabError): "

READING: Sequence[Row] = (
    (
        rf"{_READS}expected ':'",
        "A colon is missing.",
        "Write a colon at the end of that line: class, def, if, else, for, while, try and with all end with one.",
    ),
    (
        rf"{_READS}expected an indented block after (?P<what>.*) on line (?P<line>\d+)",
        "The lines that belong to the {what} are not indented.",
        "Indent by four spaces what belongs below line {line}.",
    ),
    (
        rf"{_READS}unexpected indent",
        "That line is indented further than the line above it, and nothing above it opens a block.",
        "Indent it like the line above.",
    ),
    (
        rf"{_READS}unindent does not match",
        "That line begins between two levels of indentation.",
        "Indent it like the other lines of its block: by four spaces for each level.",
    ),
    (
        rf"{_READS}inconsistent use of tabs",
        "Some lines begin with tabs and others with spaces.",
        "Delete the spaces and tabs at the beginning of that line, and indent it by four spaces for each level.",
    ),
    (
        rf"{_READS}'(?P<sign>.)' was never closed",
        "The bracket {sign} is opened and never closed.",
        "Count the brackets of that line, and close this one.",
    ),
    (
        rf"{_READS}unmatched '(?P<sign>.)'",
        "There is one {sign} too many.",
        "Count the brackets of that line.",
    ),
    (
        rf"{_READS}(?:unterminated|EOL while scanning|f-string: expecting)",
        "A string does not end.",
        "Close it with the quotation mark that it begins with, and each {{ in an f-string with a }}.",
    ),
    (
        rf"{_READS}invalid (?:non-printable )?character '?(?P<sign>[^']*)",
        "That line has a character of a word processor or a web page in it.",
        "Type the line yourself: quotation marks are ' or \" and a minus is -.",
    ),
    (
        rf"{_READS}.*Maybe you meant '=='",
        "One = gives a variable a value; to compare takes two.",
        "Write == in a condition. Left of a single = is the name that gets the value.",
    ),
    (
        rf"{_READS}.*forgot a comma",
        "Two values are side by side, and nothing joins them.",
        "Put a string in quotation marks, write a comma between two values, or close the bracket or the quotation mark "
        "before that place.",
    ),
    (
        rf"{_READS}Missing parentheses in call to 'print'",
        "This is Python 2.",
        "Write print(...), with parentheses.",
    ),
    (
        rf"{_READS}'return' outside function",
        "That line is not inside a method any more.",
        "Indent it as the other lines of its method.",
    ),
    (
        rf"{_READS}incomplete input",
        "The code ends in the middle of something.",
        "Close each bracket and each quotation mark that you have opened, or write the line that is missing.",
    ),
    (
        _READS,
        "",
        "Go to the line that the message names; a bracket, a quote, a colon or the indentation is off there or just "
        "before it.",
    ),
)
"""Python's words about a text that it cannot read; the first row that fits wins."""

CALLS: Sequence[Row] = (
    (
        r"^TypeError: (?:\w+\.)?publish\(\) missing",
        "publish was called without a message.",
        "Write your message between its parentheses.",
    ),
    (
        r"^TypeError: (?:String|Twist|Vector3|U?Int\d+|Float\d+|Bool"
        r"|\w+_(?:Request|Response|Goal|Result|Feedback))\.__init__\(\) takes 1 positional argument",
        "A message takes its fields by their names.",
        "Name the field between the parentheses, as in String(data='hello'), or set it in the next line.",
    ),
    (
        rf"[(,= ](?P<called>[A-Za-z_][\w.]*)\(\)[,)].*{MARKS}TypeError: (?:\w+\.)*?\w+\(\) missing \d+ required "
        r"positional arguments?: (?P<names>.+)",
        "The parentheses after {called} call it in this line, with nothing between them. It needs {names}.",
        "If ROS or another function is to call it later, write only its name, {called}, without parentheses. "
        "Otherwise write the values between its parentheses.",
    ),
    (
        r"^TypeError: isinstance\(\) arg 2 must be a type",
        "The publisher was made with an object, such as String(), where the type itself is needed.",
        "Leave out the parentheses after the type: create_publisher(String, 'topic', 10).",
    ),
    (
        r"rclpy_resolve_name\(\): incompatible function arguments",
        "A name is needed here as a string, and something else was given.",
        "First the type, then the name in quotation marks: create_publisher(String, 'topic', 10).",
    ),
    (
        r"^TypeError: (?:Node\.)?get_logger\(\) takes 1 positional argument",
        "get_logger() takes nothing: it gives you the logger, and the logger has the method info.",
        "Write self.get_logger().info(...), with the string between the second parentheses.",
    ),
    (
        r"^TypeError: Node\.(?P<method>create_\w+)\(\) takes (?:from \d+ to )?\d+ positional arguments? but \d+ were",
        "{method} got more arguments than it takes.",
        "Compare with the lab: create_publisher(type, topic, depth), create_subscription(type, topic, method, depth), "
        "create_timer(seconds, method), create_service(type, name, method), create_client(type, name).",
    ),
    (
        rf"(?:\w*(?:time|sec|patience|limit)\w*=(?P<limit>[\w.]+)\).*{MARKS})?TypeError: (?:\w+\.)*(?P<what>"
        r"wait_for_(?:service|server)|spin_once|spin_until_future_complete|call)\(\) got an unexpected keyword "
        r"argument '(?P<name>\w*(?:time|sec|patience|limit)\w*)'",
        "{what} takes its limit under the name timeout_sec, and not under {name}.",
        "Left of the = write timeout_sec, as in {what}(..., timeout_sec={limit:5.0}).",
    ),
    (
        r"^TypeError: (?:Client\.)?call(?:_async)?\(\) (?:takes .*positional argument|got an unexpected keyword)",
        "A call takes one thing, the request.",
        "Put the numbers into the request first, as in call_async(AddTwoInts.Request(a=2, b=3)).",
    ),
    (
        r"^TypeError: (?:ActionClient\.)?send_goal(?:_async)?\(\) got an unexpected keyword argument '(?:order|x|y)'",
        "send_goal_async takes a goal, and what your code gives it is a field of one.",
        "Put the field into a goal first, as in send_goal_async(Fibonacci.Goal(order=10), feedback_callback=...).",
    ),
    (
        r"^TypeError: ActionServer\.__init__\(\) got an unexpected keyword argument '(?P<name>\w+)'",
        "An ActionServer takes no argument called {name}.",
        "Its functions are called goal_callback=, execute_callback= and cancel_callback=: write one of these.",
    ),
    (
        r"^TypeError: (?:ActionClient\.)?send_goal(?:_async)?\(\) got an unexpected keyword argument '(?P<name>\w+)'",
        "send_goal_async takes the goal and feedback_callback=, and nothing called {name}.",
        "Write feedback_callback= before the name of the method that is given the feedback, or leave it out.",
    ),
    (
        r"^TypeError: ActionServer\.__init__\(\) takes .* positional arguments? but",
        "After the node, the type and the name, an ActionServer takes its functions by their keywords.",
        "Write goal_callback=, execute_callback= or cancel_callback= before each of them.",
    ),
    (
        r"^TypeError: Node\.__init__\(\) takes .* positional arguments? but",
        "super().__init__ hands over self by itself, and takes the name of the node.",
        "Write super().__init__('your_node_name'), with nothing but the name between the second parentheses.",
    ),
    (
        r"^TypeError: (?:\w+\.)*?(?P<what>\w+)(?:\.__init__)?\(\) takes (?P<takes>.*\d) positional arguments? but "
        r"(?P<got>\d+) w\w+ given",
        "{what} takes {takes} arguments and got {got}; in a method, self is counted as well.",
        "Its first line, def ..., or the lab's text names its arguments: give it one value for each, in their order.",
    ),
    (
        r"^TypeError: (?P<what>AddTwoInts|SetBool|Trigger|Fibonacci|WalkTo)\.__init__\(\) got an unexpected keyword",
        "{what} itself only holds its parts together: the fields are in a part.",
        "Make the part that you need, such as AddTwoInts.Request(a=2, b=3) or Fibonacci.Goal(order=10).",
    ),
    (
        r"^TypeError: spin\(\) missing 1 required positional argument: 'node'",
        "rclpy.spin has to know which node it spins.",
        "Write your node between its parentheses: rclpy.spin(your_node).",
    ),
    (
        r"^TypeError: __init__\(\): incompatible constructor arguments",
        "One of the arguments in this line has the wrong type.",
        "First the type, then the name in quotation marks, then the method without parentheses, as in "
        "create_service(AddTwoInts, 'add_two_ints', self.your_method).",
    ),
    (
        r"^TypeError: (?P<what>ActionServer|ActionClient)\.__init__\(\) missing \d+ required positional arguments?: "
        r"(?:.*')?action_name'",
        "The node is missing: it is the first argument of every {what}.",
        "Write self first: {what}(self, Fibonacci, 'fibonacci', ...).",
    ),
    (
        r"^TypeError: (?:\w+\.)*?(?P<what>\w+)(?:\.__init__)?\(\) missing \d+ required positional arguments?: "
        r"(?P<names>.+)",
        "{what} got less than it needs. Missing: {names}.",
        "Its first line, def ..., or the lab's text names its arguments: give it one value for each, in their order. "
        "Where the first value is left out, Python names the last argument.",
    ),
    (
        r"^TypeError: (?:\w+\.)?(?P<what>publish\w*)\(\) got an unexpected keyword argument '(?P<name>\w+)'",
        "{what} takes a message, and {name} is a field of one.",
        "Put the field into a message, as in publish(String(data='hello')), or "
        "publish_feedback(Fibonacci.Feedback(partial_sequence=numbers)).",
    ),
    (
        r"^TypeError: (?:\w+\.)*?(?P<what>\w+)(?:\.__init__)?\(\) got an unexpected keyword argument '(?P<name>\w+)'",
        "{what} takes no argument called {name}.",
        "Its first line, def ..., or the lab's text names its arguments: compare the name, letter by letter, or leave "
        "it out.",
    ),
)
"""Python's words about the arguments of a call; the first row that fits wins."""
