"""Mistakes recognized from a traceback of rclpy: pattern, cause, next step.

The patterns match messages of rclpy 7.1 and of Python; each message was reproduced. The order matters, because the
first match wins.
"""

from __future__ import annotations

from dataclasses import dataclass

from autograder.kit.mistakes.names_in_tracebacks import MARKS
from autograder.verdict import ASKS_FOR_INPUT


@dataclass(frozen=True)
class Crash:
    """A known traceback.

    Attributes:
        key: The mistake's name.
        pattern: Regular expression, searched in the traceback (multi-line). ``text`` and ``next_step`` may use its
            named groups.
        text: What happened and why.
        next_step: What to do now.
    """

    key: str
    pattern: str
    text: str
    next_step: str


NOT_SPUN_WHILE_CALLING = (
    "Write call_async(...) in place of call, and wait for the future that it returns: "
    "rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=5.0) spins the node while it waits. Or spin "
    "the node in the background while you use call."
)
"""Advice for a call that waits for its answer while its node is not spun."""

_CALLED_BY_RCLPY = (
    r"(?:\A|rclpy/(?:executors|task|event_handler|action/client|action/server)\.py\".*\n(?: .*\n){1,2})"
)
"""Matches the place in a traceback where rclpy calls a callback. In a notebook, whose tracebacks omit rclpy's own
lines, it matches the beginning.
"""
_UNKNOWN_KEYWORD = r"Invalid arguments passed to constructor: '?(?P<keyword>\w+(?:, \w+)*)"
_CALLED = r"\n(?: .*\n)*"
"""Matches the lines between a line of code and Python's message about it; a program's traceback shows the message
type's module there.
"""

KNOWN = (
    Crash(
        "syntax_error",
        r"^\s*(?:SyntaxError|IndentationError|TabError): (?P<what>.*?)[.?]*$",
        "Python could not read the program: {what}. {why}",
        "{next_step}",
    ),
    Crash(
        ASKS_FOR_INPUT.key,
        # When the grader runs a notebook, input() raises the first error. In a program without a keyboard it raises
        # the second.
        r"^(?:IPython\.core\.error\.)?StdinNotImplementedError\b|^EOFError: EOF when reading a line",
        ASKS_FOR_INPUT.text,
        ASKS_FOR_INPUT.next_step,
    ),
    Crash(
        "not_initialized",
        r"NotInitializedException|rclpy\.init has not been called|context (?:must be initialized|is not valid)"
        # The last alternative is for an executor that was made earlier; spinning without one makes one.
        r"|guard_condition\.py\".*\n.*self\._context\.handle",
        "The node was made before ROS was started, or after it was shut down.",
        "In a notebook, call start_ros() before you make a node. In a program, call rclpy.init() before you make "
        "the node.",
    ),
    Crash(
        "super_init_missing",
        r"no attribute '_(?:Node__\w+|default_callback_group|parameters|parameter_overrides|context|logger|handle)'"
        r"|rclpy/node\.py\".*\n(?: .*\n){1,2}AttributeError: '\w+' object has no attribute '_"
        r"|TypeError: descriptor '__init__' |TypeError: Node\.__init__\(\) missing .*'node_name'",
        "The class uses the Node before the Node was set up: super().__init__('a_name') is missing, has no name, or "
        "comes too late.",
        "Write def __init__(self): in the class, with two underscores on each side, and make "
        "super().__init__('your_node_name') its first line.",
    ),
    Crash(
        "handle_overwritten",
        rf"\.handle\b.*{MARKS}TypeError: 'method' object does not support the context manager protocol"
        r"|handle cannot be modified",
        "A method or attribute of your node is called handle, a name that Node itself needs.",
        "Rename it, for example to handle_message.",
    ),
    Crash(
        "node_attribute_overwritten",
        r"property '(?P<name>publishers|subscriptions|clients|services|timers|guards|waitables|handle|context"
        r"|default_callback_group)' of '\w+' object has no setter",
        "Your class assigns to a name that Node already uses for something else ({name}).",
        "Give your attribute another name, for example my_{name} or {name}_.",
    ),
    Crash(
        "qos_arguments_swapped",
        r"Expected QoSProfile or int",
        "In the place of the depth, a number such as 10, rclpy got something else: a string, or a different argument.",
        "Write create_publisher(Type, 'topic', 10) or create_subscription(Type, 'topic', callback, 10), in this order, "
        "the 10 without quotation marks.",
    ),
    Crash(
        "qos_depth_missing",
        r"missing \d+ required positional arguments?: .*'?qos_profile",
        "The depth is missing: how many messages wait in the queue of a slow subscriber.",
        "Add it as the last argument: create_publisher(Type, 'topic', 10), create_subscription(Type, 'topic', "
        "callback, 10).",
    ),
    Crash(
        "builtin_callback",
        r"no signature found for builtin",
        "A builtin such as list.append or deque.append was given as a callback; rclpy cannot look at its arguments.",
        "Wrap it: lambda message: your_list.append(message).",
    ),
    Crash(
        "callback_signature",
        r"^ +.*(?:add_done_callback\(|create_(?:timer|subscription|service)\(|ActionServer\(|\w*callback=)(?:.*[ (=])?"
        rf"(?P<called>(?:\w+\.)+\w+)\(\)[,)].*{MARKS}TypeError: (?:[\w.<>]+\.)?(?P<method>\w+)\(\) missing",
        "The parentheses after {method} call it at once, without the arguments that ROS would give it.",
        "Write only its name, {called}, without parentheses: ROS calls the method when it is time.",
    ),
    Crash(
        "callback_signature",
        rf"{_CALLED_BY_RCLPY}TypeError: (?P<what>.*positional argument.*)",
        "A callback takes the wrong number of arguments: {what}.",
        "Change what is between the parentheses of its def. First comes self; besides, a timer's callback "
        "takes nothing, a service's takes request and response, and any other takes one thing: the message, the goal, "
        "the future.",
    ),
    Crash(
        "callback_signature",
        r"Expected .* callback|[Cc]allback should be either",
        "A callback has the wrong form: it was called at once (cb() instead of cb), or it takes the wrong number of "
        "arguments.",
        "Pass the function itself, without parentheses after it. Besides self, a timer's callback takes nothing and a "
        "subscription's takes the message.",
    ),
    Crash(
        "timer_callback_called",
        rf"{_CALLED_BY_RCLPY}TypeError: 'NoneType' object is not callable",
        "ROS was to call a method of yours, and got None in its place: what the method had returned.",
        "Write the method's name without parentheses, as in create_timer(0.5, self.say_hello): ROS calls it, not you.",
    ),
    Crash(
        "message_type",
        r"The (?:service|message) type provided is not valid|AttributeError: type object '\w+' has no attribute "
        r"'_TYPE_SUPPORT'",
        "The type of a message, a service or an action is needed here, and your code gives something else.",
        "Import the type, and write its name without quotation marks, before that of the topic, service or action (in "
        "ROS 1 the name comes first): create_publisher(String, 'topic', 10), create_service(AddTwoInts, "
        "'add_two_ints', self.add), ActionServer(self, Fibonacci, 'fibonacci', ...). Python's own str is not String, "
        "and AddTwoInts.Request is only a part of AddTwoInts.",
    ),
    Crash(
        "request_not_instantiated",
        r"(?:Service|Action|Interface)\w* classes can not be instantiated",
        "The type of a service or an action only holds its parts together: no object can be made of it.",
        "Make the part that you need, such as AddTwoInts.Request() or Fibonacci.Goal().",
    ),
    Crash(
        "raw_value_published",
        r"TypeError: Expected <class '[\w.]+\.msg\.\w+\.(?P<type>\w+)'>, got <class '(?:\w+\.)*(?P<got>\w+)'>"
        r"|(?:publish(?:_feedback)?|send_goal(?:_async)?|call(?:_async)?)\((?:.*\n)+TypeError:?\s*\z",
        "A bare value was sent, or the type itself, instead of a {type:message, request or goal}.",
        "Make the object first, with parentheses, fill its field, and send that: message = String(), request = "
        "AddTwoInts.Request(), goal = Fibonacci.Goal() or feedback = Fibonacci.Feedback().",
    ),
    Crash(
        "field_type",
        r"AssertionError: (?P<what>The '\w+' (?:field|numpy\.ndarray) must .*)|bad argument type for built-in operation"
        r"|SystemError: <(?:function|class|built-in).*returned (?:a result with an exception|NULL)"
        rf"|publish\(msg\){MARKS}AttributeError: '(?:float|int)' object has no attribute 'x'",
        "A field of a message got a value that it cannot take: {what:another type, or a number that is too large}.",
        "Print the value, and its type(...), above the line that assigns it. int(...) makes a whole number of it, "
        "float(...) a number with a point, and str(...) a string. Set the numbers of a field with three numbers "
        "one by one: command.linear.x = 0.5.",
    ),
    Crash(
        "field_type",
        r"AttributeError: '(?P<type>\w+)' object attribute '(?P<field>\w+)' is read-only",
        "The field {field} was set on the type {type} itself, by this code or by an older version of it. Now no object "
        "of this type can be filled any more.",
        "Write parentheses after each type that makes an object, as in {owner:message} = String(). Then choose Kernel, "
        "Restart Kernel and Run All Cells: only this makes the type whole again.",
    ),
    Crash(
        "callback_signature",
        # Attributes that every node has and no message has.
        rf"\bself\.(?:get_logger|get_clock|create_\w+)\b.*{MARKS}AttributeError: '(?P<type>String|Twist|U?Int\d+"
        r"|\w+_(?:Request|Response|Goal|FeedbackMessage)|ServerGoalHandle|Future)' object has no attribute "
        r"'(?:get_logger|get_clock|create_\w+)'",
        "self is of the type {type} here: Python gives the node to the first name between the parentheses after def.",
        "Write self first, and then the others, as in def on_message(self, message) or def add(self, request, "
        "response).",
    ),
    Crash(
        "field_typo",
        r"AttributeError: 'Twist' object has no attribute '\w+'|^NameError: name '(?:linear|angular)' is not defined",
        "A Twist has two parts, linear and angular, and each has the numbers x, y and z.",
        "Name the message and the part: {owner:command}.linear.x = 0.5 drives straight ahead, "
        "{owner:command}.angular.z turns to the left.",
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
        r"AttributeError: '(?P<type>\w+_(?:Request|Response|Goal|Result|Feedback))' object has no attribute "
        rf"'(?P<name>\w+)'|\b(?P<made>\w+\.(?:Request|Response|Goal|Result|Feedback))\(.*{_CALLED}.*{_UNKNOWN_KEYWORD}",
        "{type}{made} has no field called {name}{keyword}.",
        "`ros2 interface show` lists the fields of each part: a and b of the Request and sum of the Response of "
        "AddTwoInts; order, sequence and partial_sequence of the Goal, Result and Feedback of Fibonacci. A service's "
        "callback is given the request first, then the response: def add(self, request, response).",
    ),
    Crash(
        "field_typo",
        r"AttributeError: '(?P<type>String|U?Int\d+|Float\d+|Bool|Vector3)' object has no attribute '(?P<name>\w+)'"
        rf"|{_UNKNOWN_KEYWORD}",
        "The message has no field called {name}{keyword}.",
        "`ros2 interface show` lists the fields of a type: write the name exactly as it is there. A String has a "
        "single field, data.",
    ),
    Crash(
        "callback_returned_none",
        # A notebook's traceback omits rclpy's own lines, so only the last line remains to be matched.
        r"(?:rclpy/service\.py\".* in send_response|service_send_response)(?:.*\n)+TypeError|\A\s*TypeError\s*\z",
        "A service callback returned no response: nothing at all, a field of it, or a type without parentheses.",
        "End the callback with `return` and the whole response that it was given, such as `return response`.",
    ),
    Crash(
        "executor_not_kept",
        r"'NoneType' object has no attribute '(?:spin|spin_once|spin_until_future_complete|add_node|create_task)'",
        "{owner:The executor of the node} is None: a node has an executor only while one spins it, and does not keep "
        "it.",
        "Write rclpy.spin(your_node), or rclpy.spin_until_future_complete(your_node, your_future) where you wait for "
        "an answer. With an executor of your own: executor = SingleThreadedExecutor(), executor.add_node(your_node), "
        "executor.spin().",
    ),
    Crash(
        "result_read_too_early",
        r"AttributeError: '(?:Future|Task)' object has no attribute '(?P<name>\w+)'",
        "{name} is read from {owner:a future}, which is the promise of an answer and not the answer.",
        "Read {owner:your_future}.result().{name}, once the future is done. Outside of callbacks, wait for that with "
        "rclpy.spin_until_future_complete(your_node, {owner:your_future}, timeout_sec=5.0); inside one, go on in a "
        "function that you give to {owner:your_future}.add_done_callback(...).",
    ),
    Crash(
        "result_read_too_early",
        r"^ +(?:.*[^\w.)])?[A-Za-z_][\w.]*\.(?:accepted|cancel_goal_async|get_result_async)\b.*\n"
        r"(?:[ ~^]*\n)?AttributeError: 'NoneType' object has no attribute '(?:accepted|cancel_goal_async"
        r"|get_result_async)'",
        "{owner:What is before the dot} is None: nothing has kept the handle of the goal there, or it was kept before "
        "the answer had arrived, or the function that should give it returns nothing.",
        "Wait until the future of send_goal_async is done, then keep its result in {owner:it}. If a different function "
        "keeps the handle, such as the send_goal of a lab, call that one first, and read the handle there.",
    ),
    Crash(
        "result_read_too_early",
        r"'NoneType' object has no attribute '(?:sum|result|accepted|status|sequence|cancel_goal_async|"
        r"get_result_async|goals_canceling)'",
        "The answer was read before it was there: {owner:the result of a future} is None until the future is done.",
        "Wait first: rclpy.spin_until_future_complete(your_node, {future:your_future}), or go on in a function that "
        "you give to {future:your_future}.add_done_callback(...). If your code does wait, no answer came in time: the "
        "wait is too short, or the other end is not there yet, and wait_for_service (or wait_for_server) has to come "
        "first. Look at {future:your_future}.done() before you read.",
    ),
    Crash(
        "module_not_found",
        r"ModuleNotFoundError: No module named '(?P<name>[\w.]+)'",
        "Python does not find the module {name}.",
        "Compare the name with the import in the lab's text (.msg, .srv, .action), letter by letter. "
        "Packages of your own workspace need `colcon build` and `source install/setup.bash` first. The list `packages` "
        "of setup.py has to name each folder of your package, as in packages=[package_name, 'my_robot_pkg.helpers'].",
    ),
    Crash(
        "module_not_found",
        r"^ImportError: cannot import name '(?P<name>\w+)' from '(?P<module>(?:\w+\.)*\w+)'",
        "The module {module} has nothing called {name}. {why}",
        "{next_step}",
    ),
    Crash(
        "nested_spin",
        r", in await_or_execute\n(?:.*\n)+.*generator already executing",
        "A callback spins although its own executor is spinning already.",
        "Never call spin or spin_until_future_complete inside a callback: give the future that call_async returned a "
        "function to go on in, with its add_done_callback(...).",
    ),
    Crash(
        "not_written",
        r"NotImplementedError",
        "The part that you are to write is still open.",
        "Find the TODO and write it; the hints below it open one at a time.",
    ),
)
