"""A switch: a publisher that a service std_srvs/srv/SetBool switches on and off."""

from autograder.kit import SameAsSolution, To

EXERCISE = SameAsSolution(
    "switch.lamp",
    "A switch · The lamp",
    "Publish only while the service lamp has switched it on.",
    gives=lambda _: [To("/lamp", {"data": is_on}) for is_on in (True, False, True)],
    tells={"/lamp": "success", "/blink": "data?"},
    rates={"/blink": 0.2},
    roles=("publisher", "service"),
).exercise(
    text={
        "Publish 1, 2, 3, … on `blink`, every 0.2 s": "blink blink_rate",
        "while the service `lamp` has switched the lamp on": "blink",
        "Let `success` be": "lamp",
    }
)
