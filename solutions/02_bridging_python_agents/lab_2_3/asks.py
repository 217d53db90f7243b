"""Lab 2.3, questions that are open at once, with answers in another order, while the heart goes on beating."""

from lab_2_3._questions import PAUSE, place, questions

from autograder.kit import SameAsSolution

EXERCISE = SameAsSolution(
    "lab_2_3.asks",
    "Lab 2.3 · Call me when you know",
    "Ask without waiting, and say each answer with the number of its question.",
    gives=questions,
    tells={"/told": "data", "/beat": "data"},
    serves={"/where": place},
    every=("/told",),
    pause=PAUSE,
    roles=("publisher", "subscription", "client"),
).exercise(
    text={
        "For each question call `where`, and say the answer": "told",
        "each answer has to know its number": "told",
        "So no callback waits.": "beat",
    }
)
