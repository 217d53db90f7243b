"""What Python says of a beginner's slip, and what the card makes of it."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import pytest

from autograder.kit.crashes import CRASHES, OTHER_CRASHES
from autograder.kit.evidence import Event, Evidence, Part, Reference

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.model import Advice

TRANSITION = "RCLError: Failed to update goal state: goal_handle attempted invalid transition from state"
SAID = {
    "AttributeError: 'Talker' object has no attribute 'cuont'. Did you mean: 'count'?": "write count.",
    "AttributeError: 'Talker' object has no attribute 'publisher'. Did you mean: 'publishers'?": "self.publisher = ...",
    "AttributeError: 'Talker' object has no attribute 'Run'. Did you mean: 'run'?": "write run.",
    "AttributeError: 'Talker' object has no attribute 'Counter'": "Talker has nothing called Counter so far",
    "TypeError: unhashable type: 'list'": "cannot be a key of a dictionary",
    "AssertionError: The 'data' field must be an integer in [-128, 127]": "too small for it: it takes [-128, 127]",
    "SystemError: <built-in method publish of x> returned a result with an exception set": "or a number that is too",
    "TypeError: Talker is not a Node: write class Talker(Node)": "so the class is the node: write class Talker(Node):",
    "AttributeError: module 'rclpy' has no attribute 'Node'": "`from rclpy.node import Node`",
    "LookupError: nothing": "Read the traceback from the bottom",
    "AttributeError: 'Talker' object has no attribute 'create_timr'": "Compare the spelling: create_publisher",
    "NameError: name 'count' is not defined. Did you mean: 'self.count'?": "To use it, write self.count",
    "NameError: name 'comand' is not defined. Did you mean: 'command'?": "and knows command",
    "NameError: name 'order' is not defined. Did you mean: 'ord'?": "request.order",
    "NameError: name 'self' is not defined": "such as node or client",
    "NameError: name 'time' is not defined": "Write import time",
    "NameError: name 'std_msgs' is not defined": "String in place of std_msgs.msg.String",
    "NameError: name 'ACCEPT' is not defined": "Write GoalResponse.ACCEPT",
    "AttributeError: Accept": "constants have capitals only",
    "AttributeError: type object 'GoalResponse' has no attribute 'Accept'": "constants have capitals only",
    "AttributeError: 'Talker' object has no attribute 'String'": "write String",
    "AttributeError: 'Talker' object has no attribute 'create_action_server'": "ActionServer(self, ...)",
    "AttributeError: 'Node' object has no attribute 'wait_for_service'": "its client has",
    "AttributeError: 'FibonacciClient' object has no attribute 'wait_for_server'": "client.actions.wait_for_server",
    "AttributeError: 'CancelingClient' object has no attribute 'cancel_goal_async'": "self.goal_handle.cancel",
    "AttributeError: 'CancelingClient' object has no attribute 'send_goal'": "by its name alone: send_goal(...)",
    "AttributeError: 'String' object attribute 'data' is read-only": "Restart Kernel and Run All Cells",
    "AttributeError: 'NoneType' object has no attribute 'append'": "without numbers = before it",
    "AttributeError: 'NoneType' object has no attribute 'order'": "has run before this one",
    "AttributeError: 'NoneType' object has no attribute 'publish'": "has run before this one",
    "AttributeError: 'Timer' object has no attribute 'publish'": "of the type Timer here",
    "AttributeError: 'Publisher' object has no attribute 'info'": "of the type Publisher here",
    "AttributeError: property 'speed' of 'Robot' object has no setter": "speed of Robot can only be read",
    'TypeError: can only concatenate str (not "NoneType") to str': "Put the value into an f-string",
    "TypeError: 'NoneType' object is not iterable": "without numbers = before it",
    'TypeError: can only concatenate list (not "int") to list': "numbers.append(value)",
    "SyntaxError: incomplete input": "Close each bracket",
    "TypeError: 'bool' object is not callable": "leave out the parentheses",
    "TypeError: 'dict' object is not callable": "names[key]",
    "TypeError: 'String' object is not subscriptable": "message.data",
    "TypeError: 'Fibonacci_Result' object is not iterable": "answer.result.sequence",
    "TypeError: 'method' object is not iterable": "Write parentheses after its name",
    "TypeError: '<=' not supported between instances of 'int' and 'Fibonacci_Goal'": "Name its field",
    "TypeError: unsupported operand type(s) for +: 'AddTwoInts_Request' and 'AddTwoInts_Response'": "request.a",
    "TypeError: __init__(): incompatible constructor arguments. Supported are:": "the name in quotation marks",
    "TypeError: ActionServer.__init__() missing 1 required positional argument: 'action_name'": "Write self first",
    "TypeError: ask() missing 3 required positional arguments: 'a', 'b', and 'patience_sec'": "'a', 'b', and",
    "TypeError: ask() takes 5 positional arguments but 6 were given": "takes 5 arguments and got 6",
    "TypeError: Publisher.publish() got an unexpected keyword argument 'data'": "publish(String(data=",
    "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'std_msgs.msg._string.Metaclass_String'>": (
        "where you make the message: message = String()"
    ),
    "NameError: name 'Talker' is not defined": "import it in this file",
    "UnboundLocalError: local variable 'i' referenced before assignment": "write self.i",
    "SyntaxError: invalid syntax": "just before it",
    "IndentationError: expected an indented block after 'if' statement on line 4": "what belongs below line 4",
    "SyntaxError: invalid syntax. Maybe you meant '==' or ':=' instead of '='?": "Write == in a condition",
    "ImportError: cannot import name 'Strng' from 'std_msgs.msg' (/opt/ros/x/__init__.py)": "nothing called Strng",
    "TypeError: unsupported operand type(s) for +: 'int' and 'str'": "A string and a number are added",
    "ValueError: too many values to unpack (expected 2)": "Left of the = are 2 names",
    "ValueError: invalid literal for int() with base 10: '{five}'": "'{five}' is not a number",
    "ValueError: could not convert string to float: 'five'": "'five' is not a number",
    "TypeError: spin() got an unexpected keyword argument 'nod'": "spin takes no argument called nod",
    "StopIteration": "and none was left",
    "AttributeError: 'ServerGoalHandle' object has no attribute 'order'": "Write your_goal_handle.request.order",
    "NameError: name 'a' is not defined": "request.a, or goal_handle.request.a",
    "TypeError: isinstance() arg 2 must be a type, a tuple of types, or a union": "Leave out the parentheses",
    "TypeError: rclpy_resolve_name(): incompatible function arguments. Supported are:": "First the type, then the name",
    "TypeError: Node.get_logger() takes 1 positional argument but 2 were given": "self.get_logger().info(...)",
    "TypeError: Node.create_service() takes 4 positional arguments but 5 were given": "create_service(type, name",
    "TypeError: call_async() takes 2 positional arguments but 3 were given": "Put the numbers into the request first",
    "TypeError: Client.call_async() takes 2 positional arguments but 3 were given": "AddTwoInts.Request(a=2, b=3)",
    "TypeError: AddTwoInts.__init__() got an unexpected keyword argument 'a'": "Make the part that you need",
    "TypeError: RcutilsLogger.info() takes 2 positional arguments but 3 were given": "into one f-string",
    "TypeError: rclpy_logging_rcutils_log(): incompatible function arguments. The": "info(f'{message.data}')",
    "TypeError: unsupported operand type(s) for +: 'property' and 'property'": "as in request.a",
    "TypeError: 'AddTwoInts_Response' object is not callable": "response.sum = ...",
    "TypeError: 'GoalResponse' object is not callable": "return GoalResponse.ACCEPT.",
    "TypeError: 'int' object is not iterable": "of the type int",
    "TypeError: '<=' not supported between instances of 'list' and 'int'": "len(numbers)",
    "TypeError: call_async() got an unexpected keyword argument 'a'": "Put the numbers into the request first",
    "TypeError: ActionClient.send_goal_async() got an unexpected keyword argument 'order'": "into a goal first",
    "TypeError: wait_for_service() got an unexpected keyword argument 'patience_sec'": "write timeout_sec",
    "TypeError: ActionServer.__init__() takes 5 positional arguments but 7 were given": "execute_callback=",
    "TypeError: ActionClient.__init__() takes 4 positional arguments but 5 were given": "ActionClient takes 4",
    "KeyError: 'status'": "names[answer.status]",
    "OverflowError: signed integer is greater than maximum": "order + 1",
    f"{TRANSITION} CANCELED with event SUCCEED, at goal_handle.c:100": "End each goal once",
    f"{TRANSITION} EXECUTING with event CANCELED, at goal_handle.c:100": "where your_goal_handle.is_cancel_requested",
    "AttributeError: 'Listener' object has no attribute 'log'": "Write self.get_logger().info(...)",
    "AttributeError: 'Listener' object has no attribute 'logger'. Did you mean: '_logger'?": "self.get_logger()",
    "AttributeError: 'Node' object has no attribute 'spin_until_future_complete'": "rclpy.spin_until_future_complete(",
    "AttributeError: 'Node' object has no attribute 'add_done_callback'": "first the node, then the future",
    "AttributeError: 'function' object has no attribute 'add_done_callback'": "Write parentheses after the method",
    "AttributeError: 'float' object has no attribute 'add_node'": "Write timeout_sec= before the number",
    "AttributeError: 'ClientGoalHandle' object has no attribute 'result'. Did you mean: 'get_result'?": ".result() out",
    "AttributeError: 'Fibonacci_Goal' object has no attribute 'request'": "Write goal.order",
    "AttributeError: 'Fibonacci_GetResult_Response' object has no attribute 'sequence'": "answer.result.sequence",
    "AttributeError: 'Fibonacci_Feedback' object attribute 'partial_sequence' is read-only": "Fibonacci.Feedback()",
    "NameError: name 'publish_feedback' is not defined": "goal_handle.publish_feedback",
    "NameError: name 'message' is not defined": "the name that is there",
    "NameError: name 'spin_until_future_complete' is not defined": "rclpy.spin_until_future_complete(...)",
    "NameError: name 'sleep' is not defined": "time.sleep(...)",
    "TypeError: 'NoneType' object cannot be interpreted as an integer": "A value of the type NoneType",
    "AttributeError: 'ActionClient' object has no attribute 'cancel_goal_async'. Did you mean: 'send_goal_async'?": (
        "self.goal_handle.cancel_goal_async"
    ),
    "AttributeError: 'CancelingClient' object has no attribute 'accepted'": "client.goal_handle.accepted",
    "AttributeError: 'int' object has no attribute 'sum'": "leave .sum out",
    "AttributeError: 'ClientGoalHandle' object has no attribute 'add_done_callback'": "a call with _async at its end",
    "AttributeError: 'Fibonacci_Result' object has no attribute 'status'": "answer.status",
    "NameError: name 'goal_handle' is not defined. Did you mean: 'self.goal_handle'?": "write self.goal_handle",
    "NameError: name 'goal_handle' is not defined": "client.goal_handle where the node is called client",
    "TypeError: unhashable type: 'Fibonacci_GetResult_Response'": "STATUS_NAMES[answer.status]",
    "TypeError: ask() missing 1 required positional argument: 'patience_sec'": "Python names the last argument",
    "TypeError: list.append() takes exactly one argument (2 given)": "numbers[-2] + numbers[-1]",
    "NameError: name 'Fibonacci_Feedback' is not defined": "Write it with a dot: Fibonacci.Feedback",
    "OSError: [Errno 28] No space left on device": "Read the traceback from the bottom",
    "AssertionError: The 'linear' field must be a sub message of type 'Vector3'": "x, y or z",
    "AssertionError: The 'x' field must be of type 'float'": "with a point",
    "AssertionError: The 'data' field must be of type 'str'": "str(...)",
    "AssertionError: The 'sum' field must be of type 'int'": "takes one whole number",
    "AttributeError: type object 'type' has no attribute '_TYPE_SUPPORT'": "String of std_msgs.msg in place of str",
    "AttributeError: 'String' object has no attribute 'date'": "has a single one, data",
    "AttributeError: 'AddTwoInts_Response' object has no attribute 'a'": "the request first, then the response",
    "AttributeError: 'Fibonacci_Feedback' object has no attribute 'sequence'": "its Feedback has partial_sequence",
    "AttributeError: 'Fibonacci_FeedbackMessage' object has no attribute 'goal_handle'": "as in self.goal_handle",
    "AttributeError: 'dict' object has no attribute 'answer'": "STATUS_NAMES[answer.status]",
    "AttributeError: type object 'GoalStatus' has no attribute 'STATUS_REJECTED'": "if not goal_handle.accepted",
    "AttributeError: 'FibonacciServer' object has no attribute 'sleep'": "Write time.sleep in place of",
    "AttributeError: 'Client' object has no attribute 'ask'": "write it alone: ask(...)",
    "NameError: name 'client' is not defined. Did you mean: 'run_client'?": "the node itself is called self",
    "NameError: name 'get_logger' is not defined": "Write self. before it: self.get_logger.",
    "NameError: name 'status' is not defined": "as in answer.status",
    "NameError: name 'publisher' is not defined": "also in the line that sets it",
    "TypeError: type 'GoalStatus' is not subscriptable": "GoalStatus is a type",
    'TypeError: can only concatenate str (not "list") to str': "joins strings only",
    "TypeError: ActionServer.__init__() got an unexpected keyword argument 'execute'": "execute_callback=",
    "TypeError: ActionClient.send_goal_async() got an unexpected keyword argument 'feedback'": "feedback_callback=",
    "rclpy.exceptions.InvalidTopicNameException: Invalid topic name": "no slash at its end",
    "TypeError: Node.__init__() takes 2 positional arguments but 3 were given": "with nothing but the name",
}


@pytest.mark.parametrize("last", SAID)
def test_the_card_names_what_to_mend(last: str) -> None:
    words = told(f'Traceback (most recent call last):\n  File "talker.py", line 3, in f\n    here()\n{last}')
    assert SAID[last] in words
    examples = ("{number}", "{five}", "{message.data}", "{response.sum}")
    assert "{" not in functools.reduce(lambda text, example: text.replace(example, ""), examples, words)


@pytest.mark.parametrize(
    ("code", "last", "advice"),
    [
        (
            "self.create_service(AddTwoInts, 'add_two_ints', self.add(request, response))",
            "NameError: name 'request' is not defined",
            "without parentheses and arguments",
        ),
        (
            "rclpy.spin_until_future_complete(client, future, timeout_sec=5.0)",
            "AttributeError: 'Client' object has no attribute 'subscriptions'",
            "Give the spin your node",
        ),
        (
            "execute_callback=compute(),",
            "TypeError: compute() missing 1 required positional argument: 'goal_handle'",
            "write only its name, compute",
        ),
        (
            "self.server = ActionServer(self, Fibonacci, 'fibonacci', execute_callback=compute(), cancel_callback=x)",
            "TypeError: compute() missing 1 required positional argument: 'goal_handle'",
            "write only its name, compute",
        ),
        (
            "self.publisher = self.create_publisher(String, chatter, 10)",
            "NameError: name 'chatter' is not defined",
            "put it in quotation marks",
        ),
        (
            "super().__init__(simple_node)",
            "NameError: name 'simple_node' is not defined",
            "put it in quotation marks",
        ),
        (
            "self.server = ActionServer(self, Fibonacci, 'fibonacci', execute_callback=self.compute)",
            "AttributeError: 'FibonacciServer' object has no attribute 'compute'",
            "If compute is a function outside of the class",
        ),
        (
            "if not client.goal_handle.accepted:",
            "AttributeError: 'NoneType' object has no attribute 'accepted'",
            "client.goal_handle is None",
        ),
        (
            "cancel_future = self.goal_handle.cancel_goal_async()",
            "AttributeError: 'NoneType' object has no attribute 'cancel_goal_async'",
            "keep its result in self.goal_handle",
        ),
        ("self.show(text)", "NameError: name 'text' is not defined", "write self.text"),
        (
            "future = client.actions.send_goal_async(goal, feedback_callback=client.on_feedback())",
            "TypeError: FibonacciClient.on_feedback() missing 1 required positional argument: 'message'",
            "Write only its name, client.on_feedback, without",
        ),
        (
            "self.create_subscription(String, 'chatter', self.hear(), 10)",
            "TypeError: Listener.hear() missing 1 required positional argument: 'message'",
            "The parentheses after hear call it at once",
        ),
        (
            "self.create_subscription(String, 'chatter', None, 10)",
            "RuntimeError: Subscription.__init__(): callback should be either be callable with one argument",
            "Besides self, a timer's callback takes nothing and a subscription's takes the message",
        ),
        (
            "sys.exit(load_entry_point('my-robot-pkg==0.0.0', 'console_scripts', 'simple_node')())",
            '  File "/x/my_robot_pkg/simple_node.py", line 10, in __init__\n    super().__init__("simple_node")\n'
            "rclpy.exceptions.NotInitializedException: rclpy.init() has not been called",
            "let the entry point end in :main",
        ),
        (
            "self.show()",
            "TypeError: Node.show() missing 1 required positional argument: 'text'",
            "show got less than it needs",
        ),
        (
            "self.publish_feedback(Fibonacci.Feedback(partial_sequence=numbers))",
            "NameError: name 'self' is not defined",
            "goal_handle.publish_feedback",
        ),
        (
            "numbers = list(answer.result.sequence)",
            "AttributeError: 'function' object has no attribute 'sequence'",
            "If nothing has waited for it, wait first",
        ),
        (
            "cancel_future.add_done_callback(self.on_cancel_answer(cancel_future))",
            '  File "talker.py", line 9, in on_cancel_answer\n    len(future.result().goals_canceling)\n'
            "AttributeError: 'NoneType' object has no attribute 'goals_canceling'",
            "Write only its name between the parentheses",
        ),
        (
            "total = fut.result().sum",
            "AttributeError: 'NoneType' object has no attribute 'sum'",
            "Wait first: rclpy.spin_until_future_complete(your_node, fut)",
        ),
        (
            "print(goal.get_result_async().result().status)",
            "AttributeError: 'NoneType' object has no attribute 'status'",
            "Look at your_future.done()",
        ),
        (
            "self.publish(text)",
            "AttributeError: 'Talker' object has no attribute 'publish'. Did you mean: 'publisher_'?",
            "as in self.publisher_.publish(...)",
        ),
        (
            "return first.sum + second.sum",
            "AttributeError: 'NoneType' object has no attribute 'sum'",
            "the result of a future is None until",
        ),
        (
            "print(replies[0].sum)",
            "AttributeError: 'Future' object has no attribute 'sum'",
            "Read replies[0].result().sum",
        ),
        (
            "print(cli.call_async(request).sum)",
            "AttributeError: 'Future' object has no attribute 'sum'",
            "sum is read from a future, which",
        ),
        (
            "if not self.handle.accepted:",
            "AttributeError: 'NoneType' object has no attribute 'accepted'",
            "keep its result in self.handle",
        ),
        (
            "seq.append(1)",
            "AttributeError: 'NoneType' object has no attribute 'append'",
            "as in seq.append(...), without seq = before it",
        ),
        ("cmd.x = 0.5", "AttributeError: 'Twist' object has no attribute 'x'", "cmd.linear.x is the speed"),
        ("m.data = 'hi'", "AttributeError: 'String' object attribute 'data' is read-only", "m = String()"),
        (
            "node.log('hi')",
            "AttributeError: 'Node' object has no attribute 'log'",
            "Write node.get_logger().info",
        ),
        (
            "self.create_timer(self.tick, 0.5)",
            "TypeError: float() argument must be a string or a real number, not 'method'",
            "create_timer(0.5, self.tick)",
        ),
        (
            "node.cli.wait_for_service(timeout=limit)",
            "TypeError: Client.wait_for_service() got an unexpected keyword argument 'timeout'",
            "wait_for_service(..., timeout_sec=limit)",
        ),
        (
            "seq.append(1, 2)",
            "TypeError: list.append() takes exactly one argument (2 given)",
            "seq.append(seq[-2] + seq[-1])",
        ),
        (
            "print(NAMES[reply])",
            "TypeError: unhashable type: 'Fibonacci_GetResult_Response'",
            "NAMES[reply.status]",
        ),
        (
            "status = reply.result.status",
            "AttributeError: 'Fibonacci_Result' object has no attribute 'status'",
            "reply.status, and reply.result.sequence",
        ),
        (
            "move.linear = 0.5",
            "AssertionError: The 'linear' field must be a sub message of type 'Vector3'",
            "as in move.linear.x = 0.5",
        ),
        (
            "self.create_subscription(String, 'chatter', self.texts.append, 10)",
            "ValueError: no signature found for builtin <built-in method append of list object at 0x7f>",
            "lambda message: self.texts.append(message)",
        ),
        (
            "message = String(date='hello')",
            "AssertionError: Invalid arguments passed to constructor: date",
            "has a single one, data",
        ),
        (
            "future = client.call_async(AddTwoInts.Request(x=a, y=b))",
            "AssertionError: Invalid arguments passed to constructor: x, y",
            "has no field called x, y",
        ),
        (
            "self.publisher = self.create_publisher(String, 'chatter', '10')",
            "TypeError: Expected QoSProfile or int, but received <class 'str'>: 10",
            "'10' is a string",
        ),
        (
            "class Talker(node):",
            "NameError: name 'node' is not defined. Did you mean: 'Node'?",
            "Write Node between",
        ),
        (
            "super.__init__('talker')",
            "TypeError: descriptor '__init__' requires a 'super' object",
            "after super are",
        ),
        (
            "print(self.message.data)",
            "AttributeError: 'Listener' object has no attribute 'message'. Did you mean: 'on_message'?",
            "leave out self. before it",
        ),
        (
            "self.sleep(0.5)",
            "NameError: name 'self' is not defined",
            "Write time.sleep in place of self.sleep",
        ),
        (
            "response.sum = sum(request.a, request.b)",
            "TypeError: 'int' object is not iterable",
            "Two numbers are added with +",
        ),
        (
            "cancel_future.add_done_callback(self.on_cancel_answer)",
            "AttributeError: 'function' object has no attribute 'add_done_callback'",
            "in the line that sets cancel_future",
        ),
        (
            "return client.call(request, timeout_sec=1.0).sum",
            "AttributeError: 'NoneType' object has no attribute 'sum'",
            "gives None when its time is over",
        ),
        (
            "handle.canceled()",
            f"{TRANSITION} EXECUTING with event CANCELED, at goal_handle.c:100",
            "only where handle.is_cancel_requested is True",
        ),
    ],
)
def test_the_line_that_raised_tells_what_to_write(code: str, last: str, advice: str) -> None:
    frames = (
        f'Traceback (most recent call last):\n  File "talker.py", line 3, in __init__\n    {code}\n    ^^^^\n'
    )
    assert advice in told(f"{frames}{last}")


@pytest.mark.parametrize(
    ("file", "future"),
    [
        ("/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/client.py", "your_future"),
        ("/opt/ros/jazzy/lib/python3.12/site-packages/helpers/calls.py", "your_future"),
        ("/home/you/ros2_ws/install/my_robot_pkg/lib/python3.12/site-packages/my_robot_pkg/ask.py", "fut"),
    ],
)
def test_only_a_line_of_the_students_own_tells_a_name(file: str, future: str) -> None:
    lines = f'  File "{file}", line 3, in f\n    print(fut.sum)\n'
    last = "AttributeError: 'Future' object has no attribute 'sum'"
    assert f"Read {future}.result().sum" in told(f"Traceback (most recent call last):\n{lines}{last}")


@pytest.mark.parametrize(
    ("code", "key", "says"),
    [
        ("super().__init__()", "super_init_missing", "__init__ of Node is called without one"),
        ("self.node = Node()", "crashed", "Node is called without one"),
        ("node = Talker()", "super_init_missing", "its class has no method __init__"),
    ],
)
def test_a_node_without_a_name_is_told_from_the_line_that_called(code: str, key: str, says: str) -> None:
    frames = f'Traceback (most recent call last):\n  File "talker.py", line 3, in f\n    {code}\n'
    last = "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'"
    assert diagnosed(f"{frames}{last}") == key
    assert says in told(f"{frames}{last}")


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


GENERATOR = "ValueError: generator already executing"


def test_a_spin_inside_a_callback_is_told_only_where_a_callback_spins() -> None:
    in_a_thread = (
        'Traceback (most recent call last):\n  File "talker.py", line 3, in run\n    rclpy.spin(node)\n'
    )
    nested = IN_A_CALLBACK.replace("1 / 0", "rclpy.spin(other)").replace(
        "ZeroDivisionError: division by zero", ""
    )
    assert diagnosed(f"{nested}{GENERATOR}") == "nested_spin"
    assert diagnosed(f"{in_a_thread}{GENERATOR}") == "crashed"
    assert "Two threads spin at once by the same executor" in told(f"{in_a_thread}{GENERATOR}")


def test_what_ros_raised_of_a_notebooks_node_names_the_node_and_no_traceback_that_is_not_there() -> None:
    """The traceback of a notebook has the student's lines only, and here is none of them."""
    made, no_hash = Event(0.1, "subject", "constructed"), "TypeError: unhashable type: 'Talker'"
    assert diagnosed(no_hash, made) == "crashed"
    assert "A node cannot be a `@dataclass`" in told(no_hash, made)
    for words in (told("RuntimeError: nothing known", made), told("ValueError: neither")):
        assert "Compare what your code gives to ROS" in words
        assert "Read the traceback" not in words


def test_a_spin_of_nothing_names_what_it_was_given() -> None:
    frames = (
        'Traceback (most recent call last):\n  File "talker.py", line 3, in f\n    rclpy.spin(make_node())\n'
    )
    words = told(f"{frames}AttributeError: 'NoneType' object has no attribute 'executor'")
    assert "A spin takes a node, and make_node is of the type NoneType" in words


def test_a_program_s_traceback_has_lines_of_the_generated_module_in_it() -> None:
    frames = (
        'Traceback (most recent call last):\n  File "talker.py", line 3, in tick\n    message = String(dat="x")\n'
        '              ^^^^^^^^^^^^^^^\n  File "/ros/std_msgs/msg/_string.py", line 68, in __init__\n'
        "    assert all('_' + key in self.__slots__ for key in kwargs.keys()), \\\n"
    )
    assert "has a single one, data" in told(
        f"{frames}AssertionError: Invalid arguments passed to constructor: dat"
    )


@pytest.mark.parametrize(
    ("code", "last", "says"),
    [
        ("self.get_logger()", "'Twist' object has no attribute 'get_logger'", "Write self first"),
        ("msg.get_logger()", "'String' object has no attribute 'get_logger'", "no field called get_logger"),
        ("self.msg.publisher_count", "'String' object has no attribute 'publisher_count'", "no field called"),
    ],
)
def test_self_is_the_message_only_where_the_line_says_self(code: str, last: str, says: str) -> None:
    frames = f'Traceback (most recent call last):\n  File "talker.py", line 3, in tick\n    {code}\n'
    assert says in told(f"{frames}AttributeError: {last}")


NONE_HAS_NO_SUM = (
    'Traceback (most recent call last):\n  File "client.py", line 9, in main\n    print(node.answer.sum)\n'
    "AttributeError: 'NoneType' object has no attribute 'sum'"
)


@pytest.mark.parametrize(("late", "is_told"), [((1.0, 1.0), True), ((0.05, 1.0), False)])
def test_an_answer_was_left_lying_only_if_it_was_so_in_each_run(
    late: tuple[float, ...], is_told: bool
) -> None:
    """In one run of several a busy machine may be why the client ended so late."""
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
    assert (first.recognise(Evidence(runs, Reference("x", {}))) is not None) == is_told


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
    asked = ((mistake.key, mistake.recognise(evidence)) for mistake in (*CRASHES, *OTHER_CRASHES))
    return next((key, advice) for key, advice in asked if advice is not None)
