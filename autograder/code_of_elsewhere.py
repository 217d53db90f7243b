"""Code that is right elsewhere (ROS 1, another ROS 2, C++, asyncio), and how it is written in this course.

Copied lines are recognised by the exception that they end with. Each row has the pattern of this exception, the
cause, and what to write here. The judge says it on a card, the notebook below a cell that ended with such an exception.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import re2

if TYPE_CHECKING:
    from collections.abc import Iterable

KEY = "code_of_elsewhere"
"""The diagnosis key of these mistakes in ``docs/mistakes.md``."""
_MARKS = r"\n(?:[ ~^]*\n)?"
"""From a quoted line of code to the exception: perhaps a line of marks below the code."""


@dataclass(frozen=True)
class Elsewhere:
    """One way in which code of elsewhere ends here.

    Attributes:
        pattern: Found in the traceback (multi-line search); its groups may be named in both texts. ``{here}`` stands
            there for the package with this course's types.
        text: Where the code comes from, in a sentence.
        next_step: What to write here.
        key: The diagnosis key.
    """

    pattern: str
    text: str
    next_step: str
    key: str = KEY


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
    "wait_for_service": "Ask the client: client.wait_for_service(timeout_sec=5.0) returns False if no server came.",
    "Rate|Timer|Duration|sleep": "Write self.create_timer(0.5, self.tick) in __init__ of your node: ROS calls the "
    "method every half second, and no loop is needed.",
    "init_node": "Write class YourNode(Node), and super().__init__('your_node_name') as the first line of its "
    "__init__. In a program, rclpy.init() comes before the node is made.",
    "is_shutdown": "Write `while rclpy.ok():`, or better a timer: self.create_timer(0.5, self.tick).",
    "get_time|get_rostime|Time": "Write self.get_clock().now() in a method of your node.",
    "ROSInterruptException|signal_shutdown|on_shutdown": "Leave it out. A program ends with rclpy.shutdown().",
    "spin|spinOnce|spin_some": "Write rclpy.spin(your_node) in a program, `with spinning(your_node):` in a notebook.",
}
"""What ROS 1 has in its module rospy (and C++ in rclcpp): pattern of the name -> what is written here."""
_SPELLINGS = {
    "this": "self",
    "true": "True",
    "false": "False",
    "null|NULL|nullptr|undefined": "None",
}
"""What other languages write -> Python."""
_TYPES = r"\w*Ints|SetBool|Trigger|Empty|Fibonacci|WalkTo"
_PARTS = "Request|Response|Goal|Result|Feedback"

ROWS = (
    Elsewhere(
        r"Context\.init\(\) must only be called once",
        "rclpy.init() was called although ROS was already started.",
        "Call rclpy.init() once per process. In a notebook, start_ros() has done it: leave out rclpy.init() and each "
        "main() that calls it, and spin a node by `with spinning(your_node):`.",
        "init_twice",
    ),
    Elsewhere(
        # Of rclpy 7.2 and later: contexts and entities for `with`, more names, arithmetic with durations.
        r"\b(?:init\(|with \().*\n(?:[ ~^]*\n)?"
        r"(?:TypeError: 'NoneType' object does not support the (?:asynchronous )?context manager protocol"
        r"|AttributeError: __a?enter__)"
        r"|^ +(?:async )?with .*\n(?:[ ~^]*\n)?TypeError: '(?:\w*(?:Node|Talker|Listener|Publisher|Subscriber|Server)"
        r"|Subscription|Client|Service|Timer)' object does not support the (?:asynchronous )?context manager protocol"
        r"|ImportError: cannot import name '(?:MessageInfo|TimerInfo|InitContextManager|EventsExecutor|AsyncNode)' "
        r"from 'rclpy"
        r"|has no attribute 'get_(?:clients|servers)_info_by_service'"
        r"|TypeError: unsupported operand type\(s\) for [-+*/]+: 'Duration' and",
        "This is written for a newer ROS 2 than Jazzy, which the course uses: Jazzy's rclpy does not know it yet.",
        "Look for pages about Jazzy. Write rclpy.init() as a line of its own, without `with`, and make the node in the "
        "next line. In a notebook, start_ros() has called rclpy.init() already.",
        "newer_api",
    ),
    *(
        Elsewhere(
            rf"\brospy\.(?P<name>{names})\b.*{_MARKS}NameError: name 'rospy' is not defined"
            rf"|AttributeError: module 'rclpy' has no attribute '(?P<missed>{names})'",
            "{name}{missed} comes from ROS 1 or from C++, and this course uses ROS 2 in Python.",
            here,
        )
        for names, here in _HERE.items()
    ),
    Elsewhere(
        rf"AttributeError: '\w+' object has no attribute '(?P<name>{_LOG})'",  # is looked for in the node, too
        "{name} is ROS 1's, and this course uses ROS 2.",
        _HERE[_LOG],
    ),
    Elsewhere(
        r"(?:ModuleNotFoundError: No module named|NameError: name) '(?P<name>rospy|roslib|actionlib|rospkg)\b",
        "{name} belongs to ROS 1, and this course uses ROS 2, whose Python module is rclpy.",
        "Write `import rclpy` and `from rclpy.node import Node`. A node is a class, class YourNode(Node), with "
        "self.create_publisher(String, 'chatter', 10), self.create_subscription(...), self.create_service(...), "
        "self.create_timer(0.5, self.tick) in place of a loop with a rate, and self.get_logger().info(...) for the "
        "log. Begin with the lab's own code.",
    ),
    Elsewhere(
        r"TypeError: Node\.create_(?:publisher|subscription)\(\) got an unexpected keyword argument "
        r"'(?P<name>queue_size|latch|tcp_nodelay|buff_size|data_class|callback_args)'",
        "{name}= is ROS 1's, and this course uses ROS 2.",
        "First the type, then the name, and the depth as a plain number at the end: create_publisher(String, "
        "'chatter', 10), create_subscription(String, 'chatter', self.on_message, 10).",
    ),
    Elsewhere(
        r"rclpy_resolve_name\(\): incompatible function arguments(?:.*\n)*?Invoked with: <[^>]*>, "
        r"<class '(?:\w+\.)*(?P<type>\w+)'>",
        "The type {type} is where the name belongs. This is the order of ROS 1.",
        "In ROS 2 the type comes first, then the name in quotation marks: create_publisher({type}, 'chatter', 10), "
        "create_subscription({type}, 'chatter', self.on_message, 10).",
    ),
    Elsewhere(
        r"AttributeError: 'Publisher' object has no attribute 'get_num_connections'",
        "get_num_connections is ROS 1's, and this course uses ROS 2.",
        "Write get_subscription_count() in its place.",
    ),
    Elsewhere(
        r"TypeError: ActionServer\.__init__\(\) got an unexpected keyword argument '(?P<name>execute_cb|auto_start)'",
        "{name}= is ROS 1's, and this course uses ROS 2.",
        "Write ActionServer(self, Fibonacci, 'fibonacci', execute_callback=self.execute): the node first, then the "
        "type, then the name. It starts by itself.",
    ),
    Elsewhere(
        rf"(?:ImportError: cannot import name|NameError: name) '(?P<type>{_TYPES})(?P<part>{_PARTS})'",
        "In ROS 1 and in C++ the {part} of {type} has a name of its own; in ROS 2 it is a part of {type} in Python.",
        "Import {type} alone, and write the part with a dot: {type}.{part}.",
    ),
    *(
        Elsewhere(
            rf"(?:ImportError: cannot import name '(?P<name>\w+)' from '(?P<package>{packages})' "
            rf"|AttributeError: module '(?P<of>{packages})' has no attribute '(?P<missed>[A-Z]\w*)'"
            rf"|ModuleNotFoundError: No module named '(?P<before>{packages})\.(?P<last>[A-Z]\w*)')",
            "The package {package}{of}{before} itself has no type {name}{missed}{last}: its types are in modules.",
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
    Elsewhere(
        r"ModuleNotFoundError: No module named '(?P<name>example_interfaces|action_tutorials_interfaces"
        r"|tutorial_interfaces|custom_interfaces|custom_action_interfaces|action_tutorials|beginner_tutorials)\b",
        "{name} belongs to other tutorials, and this course does not have it.",
        "In the import write {here} in place of {name}. Messages such as String are in std_msgs.msg, SetBool and "
        "Trigger in std_srvs.srv. `ros2 interface show` lists the fields, which may have other names.",
        "module_not_found",
    ),
    Elsewhere(
        r"RuntimeError: (?:no running event loop|There is no current event loop)"
        r"|RuntimeError: asyncio\.run\(\) cannot be called from a running event loop"
        r"|RuntimeError: This event loop is already running|RuntimeError: Task got bad yield"
        r"|NameError: name 'asyncio' is not defined",
        "This is asyncio's way to wait. ROS calls callbacks by an executor of its own, which is not a loop of asyncio.",
        "Leave asyncio out. For a pause or for what comes again, write self.create_timer(0.5, self.tick). For an "
        "answer, give the future that call_async returned a function to go on in, with its add_done_callback(...).",
    ),
    Elsewhere(
        r"TypeError: __init__\(\) should return None, not 'coroutine'",
        "__init__ is an `async def`, and making an object cannot wait.",
        "Write def in place of async def, and no await in it.",
    ),
    *(
        Elsewhere(
            rf"NameError: name '(?P<name>{names})' is not defined",
            "{name} is another language's: in Python it is " + python + ".",
            f"Write {python} in place of {{name}}.",
        )
        for names, python in _SPELLINGS.items()
    ),
    Elsewhere(
        r"(?:ModuleNotFoundError: No module named|NameError: name) '(?P<name>rclcpp|RCLCPP_\w+)\b",
        "{name} is C++, and this course writes ROS 2 in Python.",
        "The Python module is rclpy; a node writes its log with self.get_logger().info('...').",
    ),
    Elsewhere(
        r"TypeError: '<' not supported between instances of '(?:method|function)' and 'Metaclass_(?P<type>\w+)'",
        "A type in angle brackets is C++.",
        "In Python the type is the first argument, as in create_publisher({type}, 'chatter', 10).",
    ),
    Elsewhere(
        r"AttributeError: '\w+' object has no attribute '(?P<name>create_wall_timer)'",
        "{name} is C++, and this course writes ROS 2 in Python.",
        "Write create_timer(0.5, self.tick): the period in seconds, then the method.",
    ),
    Elsewhere(
        r"AttributeError: '\w+' object has no attribute '(?P<name>async_send_request|async_send_goal|async_get_result"
        r"|async_cancel_goal)'",
        "{name} is C++, and this course writes ROS 2 in Python.",
        "In Python these names end in async: call_async, send_goal_async, get_result_async, cancel_goal_async.",
    ),
    Elsewhere(
        r"^ +(?:.*[\s=(,])?[A-Za-z_][\w.]*(?:::|->)[A-Za-z_].*\n(?:[ ~^]*\n)?SyntaxError: ",
        "This line is C++, and this course writes ROS 2 in Python.",
        "Write a dot in place of :: and of ->, as in self.publisher.publish(message), and import a type: from "
        "std_msgs.msg import String.",
    ),
)
"""Code of elsewhere, most exact first."""


def packages(names: Iterable[str]) -> str:
    """The packages with this course's types, for a sentence."""
    return " or ".join(sorted(set(names))) or "the package that the lab imports from"


def recognised(traceback: str, here: str) -> Elsewhere | None:
    """The row that a traceback shows, with both texts filled in; None if it shows no code of elsewhere.

    Args:
        traceback: The traceback.
        here: The package with this course's types, from :func:`packages`.
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
