"""Mistakes that a traceback of rclpy gives away: pattern, cause, next step.

The patterns are what rclpy 7.1 and Python say; each was reproduced. The order matters: the first that fits wins.
"""

from __future__ import annotations

from autograder.kit.field_crashes import FIELDS, Crash
from autograder.kit.python_names import MARKS
from autograder.verdict import ASKS_FOR_INPUT

__all__ = ["KNOWN", "NOT_SPUN_WHILE_CALLING", "Crash"]


NOT_SPUN_WHILE_CALLING = (
    "Write call_async(...) in place of call, and wait for the future that it returns: "
    "rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=5.0) spins the node while it waits. Or spin "
    "the node in the background while you use call."
)
"""What to do where a call waits for its answer, and nothing spins its node."""

_CALLED_BY_RCLPY = (
    r"(?:\A|rclpy/(?:executors|task|event_handler|action/client|action/server)\.py\".*\n(?: .*\n){1,2})"
)
"""Before what is raised where rclpy calls a callback; a notebook's traceback leaves rclpy's own lines out."""

_WITHOUT_NAME = r"TypeError: Node\.__init__\(\) missing 1 required positional argument: 'node_name'"

KNOWN = (
    Crash(
        "launch_error",
        r"RCLError: .*Couldn't parse remap rule: '(?:-r |--remap )?(?P<rule>[^']*)'",
        "ROS cannot read the remapping rule {rule}, so the program that was given it ended at once.",
        "A rule is made of two names. A name has letters, digits, underscores and slashes, and no slash at its end.",
    ),
    Crash(
        "syntax_error",
        r"^\s*(?:SyntaxError|IndentationError|TabError): (?P<what>.*?)[.?]*$",
        "Python could not read the program: {what}. {why}",
        "{next_step}",
    ),
    Crash(
        ASKS_FOR_INPUT.key,
        # In a class's kernel; in a program, whose standard input is empty.
        r"^(?:IPython\.core\.error\.)?StdinNotImplementedError\b|^EOFError: EOF when reading a line",
        ASKS_FOR_INPUT.text,
        ASKS_FOR_INPUT.next_step,
    ),
    Crash(
        "not_initialized",
        r"load_entry_point.*\n(?:[ ~^]*\n)? +File .*, in __init__\n(?:.*\n)*.*NotInitializedException",
        "The entry point names the class of your node, so nothing has called rclpy.init().",
        "In setup.py, let the entry point end in :main. This function starts ROS, makes the node and spins it.",
    ),
    Crash(
        "not_initialized",
        r"NotInitializedException|rclpy\.init has not been called|context (?:must be initialized|is not valid)"
        # An executor that was made before: spinning makes one.
        r"|guard_condition\.py\".*\n.*self\._context\.handle",
        "The node was made before ROS was started, or after it was shut down.",
        "In a notebook, call start_ros() before you make a node. In a program, call rclpy.init() before you make "
        "the node.",
    ),
    Crash(
        "super_init_missing",
        rf"\bsuper\.__init__\(.*{MARKS}TypeError: descriptor '__init__'",
        "The parentheses after super are missing.",
        "Write super().__init__('your_node_name'): one pair of parentheses after super, and one with the name.",
    ),
    Crash(
        "super_init_missing",
        r"no attribute '_(?:Node__\w+|default_callback_group|parameters|parameter_overrides|context|logger|handle)'"
        r"|rclpy/node\.py\".*\n(?: .*\n){1,2}AttributeError: '\w+' object has no attribute '_"
        r"|descriptor '__init__' (?:requires|of) .*'super'",
        "The class uses the Node before the Node was set up: super().__init__('a_name') is missing or comes too late.",
        "Make super().__init__('your_node_name') the first line of __init__.",
    ),
    Crash(
        "super_init_missing",
        rf"__init__\(.*{MARKS}{_WITHOUT_NAME}",
        "The node has no name: __init__ of Node is called without one.",
        "Write the name between the parentheses: super().__init__('your_node_name').",
    ),
    Crash(
        "crashed",
        rf"\bNode\(.*{MARKS}{_WITHOUT_NAME}",
        "The node has no name: Node is called without one.",
        "Write the name between its parentheses: Node('your_node_name'). In the class of a node, "
        "super().__init__('your_node_name') makes the node, and no other is needed.",
    ),
    Crash(
        "super_init_missing",
        _WITHOUT_NAME,
        "The node has no name: its class has no method __init__ that gives it one.",
        "Write def __init__(self): in the class, indented by four spaces, with two underscores on each side of init. "
        "Its first line is super().__init__('your_node_name').",
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
        "field_type",
        r"^ +.*[,=] *(?P<depth>[\"']\d+[\"'])\).*\n(?:.*\n)*.*Expected QoSProfile or int",
        "The depth, how many messages wait in the queue, is a number, and {depth} is a string.",
        "Write it without quotation marks, as in create_publisher(Type, 'topic', 10).",
    ),
    Crash(
        "qos_arguments_swapped",
        r"Expected QoSProfile or int",
        "The arguments of create_publisher or create_subscription are in the wrong order.",
        "The order is create_publisher(Type, 'topic', 10) and create_subscription(Type, 'topic', callback, 10).",
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
        r"(?:create_subscription\([^,\n]*,[^,\n]*, *(?:callback *= *)?(?P<called>[\w.]+)(?:.*\n)+)?"
        r".*no signature found for builtin",
        "A builtin such as list.append or deque.append was given as a callback; rclpy cannot look at its arguments.",
        "Wrap it: lambda message: {called:your_list.append}(message).",
    ),
    Crash(
        "callback_signature",
        r"TypeError: (?:[\w.<>]+\.)?(?P<class>\w+)\.(?P<method>\w+)\(\) takes 0 positional arguments but \d+ w",
        "The method {method} of {class} has no parameter self, but Python hands the object itself to every method.",
        "Write self first between its parentheses: def {method}(self).",
    ),
    Crash(
        "callback_signature",
        r"^ +.*(?:add_done_callback\(|create_(?:timer|subscription|service)\(|ActionServer\(|\w*callback=)(?:.*[ (=])?"
        r"(?P<called>(?:\w+\.)+\w+)\(\)[,)].*\n"
        r"(?:[ ~^]*\n)?TypeError: (?:[\w.<>]+\.)?(?P<method>\w+)\(\) missing \d+ required positional arguments?: ",
        "The parentheses after {method} call it at once, without the arguments that ROS would give it.",
        "Write only its name, {called}, without parentheses: ROS calls the method when it is time.",
    ),
    Crash(
        "callback_signature",
        r"create_subscription\([^,\n]*,[^,\n]*, *(?:callback *= *)?(?P<name>[\w.]+)\(\)(?:.*\n)+"
        r".*callback should be either",
        "{name}() calls the method at once, so the subscription got what the method returned, and not the method.",
        "Pass the method itself, without parentheses after it: {name}.",
    ),
    Crash(
        "callback_signature",
        r"create_subscription\([^,\n]*,[^,\n]*, *(?:callback *= *)?self\.(?P<name>\w+) *[,)](?:.*\n)+"
        r".*callback should be either",
        "The callback {name} takes the wrong number of arguments: a subscription hands it the message.",
        "Write one parameter for the message besides self: def {name}(self, message).",
    ),
    Crash(
        "callback_signature",
        rf"{_CALLED_BY_RCLPY}TypeError: (?P<what>.*positional argument.*)",
        "A callback takes the wrong number of arguments: {what}.",
        "Change what is between its parentheses where it is defined. Besides self, a timer's callback takes nothing, a "
        "service's takes request and response, and any other takes one thing: the message, the goal, the future.",
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
        r"The (?P<kind>service|message) type provided is not valid \(<class '[\w.]+\.(?P<type>\w+?)"
        r"(?P<part>_(?:Request|Response|Goal|Result|Feedback))?'>",
        "{type}{part} is not the type of a {kind}.",
        "For a service write the service itself, such as AddTwoInts, without .Request or .Response. A topic takes a "
        "message, such as String.",
    ),
    Crash(
        "message_type",
        r"AttributeError: type object 'type' has no attribute '_TYPE_SUPPORT'",
        "The type of a message or a service is needed here, and your code gives a class that is none, such as Python's "
        "own str or int.",
        "Import the type of ROS, and write its name there: String of std_msgs.msg in place of str.",
    ),
    Crash(
        "message_type",
        r"AttributeError: type object '(?P<got>\w+)' has no attribute '_TYPE_SUPPORT'",
        "The type of a message or a service is needed here, and your code gives a value of the type {got}.",
        "Import the type, and write its name without quotation marks, before that of the topic, service or action (in "
        "ROS 1 the name comes first): create_publisher(String, 'topic', 10), create_service(AddTwoInts, "
        "'add_two_ints', self.add), ActionServer(self, Fibonacci, 'fibonacci', ...).",
    ),
    Crash(
        "request_not_instantiated",
        r"(?:Service|Action|Interface)\w* classes can not be instantiated",
        "The type of a service or an action only holds its parts together: no object can be made of it.",
        "Make the part that you need, such as AddTwoInts.Request() or Fibonacci.Goal().",
    ),
    Crash(
        "raw_value_published",
        r"TypeError: Expected <class '[\w.]+'>, got <class '[\w.]+\.Metaclass_(?P<type>\w+)'>",
        "What your code published is the type {type} itself; a message of this type is expected.",
        "Write parentheses after the type where you make the message: message = {type}(). In a notebook, then choose "
        "Kernel, Restart Kernel and Run All Cells: a field that was set on the type itself stays there.",
    ),
    Crash(
        "raw_value_published",
        r"TypeError: Expected <class '[\w.]+\.msg\.\w+\.(?P<type>\w+)'>, got <class '(?:\w+\.)*(?P<got>\w+)'>",
        "What your code published is of the type {got}; a message of the type {type} is expected.",
        "Make a message first, message = {type}(), fill its field and publish that: publish(message).",
    ),
    Crash(
        "raw_value_published",
        r"publish_feedback\((?:.*\n)+TypeError:?\s*\z",
        "A bare value was sent where feedback is expected, or the type itself, without parentheses.",
        "Make the feedback first, with parentheses: feedback = Fibonacci.Feedback(). Then fill its field and send it.",
    ),
    Crash(
        "raw_value_published",
        r"send_goal(?:_async)?\((?:.*\n)+TypeError:?\s*\z",
        "A bare value was sent where a goal is expected, or the type itself, without parentheses.",
        "Make the goal first, with parentheses: goal = Fibonacci.Goal(). Then fill its field and send it.",
    ),
    Crash(
        "raw_value_published",
        r"call(?:_async)?\((?:.*\n)+TypeError:?\s*\z",
        "A bare value was sent where a request is expected, or the type itself, without parentheses.",
        "Make the request first, with parentheses: request = AddTwoInts.Request(). Then fill its fields and send it.",
    ),
    Crash(
        "raw_value_published",
        r"[Ee]xpected (?:<class )?'?[\w.]*(?:String|Int\d+|Message)\b.*got|TypeError: Expected [\w/.<>' ]+, got"
        r"|publish\((?:.*\n)+TypeError:?\s*\z",
        "A bare value was sent where a message is expected.",
        "Make the message first, fill its field and send that.",
    ),
    Crash(
        "result_missing",
        r"The 'result' field must be a sub message of type '\w+_Result'",
        "The execute callback of an action server returned no result.",
        "End it with `return result`, a Fibonacci.Result() with its field filled, also where the goal is canceled.",
    ),
    *FIELDS,
    Crash(
        "callback_returned_none",
        r"(?:rclpy/service\.py\".* in send_response|service_send_response)(?:.*\n)+TypeError",
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
        "callback_signature",
        r"^ +.*add_done_callback\((?P<called>[\w.]+)\(.*\n(?:.*\n)+.*'NoneType' object has no attribute",
        "In add_done_callback(...), {called} has parentheses of its own: so it is called before the answer is there.",
        "Write only its name between the parentheses: add_done_callback({called}).",
    ),
    Crash(
        "result_read_too_early",
        r"^ +(?:.*[^\w.)])?[A-Za-z_][\w.]*\.(?:accepted|cancel_goal_async|get_result_async)\b.*\n"
        r"(?:[ ~^]*\n)?AttributeError: 'NoneType' object has no attribute '(?:accepted|cancel_goal_async"
        r"|get_result_async)'",
        "{owner:What is before the dot} is None: nothing has kept the handle of the goal there, or it was kept before "
        "the answer had arrived, or the function that should give it returns nothing.",
        "Wait until the future of send_goal_async is done, then keep its result in {owner:it}. Where another function "
        "keeps the handle, such as the send_goal of a lab, call that one first, and read the handle where it keeps it.",
    ),
    Crash(
        "call_never_spun",
        rf"\.call\(.*\btimeout_sec\b.*{MARKS}AttributeError: 'NoneType' object has no attribute",
        "A call with timeout_sec gives None when its time is over: no answer came in this time, or nothing spun the "
        "node while it waited, so that the node did not take the answer.",
        NOT_SPUN_WHILE_CALLING,
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
        "Packages of your own workspace need `colcon build` and `source install/setup.bash` first.",
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
