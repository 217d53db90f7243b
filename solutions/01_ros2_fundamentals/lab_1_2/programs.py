"""Lab 1.2, the programs: a talker and a listener that `ros2 run` starts from the student's package."""

from lab_1_2 import listener, talker

from autograder.kit.recipes.programs import LabProgram, Programs

EXERCISE = Programs(
    "my_robot_pkg",
    LabProgram("talker", talker.EXERCISE, "The talker publishes its strings at the right rate", 3),
    LabProgram("listener", listener.EXERCISE, "The listener says every string it hears", 3),
    keeps=("simple_node",),
).exercise(
    "lab_1_2.programs",
    "Lab 1.2 · The programs",
    "Two programs of your package, a talker and a listener, that ros2 run starts and Ctrl-C ends.",
    text={
        "Each program needs an entry point in `setup.py`. The executables are `talker` and `listener`.": "entry_points",
        "The entry point of Lab 1.1 stays in the list.": "entry_points",
        "Copy your class from step 1 to the place of the `TODO`": "talker",
        "puts your newest `ListenerNode` in the place of the comment.": "listener",
        "To stop a program, press <kbd>Ctrl</kbd>+<kbd>C</kbd> in its terminal.": "ctrl_c",
        "A program gets its points only if its node passes everything that the check": "talker listener",
    },
)
