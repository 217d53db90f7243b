"""Lab 1.3, the programs: a server and a client that `ros2 run` starts from the student's package."""

from lab_1_3 import client, server

from autograder.kit import giving_up
from autograder.kit.recipes.programs import LabProgram, Programs

SUM, REPORT = "The server answers each call with the sum", "The client reports what the server answers"
EXERCISE = Programs(
    "my_robot_pkg",
    LabProgram("add_server", server.EXERCISE, SUM, 3, file="add_two_ints_server"),
    LabProgram("add_client", client.EXERCISE, REPORT, 3, file="add_two_ints_client", ends_by_itself=True),
).exercise(
    "lab_1_3.programs",
    "Lab 1.3 · The programs",
    "Two programs of your package, a server and a client, that ros2 run starts.",
    text={
        "The executables have shorter names than the files: `add_server` and `add_client`.": "entry_points",
        "`%%program` copies your class from step 2 into the first file:": "add_server",
        "`%%program` copies your function from step 3:": "add_client",
        "and presses <kbd>Ctrl</kbd>+<kbd>C</kbd>: the server has to end then.": "ctrl_c",
        "then the client has to do what *Step 3: The client* says: it gives up in time.": "add_client ctrl_c",
        "A program gets its points only if its node passes everything": "add_server add_client",
        "`package.xml` of `my_robot_pkg` has to name it": "",
    },
    counts={
        "add_client": giving_up.COUNTS,
        "ctrl_c": "A client may spin on after its report.",
    },
)
