"""The summary: a node that drives a round, switches the lamp on, and walks towards the door until it cancels that."""

from __future__ import annotations

from typing import TYPE_CHECKING

from summary._night import (
    before_the_lamp,
    commands,
    goals,
    in_words,
    lamps,
    near_messages,
    night,
    published,
    too_soon,
)
from summary._night_mistakes import MISTAKES

from autograder.kit.draft import Draft
from autograder.kit.in_words import counted
from autograder.kit.model import Finding
from autograder.kit.recipes.own_scenario import OwnScenario
from autograder.kit.rules import keeps_rate

if TYPE_CHECKING:
    from autograder.kit.evidence import Part

patrol = Draft(
    "summary.patrol",
    "The chapter in short · The patrol",
    "Drive one round, switch the lamp on, then walk towards the door and cancel the walk in front of it.",
    OwnScenario(night, "publisher", "client", "action_client"),
)


@patrol.criterion("round", 2, "Drives one round")
def drives_a_round(seen: Part, expected: Part) -> Finding:
    """As many commands as the reference's, each with its movement."""
    same = set(commands(seen)) == set(commands(expected))
    enough = published(seen.of("message")) == published(expected.of("message"))
    return Finding(same and enough, in_words(expected), in_words(seen))


patrol.criterion("rate", 1, "Twice a second")(keeps_rate)


@patrol.criterion("lamp", 2, "Switches the lamp on after the round")
def switches_the_lamp(seen: Part, expected: Part) -> Finding:
    """One call of the service with the reference's request, after the last command."""
    wanted, asked, driven = lamps(expected), lamps(seen), before_the_lamp(seen)
    a_round = before_the_lamp(expected)
    which = ", ".join(dict.fromkeys(map(str, asked)))
    told = f"{counted(len(asked), 'call')} ({which}) after {counted(driven, 'command')}"
    expects = f"1 call (True) after {counted(a_round, 'command')}"
    return Finding(asked == wanted and driven == a_round, expects, told if asked else "no call")


@patrol.criterion("door", 2, "Walks to the door when the lamp has answered")
def walks_to_the_door(seen: Part, expected: Part) -> Finding:
    """One goal, the reference's, and not before the lamp's answer."""
    sent = [f"x = {goal['x']:.6g}, y = {goal['y']:.6g}" for goal in goals(seen)]
    count = f"{counted(len(sent), 'goal')}: " if len(sent) > 1 else ""
    told = count + (" / ".join(dict.fromkeys(sent)) or "no goal")
    early = ", before the lamp's answer" if too_soon(seen, expected) else ""
    wanted = goals(expected)
    return Finding(
        goals(seen) == wanted and not early, "x = {x:.6g}, y = {y:.6g}".format(**wanted[0]), told + early
    )


@patrol.criterion("cancel", 3, "Cancels once, in front of the door")
def cancels(seen: Part, _: Part) -> Finding:
    """One request to cancel, between the first feedback below the limit and the next."""
    asked, near = len(seen.of("cancel")), near_messages(seen)
    told = (
        f"{counted(asked, 'request')}, after {counted(near, 'feedback message')} below 1 m"
        if asked
        else "no request"
    )
    return Finding(asked == 1 and near == 1, "1 request, after 1 feedback message below 1 m", told)


for key, recognize, says, next_step, how in MISTAKES:
    patrol.knows(key, recognize, says, next_step, **how)


EXERCISE = patrol.exercise(
    text={
        "Publish a `Twist` with `linear.x = 0.4` and `angular.z = 1.0`": "round rate",
        "Twelve commands make one round.": "round",
        "At the twelfth, cancel `self.timer`, and call the function `switch_lamp` of step 2": "round lamp",
        "`switch_lamp` calls the service `lamp`, once, to switch the lamp on.": "lamp",
        "When the lamp has answered, send the goal x = 4.0, y = 2.0, the door, to the action `walk_to`, once.": "door",
        "Pass `patrol.on_feedback` for the feedback": "cancel",
        "At the first feedback that says that less than 1 metre is left, ask once to cancel the goal.": "cancel",
    },
)
