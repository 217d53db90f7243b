"""A latched topic: late subscribers receive a message that was published before they came."""

from autograder.kit import SameAsSolution

EXERCISE = SameAsSolution(
    "latched.map_server",
    "A latched topic · The map server",
    "Publish the name of the map once, for late listeners too.",
    gives=lambda _: [],
    tells={"/map_name": "data"},
    late_after=1.0,
    every=True,
    roles=("publisher",),
).exercise(
    text={
        "Publish the text `kitchen` once on `map_name`": "map_name",
        "a node that subscribes later hears it too": "map_name",
    }
)
