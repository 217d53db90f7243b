"""Lab 1.4, the programs: an action server and its client that `ros2 run` starts from the student's package."""

from lab_1_4 import client, server

from autograder.kit.recipes.programs import Program, Programs

EXERCISE = Programs(
    "my_robot_pkg",
    Program(
        "fibonacci_server",
        server.EXERCISE,
        "The server counts, and lets a goal be canceled",
        3,
        file="fibonacci_action_server",
    ),
    Program(
        "fibonacci_client",
        client.EXERCISE,
        "The client says how its goal ends",
        3,
        file="fibonacci_action_client",
        ends_by_itself=True,
    ),
).exercise(
    "lab_1_4.programs",
    "Lab 1.4 · The programs",
    "Two programs of your package, an action server and its client, that ros2 run starts.",
    text={
        "The executables are `fibonacci_server` and `fibonacci_client`.": "entry_points",
        "Copy what you wrote in steps 2 to 4:": "fibonacci_server",
        "Copy what you wrote in steps 5 and 6:": "fibonacci_client",
        "The client has to end by itself, and the server on <kbd>Ctrl</kbd>+<kbd>C</kbd>.": "ctrl_c",
    },
)
