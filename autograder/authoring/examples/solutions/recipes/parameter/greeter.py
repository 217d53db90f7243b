"""A parameter: a talker's text, which the judge changes while the talker runs."""

from autograder.kit import SameAsSolution, Sets

EXERCISE = SameAsSolution(
    "parameter.greeter",
    "A parameter · The greeter",
    "Publish the text of a parameter, which may change at any time.",
    gives=lambda random: [*(Sets("text", f"Ahoy {random.randint(1000, 9999)}") for _ in range(2)), 2.0],
    tells={"/greeting": "data"},
    rates={"/greeting": 0.5},
    parameters=("text",),
    roles=("publisher",),
).exercise(
    text={
        "Publish a greeting on `greeting` every 0.5 s.": "greeting greeting_rate",
        "Its text is the parameter `text`": "greeting text",
    }
)
