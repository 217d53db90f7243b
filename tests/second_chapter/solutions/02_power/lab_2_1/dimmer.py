"""The dimmer: a service of the chapter's own type sets what a publisher says, as far as it is possible."""

from autograder.kit.oracle.same_as_solution import SameAsSolution, To

EXERCISE = SameAsSolution(
    "lab_2_1.dimmer",
    "Lab 2.1 · The dimmer",
    "Publish the level that the service set_level has set.",
    gives=lambda _: [To("/set_level", {"percent": percent}) for percent in (40, 140, 100, 101, 60, 1, -1, 0)],
    tells={"/level": "data", "/set_level": "accepted"},
    rates={"/level": 0.2},
    roles=("publisher", "service"),
).exercise()
