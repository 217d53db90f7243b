"""Lab 2.3, the same questions for a method that awaits the answers."""

from lab_2_3._questions import place, questions

from autograder.kit.oracle.same_as_solution import SameAsSolution, Serves

EXERCISE = SameAsSolution(
    "lab_2_3.awaits",
    "Lab 2.3 · The same, from top to bottom",
    "Ask, await the answer, and say it with the number of its question.",
    gives=lambda random: [*questions(random, 3), 2.1, *questions(random, 2), 1.6],
    tells={"/told": "data", "/beat": "data"},
    serves={"/where": Serves(place, late={1: 2.0, 4: 1.4})},
    every=("/told",),
    pause=0.5,
    roles=("publisher", "subscription", "client"),
).exercise(text={"Write `on_question` as three steps in one method: call, `await`, tell.": "told beat"})
