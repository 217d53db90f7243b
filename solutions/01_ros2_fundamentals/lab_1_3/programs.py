"""Lab 1.3, the programs: a server and a client that `ros2 run` starts from the student's package."""

from lab_1_3 import client, server

from autograder.kit.recipes.programs import Program, Programs

EXERCISE = Programs(
    "my_robot_pkg",
    Program(
        "add_server",
        server.EXERCISE,
        "The server answers each call with the sum",
        3,
        file="add_two_ints_server",
    ),
    Program(
        "add_client",
        client.EXERCISE,
        "The client reports what the server answers",
        3,
        file="add_two_ints_client",
        ends_by_itself=True,
    ),
).exercise(
    "lab_1_3.programs",
    "Lab 1.3 · The programs",
    "Two programs of your package, a server and a client, that ros2 run starts.",
)
