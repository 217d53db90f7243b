"""A mode: a service answers by the state that it keeps, and each change is told once, also to a late listener."""

from autograder.kit import SameAsSolution, To

ON_AND_OFF = (False, True, True, False, False, True, True, False, False, True, False)
"""What is asked for. Half of it is so already."""

EXERCISE = SameAsSolution(
    "machine.mode",
    "A mode · The service",
    "Set a mode by a service, and tell of each change.",
    gives=lambda _: [To("/set_mode", {"data": is_on}) for is_on in ON_AND_OFF],
    tells={"/set_mode": ("success", "message?"), "/mode": "data"},
    every=True,
    qos=("/mode",),
    roles=("service", "publisher"),
).exercise(
    text={
        "`success` is true if the mode changes": "set_mode",
        "`message` says why": "set_mode",
        "once at each change": "mode",
        "a node that subscribes later hears the last one": "mode",
    }
)
