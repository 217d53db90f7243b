"""Lab 2.3, a question that is never answered is given up, and a late answer is not said."""

from lab_2_3._questions import place, questions

from autograder.kit.oracle.same_as_solution import SameAsSolution, Serves

EXERCISE = SameAsSolution(
    "lab_2_3.patience",
    "Lab 2.3 · What never comes",
    "Give a question up after two seconds, and say so.",
    gives=lambda random: [*questions(random, 2, stands=2.2), 1.0, *questions(random, 2), 3.2],
    tells={"/told": "data", "/beat": "data"},
    serves={"/where": Serves(place, late={2: 2.7}, never={1, 4})},
    every=("/told",),
    pause=0.7,
    roles=("publisher", "subscription", "client"),
).exercise(
    text={
        "open for more than 2 seconds of the robot's time, and says `no answer`": "told",
        "An answer that comes later than that is not said any more.": "told",
        "So the heart looks after the questions: at each beat": "beat",
    }
)
