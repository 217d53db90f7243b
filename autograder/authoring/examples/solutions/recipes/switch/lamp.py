"""A switch: a publisher that a service std_srvs/srv/SetBool switches on and off."""

from autograder.kit.oracle.same_as_solution import SameAsSolution, To

EXERCISE = SameAsSolution(
    "switch.lamp",
    "A switch · The lamp",
    "Publish only while the service lamp has switched it on.",
    gives=lambda _: [To("/lamp", {"data": is_on}) for is_on in (True, False, True)],
    tells={"/lamp": "success", "/blink": "data?"},
    roles=("publisher", "service"),
).exercise(
    text={
        "while the service `lamp` has switched the lamp on": "blink",
        "Let `success` be": "lamp",
    }
)
