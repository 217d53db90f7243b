"""Lab 2.3, questions that are open at once, with answers in another order, while the heart goes on beating."""

from lab_2_3._questions import place, questions

from autograder.kit.oracle.same_as_solution import SameAsSolution, Serves

EXERCISE = SameAsSolution(
    "lab_2_3.asks",
    "Lab 2.3 · Call me when you know",
    "Ask without waiting, and say each answer with the number of its question.",
    gives=lambda random: [*questions(random, 3), 2.1, *questions(random, 2), 1.6],
    tells={"/told": "data", "/beat": "data"},
    serves={"/where": Serves(place, late={1: 2.0, 4: 1.4})},
    every=("/told",),
    pause=0.5,
    roles=("publisher", "subscription", "client"),
).exercise(
    text={
        "For each question call `where`, and say the answer": "told",
        "each answer has to know its number": "told",
        "So no callback waits.": "beat",
    }
)
