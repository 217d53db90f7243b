"""Lab 2.3, the same questions for a method that awaits the answers."""

from lab_2_3._questions import PAUSE, place, questions

from autograder.kit import SameAsSolution

EXERCISE = SameAsSolution(
    "lab_2_3.awaits",
    "Lab 2.3 · The same, from top to bottom",
    "Ask, await the answer, and say it with the number of its question.",
    gives=questions,
    tells={"/told": "data", "/beat": "data"},
    serves={"/where": place},
    every=("/told",),
    pause=PAUSE,
    roles=("publisher", "subscription", "client"),
).exercise(text={"Write `on_question` as three steps in one method: call, `await`, tell.": "told beat"})
