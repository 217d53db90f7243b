"""Lab 1.1, the first node: a package that builds, and a program of it that says hello."""

from __future__ import annotations

from autograder.kit import Draft, Program

recipe = Program("my_robot_pkg", "simple_node", "saying hello")
hello = Draft(
    "lab_1_1.hello",
    "Lab 1.1 · The first node",
    "A package that builds, and a node in it that says hello.",
    recipe,
)
hello.asks("starts", "Builds, and ros2 run starts it", recipe.starts, points=3)
hello.asks("node", "Is a node on the graph", recipe.is_a_node, points=3)
hello.asks("line", "Says the line", recipe.says_the_line, points=4)


hello.knows(
    "wrong_text",
    lambda seen, _: seen.has_node and bool(seen.words) and not seen.says_it,
    "Your node says “{seen.nearest}”; the task asks for “{seen.line}”.",
    "{seen.first_difference} Every letter counts.",
    late=True,
)
hello.knows(
    "not_logged",
    lambda seen, _: seen.has_node and not seen.words and not seen.says_it,
    "Your node is on the graph, but it says nothing.",
    "Log the line in __init__, after super().__init__: self.get_logger().info('...').",
    late=True,
)
hello.knows(
    "nothing_on_the_graph",
    lambda seen, _: seen.says_it and not seen.has_node,
    "The line is there, but no node says it: your program never appeared on the graph.",
    "Make a class derived from Node, call super().__init__('simple_node') in it, and log with "
    "self.get_logger().info(...).",
    late=True,
)


EXERCISE = hello.exercise(
    limit=400.0,
    runner=recipe.runner,
    text={
        "Write the method `__init__` of the class.": "node",
        "call `__init__` of the class `Node` with the name of the node": "node",
        "**log** `Hello, ROS 2! From SimpleNode.`": "line",
        "Write the entry point of the executable `simple_node`, which calls `main` of your module.": "starts",
    },
    counts={
        "node": "Its name is not graded.",
        "line": "Or `print` it.",
    },
)
