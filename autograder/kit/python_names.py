"""What Python says of a name or an attribute that it does not find: the rows of ``python_errors`` about them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

Row = tuple[str, str, str]
"""A pattern that is searched in a traceback, and the two texts, which may name its groups."""

MARKS = r"\n(?:[ ~^]*\n)?"
"""From a line of code to what Python says of it: perhaps a line of marks below the code."""
_OWN = r"AttributeError: '(?P<class>[A-Z]\w*)' object has no attribute '(?P<name>\w+)'"
_OF_RCLPY = (
    r"\w+GoalHandle|Publisher|Subscription|Timer|Client|Service|ActionClient|ActionServer|RcutilsLogger"
)
_OF_ANOTHER_TYPE = (
    "{owner:The value before .{name}} is of the type {class} here, which has nothing called {name}.",
    "Look at the line that sets it: it may be another value than you mean. If it is the right one, compare the "
    "name, letter by letter. If {name} is a function of the notebook or the program, write it alone: {name}(...).",
)
_MODULES = r"\w+_(?:msgs|srvs|interfaces)|math|random|rclpy|sys|threading|time"
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
"""The module of each name that beginners import from another one, or forget to import."""
_TYPE = (
    r"AttributeError: '[A-Z]\w*' object has no attribute "
    rf"'(?P<name>{'|'.join(_IMPORTED_FROM.values())}|AddTwoInts|Fibonacci)'"
)

NAMES: Sequence[Row] = (
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
        r"^ImportError: cannot import name",
        "",
        "Compare the import with the lab's text, letter by letter: is it .msg, .srv or .action, are the capitals the "
        "same, and is no letter missing?",
    ),
    (
        rf"^ +self\.(?P<name>\w+) == .*{MARKS}AttributeError: '[A-Z]\w*' object has no attribute",
        "Two equals signs compare, so self.{name} gets no value.",
        "Write a single one: self.{name} = ...",
    ),
    (
        r"\b(?:spin\w*|add_node)\((?P<what>[\w.]*).*\n(?:.*\n)*?AttributeError: '(?P<class>\w+)' object has no "
        r"attribute 'executor'",
        "A spin takes a node, and {what:what it got} is of the type {class} here.",
        "Give it your node. If a function is to make the node, end it with return node.",
    ),
    (
        r"AttributeError: 'NoneType' object has no attribute '(?P<name>append)'",
        "{owner:The list before .append} is None.",
        "append changes the list and returns None: write it alone, as in {owner:numbers}.append(...), without "
        "{owner:numbers} = before it.",
    ),
    (
        r"AttributeError: 'NoneType' object has no attribute '(?P<name>\w+)'",
        "{owner:The value before .{name}} is None: it was not set yet, or the function that should give it has no "
        "return.",
        "Look where it gets its value, and whether that line has run before this one.",
    ),
    (
        rf"AttributeError: '(?P<class>{_OF_RCLPY})' object has no attribute '(?P<name>publish|log|logger|info|print)'",
        *_OF_ANOTHER_TYPE,
    ),
    (
        r"AttributeError: '(?P<class>[A-Z]\w*)' object has no attribute 'publish'"
        r"(?:\. Did you mean: '(?P<kept>publisher(?:_\w*)?)')?",
        "A node cannot publish by itself: its publisher does.",
        "Keep what create_publisher returns in an attribute of the node, and call publish(...) of that, as in "
        "{owner:self}.{kept:publisher}.publish(...).",
    ),
    (
        r"AttributeError: '[A-Z]\w*' object has no attribute '(?P<name>log|logger|info|print)'",
        "A node has no {name}: its logger writes the log.",
        "Write {owner:self}.get_logger().info(...), with a string between the second parentheses.",
    ),
    (
        r"AttributeError: '[A-Z]\w*' object has no attribute '(?P<name>spin|spin_once|spin_until_future_complete)'",
        "A node has no {name}: it is a function of rclpy.",
        "Write rclpy before it, and give it the node first: rclpy.{name}({owner:your_node}, ...).",
    ),
    (
        r"AttributeError: 'ClientGoalHandle' object has no attribute 'result'",
        "{owner:This value} is the handle of the goal already, and no future.",
        "If you want the handle, leave .result() out. The result of the goal comes later: wait for the future of "
        "{owner:your_goal_handle}.get_result_async().",
    ),
    (
        r"AttributeError: '(?:function|method)' object has no attribute 'add_done_callback'",
        "{owner:What is waited for here} is a method that was not called, and not the future that it returns.",
        "Write parentheses after the method's name, in the line that sets {owner:it} or hands it over, as in "
        "cancel_goal_async() or get_result_async().",
    ),
    (
        r"AttributeError: '(?P<class>[A-Z]\w*)' object has no attribute 'add_done_callback'",
        "A future is needed here, and the value is of the type {class}.",
        "A future is what a call with _async at its end returns. A spin takes first the node, then the future: "
        "rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=5.0).",
    ),
    (
        r"AttributeError: '(?:float|int)' object has no attribute 'add_node'",
        "A spin takes an executor in this place, and a number of seconds only under its name.",
        "Write timeout_sec= before the number: rclpy.spin_until_future_complete(your_node, your_future, "
        "timeout_sec=5.0).",
    ),
    (
        r"AttributeError: '(?P<class>[A-Z]\w*)' object has no attribute '(?P<name>cancel_goal_async|get_result_async"
        r"|accepted|publish_feedback|is_cancel_requested|succeed|canceled|abort)'",
        "{owner:What is before .{name}} is of the type {class}; the handle of a goal has {name}.",
        "Write your goal handle before it. Where a node keeps the handle, name both: if its attribute is called "
        "goal_handle, write self.goal_handle.{name} in a method, or client.goal_handle.{name} where the node is "
        "called client.",
    ),
    (
        r"AttributeError: '(?P<class>int|float|str)' object has no attribute '(?P<name>sum|result|data|a|b|order"
        r"|status)'",
        "{owner:The value before .{name}} is of the type {class}: it is a single value already, and has no field "
        "{name}.",
        "If it is the value that you want, leave .{name} out. If not, look at the line that sets it.",
    ),
    (
        rf"^ +.*\bself\.(?:request|response|message|msg|future)\b.*{MARKS}"
        r"AttributeError: '(?P<class>[A-Z]\w*)' object has no attribute "
        r"'(?P<name>request|response|message|msg|future)'",
        "{class} has nothing called {name}.",
        "If {name} stands between the parentheses after def, ROS hands it to this method: leave out self. before it. "
        "If it is a value that the node is to keep, set self.{name} above this line.",
    ),
    (
        r"AttributeError: '[A-Z]\w*' object has no attribute '(?P<name>sleep|monotonic)'",
        "{name} is a function of the module time, and not of {owner:the node}.",
        "Write time.{name} in place of {owner:node}.{name}.",
    ),
    (
        # Each node has lists of these names; what is missing is the student's own.
        rf"^{_OWN}\. Did you mean: '(?:publishers|subscriptions|clients|services|timers|guards|waitables)'",
        "{class} has nothing called {name} so far.",
        "Set it in __init__, above the line that needs it, with self. before it: self.{name} = ..., which keeps what "
        "create_publisher, create_client or another create_... returns.",
    ),
    (
        rf"^{_OWN}\. Did you mean: '(?P<meant>\w+)'",
        "{class} has nothing called {name}, and has {meant}.",
        "If that is what you mean, write {meant}. If {name} is something else, write it in the class: a value as "
        "self.{name} = ... in __init__, a method as def {name}(self, ...).",
    ),
    (
        r"^ +.*\bspin\w*\((?P<what>\w+)[,)].*\n(?:.*\n)*AttributeError: '(?P<class>Client|ActionClient|Publisher"
        r"|Service|Timer|Future)' object has no attribute",
        "Only a node can be spun, and {what} is of the type {class} here.",
        "Give the spin your node: rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=5.0). A "
        "function that spins for you, such as wait_for of a lab, needs the node, too.",
    ),
    (
        r"AttributeError: 'ServerGoalHandle' object has no attribute 'order'",
        "The goal handle has the goal in its attribute request.",
        "Write {owner:your_goal_handle}.request.order.",
    ),
    (
        r"AttributeError: 'dict' object has no attribute '(?P<name>\w+)'",
        "{owner:The value before .{name}} is a dictionary, and what is in it is not read with a dot.",
        "Write the key in square brackets: {owner:names}[...], as in STATUS_NAMES[answer.status].",
    ),
    (
        rf"AttributeError: '(?P<class>list|dict|tuple|set|str|bytes|bool|int|float|{_OF_RCLPY})' object has no "
        r"attribute '(?P<name>\w+)'",
        *_OF_ANOTHER_TYPE,
    ),
    (
        r"AttributeError: '[A-Z]\w*' object has no attribute '(?P<name>(?:create|declare|get)_\w+)'",
        "A node has no method {name}.",
        "Compare the spelling: create_publisher, create_subscription, create_timer, create_service, create_client, "
        "get_logger. Actions have no such method: ActionServer(self, ...) and ActionClient(self, ...) make them.",
    ),
    (
        rf"^{_TYPE}",
        "{name} is a name of the program, and not of the node.",
        "Leave out the self. before it: write {name}.",
    ),
    (
        rf"^ +.*(?:create_\w+|ActionServer|ActionClient|\w*callback\w*)\(?.*self\..*{MARKS}{_OWN}",
        "{class} has no method {name} at this line.",
        "Write def {name} in the class, spelled the same and indented by four spaces, like def __init__: indented "
        "further, it is only a part of the method above. If {name} is a function outside of the class, leave out self.",
    ),
    (
        r"AttributeError: '[A-Z]\w*' object has no attribute '(?P<name>wait_for_(?:service|server)|call_async"
        r"|send_goal_async)'",
        "A node has no method {name}: its client has.",
        "Call it on what create_client(...) or ActionClient(...) gave you. Where a node keeps that in an attribute, "
        "name both: if the attribute is called actions, write {owner:client}.actions.{name}(...). If this line is in a "
        "function that is given a node and a client, compare their order where you call it.",
    ),
    (
        rf"^{_OWN}",
        "{class} has nothing called {name} so far.",
        "If it is a value, set it in __init__, above the line that needs it, with self. before it there, too: without "
        "self. it is forgotten at the end of the method. If it is a method, compare its name and its indentation. If "
        "it is a variable of this function, leave out what is before the dot. If it is a function outside of the "
        "class, call it by its name alone: {name}(...).",
    ),
    (
        rf"^ +.*\.result\.\w+.*{MARKS}AttributeError: '(?:function|method)' object has no attribute '(?P<name>\w+)'",
        "What is before .result is a future, and its result is a method, which was not called.",
        "Write parentheses: {owner:result}().{name}, once the future is done. If nothing has waited for it, wait "
        "first, with rclpy.spin_until_future_complete(your_node, your_future, timeout_sec=5.0) or a function that does "
        "it for you.",
    ),
    (
        r"AttributeError: '(?:builtin_function_or_method|function|method)' object has no attribute '(?P<name>\w+)'",
        "{owner:What is before .{name}} is a method without its parentheses, so it was not called.",
        "Write the parentheses after the method's name: {owner:self.get_logger}().{name}.",
    ),
    (
        r"AttributeError: type object 'GoalStatus' has no attribute 'STATUS_REJECTED'",
        "A goal that is rejected gets no status: there is no such constant.",
        "Ask its handle in place of the status: `if not goal_handle.accepted:`.",
    ),
    (
        r"^AttributeError: (?:type object '\w+' has no attribute ')?(?P<name>\w+)'?(?:\.|$)",
        "There is no constant or attribute {name} there.",
        "Compare the name with the lab's text, letter by letter: constants have capitals only, such as "
        "GoalResponse.ACCEPT.",
    ),
    (
        r"^AttributeError: property '(?P<name>\w+)' of '(?P<class>\w+)' object has no setter",
        "{name} of {class} can only be read.",
        "If {name} is to be a value of your own, give it another name.",
    ),
    (
        r"AttributeError: partially initialized module '(?P<name>[\w.]+)'",
        "A file of yours is called like the module {name}, and Python imports that instead.",
        "Give your file another name.",
    ),
    (
        r"AttributeError: module '(?P<module>[\w.]+)' has no attribute '(?P<name>\w+)'",
        "The module {module} has nothing called {name}.",
        "Compare the name with the lab's text, letter by letter.",
    ),
    (
        r"^(?:UnboundLocalError: )(?:cannot access local variable|local variable) '(?P<name>\w+)'",
        "Without self. before it, {name} is a variable of this method alone, and has no value yet.",
        "If it is a value of the node, write self.{name}, here and in all other lines that use it.",
    ),
    (
        rf"^ +.*\bcreate_\w+\(.*[ ,=(](?P<called>[A-Za-z_][\w.]*)\(.*\b(?:request|response|message|msg|goal_handle"
        rf"|future)\b.*\).*{MARKS}"
        r"NameError: name '(?P<name>request|response|message|msg|goal_handle|future)' is not defined",
        "Your code calls the method in this line, but only ROS can give it {name}, when it calls the method later.",
        "Write only {called}, without parentheses and arguments.",
    ),
    (
        rf"^ +.*\bself\.(?P<name>publish_feedback|is_cancel_requested|succeed|canceled|abort|request)\b.*{MARKS}"
        r"NameError: name 'self' is not defined",
        "{name} belongs to the handle of the goal, and a function has no self.",
        "Write your goal handle in place of self: if it is called goal_handle, goal_handle.{name}.",
    ),
    (
        r"^NameError: name '(?P<name>publish_feedback|is_cancel_requested|succeed|canceled|abort|accepted"
        r"|get_result_async|cancel_goal_async)' is not defined",
        "{name} belongs to the handle of the goal.",
        "Write your goal handle before it, with a dot: if it is called goal_handle, goal_handle.{name}.",
    ),
    (
        r"^NameError: name '(?P<name>spin|spin_once|spin_until_future_complete|create_node|try_shutdown)' is not "
        r"defined",
        "{name} is a function of the module rclpy.",
        "Write the module before it, with a dot: rclpy.{name}(...).",
    ),
    (
        r"^NameError: name '(?P<name>get_logger|get_clock|create_(?:publisher|subscription|timer|service|client))' "
        r"is not defined",
        "{name} is a method of the node.",
        "Write self. before it: self.{name}. In a function there is no self: write the name that the node has there, "
        "as in node.{name}.",
    ),
    (
        r"^NameError: name '(?P<name>sleep|monotonic)' is not defined",
        "{name} is a function of the module time.",
        "Write the module before it, with a dot: time.{name}(...).",
    ),
    (
        rf"\bself\.(?P<name>sleep|monotonic)\b.*{MARKS}NameError: name 'self' is not defined",
        "{name} is a function of the module time, and not of a node.",
        "Write time.{name} in place of self.{name}.",
    ),
    (
        r"^NameError: name 'self' is not defined",
        "Python knows self only inside a method whose first argument is self.",
        "In a method write self first between its parentheses, as in def say_hello(self), and indent its lines by "
        "eight spaces. In a function there is no self: write the name that the node has there, such as node or client.",
    ),
    (
        r"^NameError: name '(?P<name>ACCEPT|REJECT)' is not defined",
        "{name} is a constant of GoalResponse and of CancelResponse.",
        "Write GoalResponse.{name} where a goal is answered, and CancelResponse.{name} where a cancel request is.",
    ),
    (
        rf"^NameError: name '(?P<name>{_MODULES})' is not defined",
        "{name} is a module, and it is not imported.",
        "Write import {name} at the top of the program. In a notebook, write it in the cell with the imports, and run "
        "that cell. A type that has an import of its own is written alone: String in place of std_msgs.msg.String.",
    ),
    (
        r"^NameError: name '(?P<name>\w+)' is not defined\. Did you mean: '(?P<meant>self\.\w+)'",
        "Python does not know {name}; the node has it.",
        "To use it, write {meant}.",
    ),
    (
        r"^NameError: name '(?P<name>request|response|message|msg)' is not defined",
        "There is no {name} here: nothing above this line has set it.",
        "In a callback, ROS hands it over between the parentheses after def: use the name that is there. In a client, "
        "make the request yourself, request = AddTwoInts.Request(), and take the response from the future: "
        "future.result(). In an action the request is a part of the goal handle, as in goal_handle.request.",
    ),
    (
        rf"^ +class \w+\(node\).*{MARKS}NameError: name 'node' is not defined",
        "The class of rclpy is called Node, with a capital letter.",
        "Write Node between the parentheses.",
    ),
    (
        r"^NameError: name '(?P<name>node|client)' is not defined",
        "There is no {name} here.",
        "In a method, the node itself is called self: write self in place of {name}, or self.{name} if it is a value "
        "that the node keeps. In a function, make it above this line, or write it between the parentheses after def.",
    ),
    (
        r"^NameError: name 'goal_handle' is not defined",
        "There is no variable goal_handle here.",
        "If ROS hands it to this function, use the name that stands between the parentheses after def. Where a node "
        "keeps it, write the node before it: self.goal_handle in a method, or client.goal_handle where the node is "
        "called client.",
    ),
    (
        rf"^ +.*(?:\bcreate_(?:publisher|subscription|service|client)\([\w.]+, *|\bAction(?:Server|Client)\(self, *"
        rf"[\w.]+, *|\b__init__\()[a-z]\w*[,)].*{MARKS}NameError: name '(?P<name>[a-z]\w*)' is not defined",
        "Python does not know {name}.",
        "If {name} is the name of a node, a topic, a service or an action, put it in quotation marks. If it is a "
        "method of your class, write self.{name}.",
    ),
    (
        r"^NameError: name '(?P<name>a|b|c|order)' is not defined",
        "Python does not know {name}.",
        "If {name} is a field of the request or the goal, write what it belongs to before it, with a dot, as in "
        "request.{name}, or goal_handle.request.{name} in an action. Otherwise give {name} a value above that line.",
    ),
    (
        r"^NameError: name '(?P<name>status|sequence)' is not defined",
        "Python does not know {name}.",
        "If {name} is a part of what the server has sent, write what it belongs to before it, with a dot, as in "
        "answer.status or answer.result.sequence. Otherwise give {name} a value above that line.",
    ),
    (
        r"^NameError: name '(?P<name>\w+)' is not defined\. Did you mean: '(?P<meant>\w+)'",
        "Python does not know {name}, and knows {meant}.",
        "If that is what you mean, write {meant}. If {name} belongs to your node, write self.{name}. In a notebook, "
        "run the cell that defines it, if there is one. In a program, write or copy its definition into this file.",
    ),
    (
        r"^NameError: name '(?P<type>[A-Z]\w*)_(?P<part>Request|Response|Goal|Result|Feedback)' is not defined",
        "Messages name this type with an underscore, but in a program it is a part of {type}.",
        "Write it with a dot: {type}.{part}.",
    ),
    (
        r"^NameError: name '(?P<name>[A-Z]\w*)' is not defined",
        "Python does not know {name}: it was never imported or defined. In a notebook, the cell that does so may not "
        "have run.",
        "Compare the spelling. In a notebook, run the cells from the top. In a program, import it in this file.",
    ),
    (
        r"^NameError: name '(?P<name>\w+)' is not defined",
        "Python does not know {name}.",
        "If it belongs to your node, as a value or a method, write self.{name}, also in the line that sets it; in a "
        "function, which has no self, write the node's name in place of self. In a notebook, run the cell that defines "
        "it, if there is one. In a program, write or copy its definition into this file, above the line. If it is "
        "neither, compare the spelling.",
    ),
)
"""Python's words about names and attributes; the first row that fits wins."""
