"""The summary: a node that drives a round, switches the lamp on, and walks towards the door until it cancels that."""

from __future__ import annotations

from autograder.kit import Mission, Moment, Pose, World
from autograder.kit.in_words import counted

AWAY = 3.14
"""The heading away from the door, so that a robot that drives straight ahead does not get there before its walk."""


def near(now: Moment) -> int:
    """Return how many feedback messages below one meter came before the first request to cancel."""
    feedback = now.before("cancel").part.of("feedback")
    return sum(event.data["fields"]["distance"] < 1.0 for event in feedback)


def cancels(now: Moment) -> int:
    """Return how often the subject asked to cancel its walk."""
    return len(now.part.of("cancel"))


def cancel(now: Moment) -> str:
    """Return in words when the subject asked to cancel its walk."""
    below = f"{counted(near(now), 'feedback message')} below 1 m"
    return f"{counted(cancels(now), 'request')}, after {below}" if cancels(now) else "no request"


EXERCISE = Mission(
    "summary.patrol",
    "A robot on patrol · The node",
    "Drive one round, switch the lamp on, then walk towards the door and cancel the walk in front of it.",
    roles=("publisher", "client", "action_client"),
    draws=lambda random: [World(start=Pose(random.uniform(0.8, 1.4), 2.0, AWAY))],
    late={"/lamp": lambda random: [random.choice((1.3, 1.5, 1.7))]},
    until=lambda now: bool(now.part.of("result")),
    within=60.0,
    drives=("Drives one round", "round", 2),
    rate=("Twice a second", "rate", 1),
    same=[
        ("Switches the lamp on after the round", lambda now: now.asked("/lamp"), "lamp", 2),
        ("Walks to the door when the lamp has answered", lambda now: now.sent("/walk_to"), "door", 2),
        ("Cancels once, in front of the door", cancel, "cancel", 3),
    ],
    knows=[
        (
            "cancel_repeated",
            lambda now: cancels(now) > 1 and cancels(now),
            "Your node asked {} times to cancel its walk: feedback goes on for a moment after the first request.",
            "Remember that you have asked: set the goal handle to None, and ask only if it is not None.",
            {"certain": True},
        ),
        (
            "cancel_too_early",
            lambda now: cancels(now) and not near(now),
            "Your node asked to cancel its walk when one meter or more was left.",
            "Compare the distance that the feedback brings, and do not count messages: if distance < 1.0.",
        ),
        (
            "cancel_too_late",
            lambda now: cancels(now) and near(now) > 1,
            "Your node let a feedback message below one meter pass before it asked to cancel its walk.",
            "Ask at the first such message: if distance < 1.0.",
        ),
        (
            "cancel_missing",
            lambda now: bool(now.part.of("result")) and not cancels(now),
            "Your node never asked to cancel its walk, although less than one meter was left.",
            "Keep the goal handle, which is the answer to the goal, and call its cancel_goal_async(), with "
            "parentheses, if distance < 1.0. If no feedback arrives, pass feedback_callback=... to send_goal_async.",
            {"late": True},
        ),
    ],
).exercise(
    text={
        "Publish a `Twist` with `linear.x = 0.4` and `angular.z = 1.0`": "round rate",
        "Twelve commands make one round.": "round",
        "At the twelfth, cancel `self.timer`, and call the service `lamp`, once, to switch the lamp on.": "round lamp",
        "Let the future call `self.on_lamp`.": "",
        "When the lamp has answered, send the goal x = 4.0, y = 2.0, the door, to the action `walk_to`, once.": "door",
        "Pass `self.on_feedback` for the feedback": "cancel",
        "Keep the goal handle, the result of the future `sent`, in `self.goal_handle`.": "",
        "At the first feedback that says that less than 1 meter is left, ask once to cancel the goal.": "cancel",
    },
    counts={
        "lamp": "A round that is not twelve commands costs this, too.",
        "cancel": "How the walk ends is not graded.",
        "": "Only what your node sends is judged. A step that is not written also costs those that it would start.",
    },
)
