"""Mistakes recognized from a traceback: each entry has a pattern, the cause and the next step.

The patterns match messages of rclpy 7.1 and of Python. The order of the entries matters, because the first pattern that
matches decides. Besides the groups of its pattern, a text may use what `meaning` and `names` of `python_errors` return.
"""

from __future__ import annotations

from autograder.foreign_code import KnownTraceback
from autograder.kit.mistakes.python_errors import MARKS
from autograder.verdict import ASKS_FOR_INPUT

NOT_SPUN_WHILE_CALLING = (
    "Write call_async(...) instead of call(...), and wait for the future that it returns: "
    "rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=5.0) spins the node while it waits. Or "
    "spin the node in a background thread while you use call(...)."
)
"""The advice for a call that waits for its answer although nothing spins its node."""

_CALLED_BY_RCLPY = (
    r"(?:\A|rclpy/(?:executors|task|event_handler|action/client|action/server)\.py\".*\n(?: .*\n){1,2})"
)
"""Matches the lines in a traceback in which rclpy calls a callback. In a notebook, whose tracebacks omit rclpy's own
lines, it matches the beginning of the traceback.
"""
_UNKNOWN_KEYWORD = r"Invalid arguments passed to constructor: '?(?P<keyword>\w+(?:, \w+)*)"
_CALLED = r"\n(?: .*\n)*"
"""Matches the lines between the student's line of code and Python's message about it. In a program, those lines include
a call in the module of the message type.
"""

KNOWN = (
    KnownTraceback(
        r"^\s*(?:SyntaxError|IndentationError|TabError): (?P<what>.*?)[.?]*$",
        "Python could not read the program: {what}. {why}",
        "{next_step}",
        "syntax_error",
    ),
    KnownTraceback(
        # When the grader runs a notebook, input() raises StdinNotImplementedError. In a program without a keyboard it
        # raises EOFError.
        r"^(?:IPython\.core\.error\.)?StdinNotImplementedError\b|^EOFError: EOF when reading a line",
        ASKS_FOR_INPUT.text,
        ASKS_FOR_INPUT.next_step,
        ASKS_FOR_INPUT.key,
    ),
    KnownTraceback(
        r"NotInitializedException|rclpy\.init has not been called|context (?:must be initialized|is not valid)"
        # The last alternative matches an executor that is made before ROS was started, for example by rclpy.spin.
        r"|guard_condition\.py\".*\n.*self\._context\.handle",
        "The node was made before ROS was started or after ROS was shut down.",
        "In a notebook, call start_ros() before you make a node. In a program, call rclpy.init() before you make a "
        "node.",
        "not_initialized",
    ),
    KnownTraceback(
        r"no attribute '_(?:Node__\w+|default_callback_group|parameters|parameter_overrides|context|logger|handle)'"
        r"|rclpy/node\.py\".*\n(?: .*\n){1,2}AttributeError: '\w+' object has no attribute '_"
        r"|TypeError: descriptor '__init__' |TypeError: Node\.__init__\(\) missing .*'node_name'",
        "Your class uses a method or attribute of Node before Node was set up: super().__init__('a_name') is "
        "missing, has no name, or comes too late.",
        "Write def __init__(self): in the class, with two underscores on each side of init. Make "
        "super().__init__('your_node_name') the first line of this method.",
        "super_init_missing",
    ),
    KnownTraceback(
        rf"\.handle\b.*{MARKS}TypeError: 'method' object does not support the context manager protocol"
        r"|handle cannot be modified",
        "A method or attribute of your node is called `handle`, but Node itself needs this name.",
        "Rename your method or attribute, for example to handle_message.",
        "handle_overwritten",
    ),
    KnownTraceback(
        r"property '(?P<name>publishers|subscriptions|clients|services|timers|guards|waitables|handle|context"
        r"|default_callback_group)' of '\w+' object has no setter",
        "Your class assigns a value to {name}, but Node already uses this name for something else.",
        "Give your attribute another name, for example my_{name} or {name}_.",
        "node_attribute_overwritten",
    ),
    KnownTraceback(
        r"Expected QoSProfile or int",
        "rclpy expects the queue depth, a number such as 10, and got a different argument or a string.",
        "Write create_publisher(Type, 'topic', 10) or create_subscription(Type, 'topic', callback, 10). Keep this "
        "order, and do not put the 10 in quotation marks.",
        "qos_arguments_swapped",
    ),
    KnownTraceback(
        r"missing \d+ required positional arguments?: .*'?qos_profile",
        "The queue depth is missing: the number of messages that may wait for a slow subscriber.",
        "Add a depth such as 10 as the last argument: create_publisher(Type, 'topic', 10), create_subscription(Type, "
        "'topic', callback, 10).",
        "qos_depth_missing",
    ),
    KnownTraceback(
        r"no signature found for builtin",
        "A callback is a built-in function, such as deque.append. rclpy cannot find out which arguments this function "
        "takes.",
        "Put the built-in function into a lambda: lambda message: your_list.append(message).",
        "builtin_callback",
    ),
    KnownTraceback(
        r"^ +.*(?:add_done_callback\(|create_(?:timer|subscription|service)\(|ActionServer\(|\w*callback=)(?:.*[ (=])?"
        rf"(?P<called>(?:\w+\.)+\w+)\(\)[,)].*{MARKS}TypeError: (?:[\w.<>]+\.)?(?P<method>\w+)\(\) missing",
        "The parentheses after {method} call the method at once, without the arguments that ROS would pass.",
        "Pass only the method's name, {called}, without parentheses. ROS calls the method later.",
        "callback_signature",
    ),
    KnownTraceback(
        rf"{_CALLED_BY_RCLPY}TypeError: (?P<what>.*positional argument.*)",
        "A callback takes the wrong number of arguments: {what}.",
        "Correct the parameters of the callback in its `def` line. In a method, the first parameter is always self. "
        "After that, a timer's callback has no parameter; a service's callback has request and response; any other "
        "callback has exactly one: the message, the goal or the future.",
        "callback_signature",
    ),
    KnownTraceback(
        r"Expected .* callback|[Cc]allback should be either",
        "Either a callback was called at once (cb() instead of cb), or it takes the wrong number of arguments.",
        "Pass the callback's name without parentheses. Apart from self, a timer's callback has no parameter, and a "
        "subscription's callback has one, the message.",
        "callback_signature",
    ),
    KnownTraceback(
        rf"{_CALLED_BY_RCLPY}TypeError: 'NoneType' object is not callable",
        "ROS needs a method as the callback, but got None: your code called the method and passed what it returned.",
        "Pass the method's name without parentheses, as in create_timer(0.5, self.say_hello). ROS calls the method "
        "later.",
        "timer_callback_called",
    ),
    KnownTraceback(
        r"The (?:service|message) type provided is not valid|AttributeError: type object '\w+' has no attribute "
        r"'_TYPE_SUPPORT'|rclpy needs the type of an action"
        r"|rclpy/action/(?:client|server)\.py\", line \d+, in __init__\nSegmentation fault",
        "rclpy needs the type of a message, a service or an action here, but your code passes something else.",
        "Import the type and pass it as the first of the two: first the type without quotation marks, then the name "
        "of the topic, service or action. (In ROS 1, the name comes first.) Examples: create_publisher(String, "
        "'topic', 10), create_service(AddTwoInts, 'add_two_ints', self.add), ActionServer(self, Fibonacci, "
        "'fibonacci', ...). Python's own str is not String, and AddTwoInts.Request is not AddTwoInts.",
        "message_type",
    ),
    KnownTraceback(
        r"(?:Service|Action|Interface)\w* classes can not be instantiated",
        "The type of a service or an action only groups other types, such as Request and Response. You cannot make "
        "an object of the group.",
        "Make an object of the type inside that you need, such as AddTwoInts.Request() or Fibonacci.Goal().",
        "request_not_instantiated",
    ),
    KnownTraceback(
        r"TypeError: Expected <class '[\w.]+\.msg\.\w+\.(?P<type>\w+)'>, got <class '(?:\w+\.)*(?P<got>\w+)'>"
        r"|(?:publish(?:_feedback)?|send_goal(?:_async)?|call(?:_async)?)\((?:.*\n)+TypeError:?\s*\z",
        "Your code sent a plain value, or the type itself, and not an object of the type {type:that is needed}.",
        "First make the object, with parentheses: message = String(), request = AddTwoInts.Request(), goal = "
        "Fibonacci.Goal() or feedback = Fibonacci.Feedback(). Then set its field, and send the object.",
        "raw_value_published",
    ),
    KnownTraceback(
        r"AssertionError: (?P<what>The '\w+' (?:field|numpy\.ndarray) must .*)|bad argument type for built-in operation"
        r"|SystemError: <(?:function|class|built-in).*returned (?:a result with an exception|NULL)"
        rf"|publish\(msg\){MARKS}AttributeError: '(?:float|int)' object has no attribute 'x'",
        "Your code set a field to a value that this field cannot hold: {what:a wrong type, or a number that is too "
        "large}.",
        "Print the value and type(value) before the line that sets the field. int(...) converts a value to a whole "
        "number, float(...) to a number with a decimal point, and str(...) to a string. For large whole "
        "numbers use no float, because it keeps only about 16 digits. If a field consists of three numbers, set each "
        "one separately: command.linear.x = 0.5.",
        "field_type",
    ),
    KnownTraceback(
        r"AttributeError: '(?P<type>\w+)' object attribute '(?P<field>\w+)' is read-only",
        "Your code, or an earlier version of it, has set the field {field} on the type {type} and not on an object. "
        "Until the kernel is restarted, this field cannot be set on any object of the type.",
        "Write parentheses after the type when you make an object, as in {owner:message} = String(). Then choose "
        "Kernel, Restart Kernel and Run All Cells, because only a restart repairs the type.",
        "field_type",
    ),
    KnownTraceback(
        # These attributes belong to every node and to no message.
        rf"\bself\.(?:get_logger|get_clock|create_\w+)\b.*{MARKS}AttributeError: '(?P<type>String|Twist|U?Int\d+"
        r"|\w+_(?:Request|Response|Goal|FeedbackMessage)|ServerGoalHandle|Future)' object has no attribute "
        r"'(?:get_logger|get_clock|create_\w+)'",
        "self is an object of the type {type} here, not your node. In a method, Python passes the node as the first "
        "parameter, whatever its name is.",
        "Make self the first parameter, as in def on_message(self, message) or def add(self, request, response).",
        "callback_signature",
    ),
    KnownTraceback(
        r"AttributeError: 'Twist' object has no attribute '\w+'|^NameError: name '(?:linear|angular)' is not defined",
        "A Twist has two parts, linear and angular, and each has the numbers x, y and z.",
        "Write the message, then the part, then the number: {owner:command}.linear.x = 0.5 drives straight ahead, "
        "and {owner:command}.angular.z = 0.5 turns to the left.",
        "field_typo",
    ),
    KnownTraceback(
        r"AttributeError: '\w+_FeedbackMessage' object has no attribute '(?P<name>\w+)'",
        "The message has no field called {name}.",
        "In an action's feedback callback, the fields are inside the field `feedback`: "
        "{owner:message}.feedback.partial_sequence. The message does not contain the goal handle. Store the goal "
        "handle in the node that sends the goal, as in self.goal_handle.",
        "field_typo",
    ),
    KnownTraceback(
        r"AttributeError: '(?P<type>\w+_(?:Request|Response|Goal|Result|Feedback))' object has no attribute "
        rf"'(?P<name>\w+)'|\b(?P<made>\w+\.(?:Request|Response|Goal|Result|Feedback))\(.*{_CALLED}.*{_UNKNOWN_KEYWORD}",
        "{type}{made} has no field called {name}{keyword}.",
        "`ros2 interface show` lists the fields of a type. AddTwoInts has a and b in its Request and sum in its "
        "Response; Fibonacci has order in its Goal, sequence in its Result and partial_sequence in its Feedback. A "
        "service's callback gets the request first and then the response: def add(self, request, response).",
        "field_typo",
    ),
    KnownTraceback(
        r"AttributeError: '(?P<type>String|U?Int\d+|Float\d+|Bool|Vector3)' object has no attribute '(?P<name>\w+)'"
        rf"|{_UNKNOWN_KEYWORD}",
        "The message has no field called {name}{keyword}.",
        "`ros2 interface show` lists the fields of a type. Write the name exactly as it is listed. A String has a "
        "single field, `data`.",
        "field_typo",
    ),
    KnownTraceback(
        # A notebook's traceback omits rclpy's own lines, so only the last line remains to be matched.
        r"(?:rclpy/service\.py\".* in send_response|service_send_response)(?:.*\n)+TypeError|\A\s*TypeError\s*\z",
        "A service callback did not return a response object. It returned nothing, one field of the response, or the "
        "type without parentheses.",
        "End the callback with `return response`, where `response` is the object that the callback was given.",
        "callback_returned_none",
    ),
    KnownTraceback(
        r"'NoneType' object has no attribute '(?:spin|spin_once|spin_until_future_complete|add_node|create_task)'",
        "{owner:The executor of the node} is None, because a node has an executor only while that executor spins it.",
        "Write rclpy.spin(your_node) or, to wait for an answer, rclpy.spin_until_future_complete(your_node, "
        "your_future). To use your own executor, write executor = SingleThreadedExecutor(), "
        "executor.add_node(your_node), executor.spin().",
        "executor_not_kept",
    ),
    KnownTraceback(
        r"AttributeError: '(?:Future|Task)' object has no attribute '(?P<name>\w+)'",
        "Your code reads {name} from {owner:a future}. That is a future: it will contain the answer, but it is not "
        "the answer.",
        "Wait until the future is done, then read {owner:your_future}.result().{name}. Outside of callbacks, wait "
        "with rclpy.spin_until_future_complete(your_node, {owner:your_future}, timeout_sec=5.0). In a callback, do "
        "not wait: move the code that uses the answer into a function, and pass that function to "
        "{owner:your_future}.add_done_callback(...).",
        "result_read_too_early",
    ),
    KnownTraceback(
        r"^ +(?:.*[^\w.)])?[A-Za-z_][\w.]*\.(?:accepted|cancel_goal_async|get_result_async)\b.*\n"
        r"(?:[ ~^]*\n)?AttributeError: 'NoneType' object has no attribute '(?:accepted|cancel_goal_async"
        r"|get_result_async)'",
        "{owner:The value before the dot} is None, but should be a goal handle. There are three possible causes: "
        "your code did not store the handle, or stored it before the answer to the goal had arrived, or the function "
        "that should return the handle returns nothing.",
        "Wait until the future of send_goal_async is done. Then store its result in {owner:a variable}. If another "
        "function stores the handle, such as the lab's send_goal, call that function before you use the handle.",
        "result_read_too_early",
    ),
    KnownTraceback(
        r"'NoneType' object has no attribute '(?:sum|result|accepted|status|sequence|cancel_goal_async|"
        r"get_result_async|goals_canceling)'",
        "Your code read the answer before it had arrived: {owner:the result of a future} is None until the future is "
        "done.",
        "Wait before you read the answer: rclpy.spin_until_future_complete(your_node, {future:your_future}). Or move "
        "the code that uses the answer into a function, and pass that function to "
        "{future:your_future}.add_done_callback(...). If your code does wait, no answer came in time: wait longer, "
        "or call wait_for_service (or wait_for_server) before you send. {future:your_future}.done() tells you "
        "whether the answer has arrived.",
        "result_read_too_early",
    ),
    KnownTraceback(
        r"ModuleNotFoundError: No module named '(?P<name>[\w.]+)'",
        "Python cannot find the module {name}.",
        "Compare the name letter by letter with the import in the lab's text (.msg, .srv, .action). If the module is "
        "in your own workspace, run `colcon build` and `source install/setup.bash` first. In setup.py, the list "
        "`packages` must contain each folder of your package, as in packages=[package_name, 'my_robot_pkg.helpers'].",
        "module_not_found",
    ),
    KnownTraceback(
        r"^ImportError: cannot import name '(?P<name>\w+)' from '(?P<module>(?:\w+\.)*\w+)'",
        "The module {module} does not contain {name}. {why}",
        "{next_step}",
        "module_not_found",
    ),
    KnownTraceback(
        r", in await_or_execute\n(?:.*\n)+.*generator already executing",
        "A callback calls spin although the executor that called the callback is already spinning.",
        "Never call spin or spin_until_future_complete inside a callback. Move the code that uses the answer into a "
        "function, and pass that function to the add_done_callback(...) of the future that call_async returned.",
        "nested_spin",
    ),
    KnownTraceback(
        r"NotImplementedError",
        "The part that you have to write is not written yet.",
        "Find the TODO and write the code there. Each hint below it opens separately.",
        "not_written",
    ),
)
