"""The first notebook: a command that drives the robot straight ahead, again and again."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.model import Advice, Finding
from autograder.kit.recipes.publisher import Hears

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence
    from autograder.kit.published_texts import Publisher

heard = Hears(messages=8, long_run=20)
first_move = Draft(
    "00_nervous_system.first_move",
    "The robotic nervous system · The first move",
    "Tell the robot every half second to drive straight ahead at 0.5 metres per second.",
    heard,
)

AXES = tuple((part, axis) for part in ("linear", "angular") for axis in ("x", "y", "z"))
"""The six numbers of a Twist."""


def numbers(message: Event) -> dict[str, float]:
    """The six numbers of a command, such as ``{"linear.x": 0.5, …}``; those that are missing count as 0."""
    fields = message.data["fields"]
    return {f"{part}.{axis}": float(fields.get(part, {}).get(axis, 0.0)) for part, axis in AXES}


def commands(publisher: Publisher) -> list[dict[str, float]]:
    """All commands, in order."""
    return [numbers(message) for message in publisher.messages]


def words(command: dict[str, float]) -> str:
    """A command in words: the numbers in it that are not 0."""
    return ", ".join(f"{name} = {value:g}" for name, value in command.items() if value) or "all numbers 0"


def same(command: dict[str, float], wanted: dict[str, float]) -> bool:
    """True if two commands mean one movement."""
    return all(abs(command[name] - value) < 1e-3 for name, value in wanted.items())


@heard.each_text
@first_move.criterion("velocity", 6, "Drives straight ahead")
def velocity(seen: Publisher, expected: Publisher) -> Finding:
    """Every command is the reference's."""
    wanted = commands(expected)[0]
    told = commands(seen)
    odd = [command for command in told if not same(command, wanted)]
    found = words((odd or told)[0]) if told else "no command arrived"
    if told and not odd and not seen.went_on:
        found += ", and no more"
    return Finding(seen.went_on and not odd, words(wanted), found)


@heard.whole_course
def goes_on(seen: Publisher, _: Publisher) -> Finding:
    """The commands do not stop: without one the robot stands still after a second."""
    came = len(seen.messages)
    return Finding(came >= seen.enough, "commands that go on", f"{came} commands, and no more")


def keeps_telling(evidence: Evidence) -> Finding:
    """The commands come at the reference's rate, and go on."""
    rate = heard.keeps_rate(evidence)
    on_and_on = goes_on(heard.seen(evidence), heard.expected(evidence))
    return rate if on_and_on.passed or not rate.passed else replace(on_and_on, expected=rate.expected)


first_move.asks("rate", 4, "Keeps telling it", keeps_telling)


@first_move.mistake("wrong_movement", certain=True)
def wrong_movement(seen: Publisher, expected: Publisher) -> Advice | None:
    """Commands arrive that mean another movement."""
    wanted = commands(expected)[0]
    odd = next((command for command in commands(seen) if not same(command, wanted)), None)
    if odd is None:
        return None
    return Advice(
        f"Your command says {words(odd)}; the task asks for {words(wanted)}.",
        "linear.x points ahead, in metres per second, and angular turns the robot: set linear.x in every command, and "
        "leave the other five numbers alone.",
    )


EXERCISE = first_move.exercise(
    text={
        "Twice a second this driver makes a command": "rate",
        "set the speed straight ahead to `0.5`, and publish the command": "velocity",
    },
)
