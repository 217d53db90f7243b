"""Lab 1.3, a robot that follows or stays: a service decides what each scan is answered with."""

from random import Random

from autograder.kit import SameAsSolution, To, dealt, levels, mixed, scans, shuffled

NEAR = 0.8
"""The distance in meters up to which a robot that follows stands still."""


def steps(random: Random) -> list[To]:
    """Return scans and requests. A robot that follows meets all levels; a new one, and one that stays, meet a few."""
    walls = levels(NEAR)
    far, near = [wall for wall in walls if wall > NEAR], [wall for wall in walls if wall < NEAR]
    asked = mixed(random, [True, True, True, False, False, False], bool)
    hands = asked.count(True)
    # After each request there is a wall at which it shows whether the robot follows.
    each_hand = zip(dealt(random, far, hands), dealt(random, near, hands), strict=True)
    follows = [shuffled(random, a + b) for a, b in each_hand]
    stays = dealt(random, far, asked.count(False))
    aheads = [[random.choice(far), random.choice(near)]]
    aheads += [(follows if data else stays).pop() for data in asked]
    told = iter(scans(random, NEAR, [ahead for each in aheads for ahead in each]))
    answered = [[next(told) for _ in each] for each in aheads]
    requests = [[], *([To("/follow", {"data": data})] for data in asked)]
    return [step for pair in zip(requests, answered, strict=True) for steps in pair for step in steps]


EXERCISE = SameAsSolution(
    "lab_1_3.follow",
    "Lab 1.3 · Follow or stay",
    "Serve follow, and answer each scan with a command: drive only while the robot follows and the wall is far.",
    gives=steps,
    tells={"/cmd_vel": ("linear.x", "angular.z"), "/follow": ("success", "message")},
    every=True,
    roles=("service", "publisher", "subscription"),
).exercise(
    text={
        "Let the node offer the service `follow`.": "follow",
        "Each answer has `success` true and the `message` `following` or `staying`.": "follow",
        "A request with `data` true lets it follow, and one with `data` false lets it stay.": "cmd_vel",
        "At the beginning it stays": "cmd_vel",
    }
)
