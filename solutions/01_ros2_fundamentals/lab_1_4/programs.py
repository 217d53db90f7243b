"""Lab 1.4, the programs: an action server and its client that `ros2 run` starts from the student's package."""

from lab_1_4 import client, server

from autograder.kit import giving_up
from autograder.kit.recipes.programs import LabProgram, Programs

EXERCISE = Programs(
    "my_robot_pkg",
    LabProgram(
        "fibonacci_server",
        server.EXERCISE,
        "The server counts, and lets a goal be canceled",
        3,
        file="fibonacci_action_server",
    ),
    LabProgram(
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
        "`%%program` copies what you wrote in steps 2 to 4:": "fibonacci_server",
        "`%%program` copies what you wrote in steps 5 and 6:": "fibonacci_client",
        "A program gets its points only if its node passes everything that the check": (
            "fibonacci_server fibonacci_client"
        ),
        "The server has to end on <kbd>Ctrl</kbd>+<kbd>C</kbd>.": "ctrl_c",
        "two packages that `package.xml` has to name": "",
    },
    counts={
        "fibonacci_client": giving_up.COUNTS,
        "ctrl_c": "A client may spin on after its report.",
    },
)
