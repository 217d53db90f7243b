"""Recognizes code from other sources (ROS 1, another ROS 2, C++, asyncio), and says how to write it in this course.

Copied lines are recognized by the exception that they raise. Each row contains a pattern for the exception, the cause,
and what to write in this course. The judge shows both texts on a card, and a notebook shows them below a cell that
raised the exception.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable


KEY = "code_of_elsewhere"
"""The key of the diagnosis for copied code; ``docs/mistakes.md`` lists all keys."""
_MARKS = r"\n(?:[ ~^]*\n)?"
"""Matches the text between a line of code and the exception: a line break, and perhaps a line of ``^`` marks."""


@dataclass(frozen=True)
class KnownTraceback:
    """A traceback with a known cause, such as the exception that copied code raises.

    Attributes:
        pattern: The pattern to search for in the traceback (multi-line). ``text`` and ``next_step`` may use its named
            groups, and ``{here}`` for the packages with this course's interfaces.
        text: The cause, in a sentence for the student. For copied code, the sentence names the origin of the code.
        next_step: What to do now. For copied code, what to write in this course.
        key: The diagnosis key.
    """

    pattern: str
    text: str
    next_step: str
    key: str


_LOG = "log(?:debug|info|warn|err|fatal)(?:_once|_throttle)?"
_HERE = {
    _LOG: "Write self.get_logger().info(f'I heard: {{message.data}}') in a method of your node: one string, with the "
    "values in braces.",
    "get_param": "Write self.declare_parameter('name', 1.0).value in __init__ of your node.",
    "Publisher": "Write self.create_publisher(String, 'chatter', 10) in __init__ of your node: the type first, then "
    "the name, then the depth.",
    "Subscriber": "Write self.create_subscription(String, 'chatter', self.on_message, 10) in __init__ of your node: "
    "the type first, then the name, the method and the depth.",
    "Service": "Write self.create_service(AddTwoInts, 'add_two_ints', self.add) in __init__ of your node. The method "
    "takes the request and the response, def add(self, request, response), fills the response and returns it.",
    "ServiceProxy": "Write client = node.create_client(AddTwoInts, 'add_two_ints'), and future = "
    "client.call_async(request) to call the service.",
    "wait_for_service": "Call it on the client: client.wait_for_service(timeout_sec=5.0) returns False if no server "
    "appears in time.",
    "Rate|Timer|Duration|sleep": "Write self.create_timer(0.5, self.tick) in __init__ of your node: ROS calls the "
    "method every half second, and no loop is needed.",
    "init_node": "Write class YourNode(Node), and super().__init__('your_node_name') as the first line of its "
    "__init__. In a program, rclpy.init() comes before the node is made.",
    "is_shutdown": "Write `while rclpy.ok():`, or better a timer: self.create_timer(0.5, self.tick).",
    "get_time|get_rostime|Time": "Write self.get_clock().now() in a method of your node.",
    "ROSInterruptException|signal_shutdown|on_shutdown": "Leave this line out. A program ends with rclpy.shutdown().",
    "spin|spinOnce|spin_some": "Write rclpy.spin(your_node) in a program, `with spinning(your_node):` in a notebook.",
}
"""Advice by pattern. A pattern matches names from ROS 1's module rospy (or C++'s rclcpp); the advice says what to write
instead in this course.
"""
_TYPES = r"\w*Ints|SetBool|Trigger|Empty|Fibonacci|WalkTo"
_PARTS = "Request|Response|Goal|Result|Feedback"

ROWS = (
    KnownTraceback(
        r"Context\.init\(\) must only be called once",
        "rclpy.init() was called although ROS was already started.",
        "Call rclpy.init() once per process. In a notebook, start_ros() has done it: leave out rclpy.init() and each "
        "main() that calls it, and spin a node with `with spinning(your_node):`.",
        "init_twice",
    ),
    KnownTraceback(
        # This matches code for rclpy 7.2 and later: contexts and entities in `with`, new names, arithmetic with
        # durations.
        r"\b(?:init\(|with \().*\n(?:[ ~^]*\n)?"
        r"(?:TypeError: 'NoneType' object does not support the (?:asynchronous )?context manager protocol"
        r"|AttributeError: __a?enter__)"
        r"|^ +(?:async )?with .*\n(?:[ ~^]*\n)?TypeError: '(?:\w*(?:Node|Talker|Listener|Publisher|Subscriber|Server)"
        r"|Subscription|Client|Service|Timer)' object does not support the (?:asynchronous )?context manager protocol"
        r"|ImportError: cannot import name '(?:MessageInfo|TimerInfo|InitContextManager|EventsExecutor|AsyncNode)' "
        r"from 'rclpy"
        r"|has no attribute 'get_(?:clients|servers)_info_by_service'"
        r"|TypeError: unsupported operand type\(s\) for [-+*/]+: 'Duration' and",
        "This code is written for a newer ROS 2 than Jazzy. The course uses Jazzy, whose rclpy does not have this yet.",
        "Look for pages about Jazzy. Write rclpy.init() as a line of its own, without `with`, and make the node in the "
        "next line. In a notebook, start_ros() has called rclpy.init() already.",
        "newer_api",
    ),
    *(
        KnownTraceback(
            rf"\brospy\.(?P<name>{names})\b.*{_MARKS}NameError: name 'rospy' is not defined"
            rf"|AttributeError: module 'rclpy' has no attribute '(?P<missed>{names})'",
            "{name}{missed} comes from ROS 1 or from C++, and this course uses ROS 2 in Python.",
            here,
            KEY,
        )
        for names, here in _HERE.items()
    ),
    KnownTraceback(
        # Copied code may also look for rospy's functions in the node, as in self.loginfo(...).
        rf"AttributeError: '\w+' object has no attribute '(?P<name>{_LOG})'",
        "{name} belongs to ROS 1, and this course uses ROS 2.",
        _HERE[_LOG],
        KEY,
    ),
    KnownTraceback(
        r"(?:ModuleNotFoundError: No module named|NameError: name) '(?P<name>rospy|roslib|actionlib|rospkg)\b",
        "{name} belongs to ROS 1, and this course uses ROS 2, whose Python module is rclpy.",
        "Write `import rclpy` and `from rclpy.node import Node`. A node is a class, class YourNode(Node), with "
        "self.create_publisher(String, 'chatter', 10), self.create_subscription(...), self.create_service(...), "
        "self.create_timer(0.5, self.tick) in place of a loop with a rate, and self.get_logger().info(...) for the "
        "log. Begin with the lab's own code.",
        KEY,
    ),
    KnownTraceback(
        r"TypeError: Node\.create_(?:publisher|subscription)\(\) got an unexpected keyword argument "
        r"'(?P<name>queue_size|latch|tcp_nodelay|buff_size|data_class|callback_args)'",
        "{name}= belongs to ROS 1, and this course uses ROS 2.",
        "First the type, then the name, and the depth as a plain number at the end: create_publisher(String, "
        "'chatter', 10), create_subscription(String, 'chatter', self.on_message, 10).",
        KEY,
    ),
    KnownTraceback(
        r"rclpy_resolve_name\(\): incompatible function arguments(?:.*\n)*?Invoked with: <[^>]*>, "
        r"<class '(?:\w+\.)*(?P<type>\w+)'>",
        "The type {type} is where the name belongs. ROS 1 has this order of arguments.",
        "In ROS 2 the type comes first, then the name in quotation marks: create_publisher({type}, 'chatter', 10), "
        "create_subscription({type}, 'chatter', self.on_message, 10).",
        KEY,
    ),
    KnownTraceback(
        rf"(?:ImportError: cannot import name|NameError: name) '(?P<type>{_TYPES})(?P<part>{_PARTS})'",
        "In ROS 1 and in C++, the {part} of {type} has its own name. In ROS 2 with Python, it is an attribute of "
        "{type}.",
        "Import only {type}, and write the {part} with a dot: {type}.{part}.",
        KEY,
    ),
    *(
        KnownTraceback(
            rf"(?:ImportError: cannot import name '(?P<name>\w+)' from '(?P<package>{packages})' "
            rf"|AttributeError: module '(?P<of>{packages})' has no attribute '(?P<missed>[A-Z]\w*)'"
            rf"|ModuleNotFoundError: No module named '(?P<before>{packages})\.(?P<last>[A-Z]\w*)')",
            "The package {package}{of}{before} itself has no type {name}{missed}{last}, because its types are in "
            "modules.",
            f"Write `from {{package}}{{of}}{{before}}.{module} import {{name}}{{missed}}{{last}}`{more}, and "
            "{name}{missed}{last} alone where you use it.",
            "module_not_found",
        )
        for packages, module, more in (
            (r"\w+_msgs", "msg", ""),
            (r"\w+_srvs", "srv", ""),
            (r"\w+_interfaces", "srv", " (.action in place of .srv for an action)"),
        )
    ),
    KnownTraceback(
        r"ModuleNotFoundError: No module named '(?P<name>example_interfaces|action_tutorials_interfaces"
        r"|tutorial_interfaces|custom_interfaces|custom_action_interfaces|action_tutorials|beginner_tutorials)\b",
        "{name} belongs to other tutorials, and this course does not have it.",
        "In the import write {here} in place of {name}. Messages such as String are in std_msgs.msg, SetBool and "
        "Trigger in std_srvs.srv. `ros2 interface show` lists the fields, which may have other names.",
        "module_not_found",
    ),
    KnownTraceback(
        r"RuntimeError: (?:no running event loop|There is no current event loop)"
        r"|RuntimeError: asyncio\.run\(\) cannot be called from a running event loop"
        r"|RuntimeError: This event loop is already running|RuntimeError: Task got bad yield"
        r"|NameError: name 'asyncio' is not defined",
        "This code waits with asyncio. But ROS runs callbacks in its own executor, which is not an asyncio event loop.",
        "Leave asyncio out. To pause or to repeat something, write self.create_timer(0.5, self.tick). To go on when an "
        "answer arrives, write future.add_done_callback(self.on_answer), with the future that call_async returned.",
        KEY,
    ),
    KnownTraceback(
        r"NameError: name '(?P<name>this|true|false|null|NULL|nullptr|undefined)' is not defined",
        "{name} is a word of another language.",
        "In Python, write self instead of this, and True, False or None with these capitals.",
        KEY,
    ),
    KnownTraceback(
        r"(?:ModuleNotFoundError: No module named|NameError: name) '(?:rclcpp|RCLCPP_\w+)\b"
        r"|AttributeError: '\w+' object has no attribute '(?:create_wall_timer|async_(?:send_\w+|get_result"
        r"|cancel_goal))'"
        r"|TypeError: '<' not supported between instances of '(?:method|function)' and 'Metaclass_"
        r"|^ +(?:.*[\s=(,])?[A-Za-z_][\w.]*(?:::|->)[A-Za-z_].*\n(?:[ ~^]*\n)?SyntaxError: ",
        "This line is C++, and this course writes ROS 2 in Python.",
        "The Python module is rclpy. Write a dot in place of :: and of ->, and a type as the first argument, without "
        "angle brackets, as in self.create_publisher(String, 'chatter', 10). A timer is create_timer(0.5, self.tick), "
        "a log line is self.get_logger().info('hello'). The names of asynchronous methods end in async, as in "
        "call_async.",
        KEY,
    ),
)
"""All rows. More specific patterns come first, because the first match counts."""


def packages(names: Iterable[str]) -> str:
    """Return the names of the packages with this course's interfaces, joined with "or" for use in a sentence."""
    return " or ".join(sorted(set(names))) or "the package that the lab imports from"


def recognized(traceback: str, here: str) -> KnownTraceback | None:
    """Return the row that a traceback matches, with its texts filled in; None if it matches no row.

    Args:
        traceback: The traceback.
        here: The packages with this course's interfaces, as :func:`packages` returns them.
    """
    for row in ROWS:
        found = _compiled(row.pattern).search(traceback)
        if found is not None:
            words = {"here": here} | {name: said or "" for name, said in found.groupdict().items()}
            return replace(row, text=row.text.format(**words), next_step=row.next_step.format(**words))
    return None


@cache
def _compiled(pattern: str) -> Any:
    return re2.compile(f"(?m){pattern}")
