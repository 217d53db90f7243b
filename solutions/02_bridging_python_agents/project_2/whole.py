"""The project of chapter 2, as a whole: a launched package drives to the lamp that is on, and comes back."""

from math import inf, pi
from random import Random

from autograder.kit import Mission, Moment, Pose, To, World
from autograder.kit.runners import LaunchesFromPackage

WAITS, OUT = "Sends commands while it waits for the answer", "Sets out when the answer is there"
OLD, LAMP = "Stands while its position is old", "Comes to the lamp"
BUTTON, BACK = "Stands while the red button is pressed", "Comes back, and stands"
SILENT, PRESSED, GIVEN_UP = 3.0, 2.0, 8.0
"""Seconds for which the robot does not tell its position after it has set out, for which the red button is pressed, and
for which a robot stands that does nothing more."""
NEAR, LIMITS = 0.45, (0.405, 0.805)
"""The distance in meters from the lamp and from home that is near enough; and the limits, with some tolerance."""


def world(random: Random) -> World:
    """Draw a start on the left of the left room, and a lamp on the right of it."""
    start = Pose(random.uniform(0.8, 1.4), random.uniform(1.2, 2.8), random.uniform(-pi, pi))
    return World(start=start, places={"lamp": (random.uniform(2.7, 3.2), random.uniform(1.2, 2.8))})


def where(now: Moment) -> dict[str, object]:
    """Answer where a lamp is on."""
    return {"success": True, "message": "{:.2f} {:.2f}".format(*now.world.places["lamp"])}


def home(now: Moment) -> float:
    """Return the distance in meters to the start."""
    return now.to(now.world.start.point)


def on_the_way_back(now: Moment) -> bool:
    """Return True between the lamp and the start, and for a robot that has given up."""
    between = LAMP in now.reached and now.to("lamp") > 0.6
    return between or now.stood > GIVEN_UP


def obeys_the_button(now: Moment) -> bool:
    """Return True if the robot has stopped on its way back since the red button was pressed."""
    pressed = len(now.part.of("answered", "/stop")) == 1
    return pressed and LAMP in now.reached and home(now) > NEAR and 1.0 < now.stood < PRESSED + 0.5


def goes_on(now: Moment) -> bool:
    """Return True if commands came between the question and its answer."""
    asked, answer = now.part.first("request"), now.part.first("response")
    if asked is None:
        return False
    # By the moments, not by when this is looked at: on a busy machine, all of it may come between two looks.
    answered = answer.moment if answer else inf
    return sum(asked.moment < event.moment < answered for event in now.part.of("message")) >= 3


def fastest(now: Moment) -> float:
    """Return the fastest command, in meters per second."""
    commands = now.part.of("message")
    return max((abs(event.data["fields"]["linear"]["x"]) for event in commands), default=0.0)


def too_fast(now: Moment) -> bool:
    """Return True if the robot is faster than the launch file allows."""
    return abs(now.velocity.forward) > LIMITS[0] or abs(now.velocity.turn) > LIMITS[1]


EXERCISE = Mission(
    "project_2.whole",
    "Project 2 · There and back",
    "Go where the lamp is on, and come back.",
    roles=("publisher", "subscription", "client", "service"),
    draws=lambda random: [
        *(world(random), on_the_way_back, To("/stop", True), PRESSED, To("/stop", False)),
    ],
    serves={"/where": where},
    late={"/where": lambda random: [random.choice((1.2, 1.5, 1.7))]},
    senses={"/odom": lambda now: {} if now.since(OUT) < SILENT else None},
    reaches=[
        (WAITS, goes_on, "waits"),
        (OUT, lambda now: now.part.of("response") and home(now) > 0.4, "out"),
        (OLD, lambda now: 2.0 < now.since(OUT) < SILENT and now.stood > 0.5, "old"),
        (LAMP, lambda now: now.to("lamp") < NEAR, "lamp"),
        (BUTTON, obeys_the_button, "button"),
        (BACK, lambda now: LAMP in now.reached and home(now) < NEAR and now.stood > 1, "back"),
    ],
    never=[
        ("Keeps the limits of the launch file", too_fast, "limits"),
        ("Touches no wall", lambda now: now.bumped, "walls"),
    ],
    knows=[
        (
            "silent_while_it_waits",
            lambda now: now.part.of("response") and WAITS not in now.reached,
            "Your robot sends no commands while it waits for the answer.",
            "Call the service with call_async, and let act publish in any case: zeros if it knows too little.",
        ),
        (
            "too_fast",
            lambda now: fastest(now) > LIMITS[0] and f"{fastest(now):g}",
            "Your robot is told to drive at {} meters per second; the limit of this mission is 0.4.",
            "Give safe_hands its parameters in the launch file, and let no other node publish on cmd_vel.",
        ),
        (
            "drives_blind",
            lambda now: SILENT < now.since(OUT) < inf and OLD not in now.reached,
            "Your robot goes on while its position is old.",
            "In act, let the agent decide only if the newest position came less than 1 second ago.",
        ),
        (
            "not_back",
            lambda now: LAMP in now.reached and home(now) > NEAR and f"{home(now):.1f}",
            "Your robot comes to the lamp, and ends {} meters from its start.",
            "Near the lamp, go becomes back, and then the command leads to self.home, the first place that was seen.",
        ),
        (
            "ignores_the_button",
            lambda now: BACK in now.reached and BUTTON not in now.reached,
            "Your robot drives on while its red button is pressed.",
            "Only safe_hands may publish on cmd_vel: the bridge publishes on agent_vel, in the launch file, too.",
        ),
    ],
    within=100.0,
    quiet=GIVEN_UP,
    until=lambda now: now.stood > (1.0 if LAMP in now.reached and home(now) < NEAR else GIVEN_UP),
).exercise(
    limit=400.0,
    runner=LaunchesFromPackage("lamp_robot", "lamp.launch"),
    unasked=("/agent_vel",),
    text={
        "while `self.lamp` is `None`, call the service": "waits out",
        "Otherwise the robot knows too little: both numbers are 0.": "old",
        "It starts both programs, and gives `safe_hands` the limits of this mission": "out limits",
        "has to send commands while it waits for the answer": "waits out",
        "has to stand while its position is old": "old",
        "come to the lamp": "lamp",
        "back to its start": "back",
        "has to stand until the button is released": "button",
        "It never touches a wall": "walls",
        "never faster than 0.4 meters and 0.8 radians per second": "limits",
    },
)
