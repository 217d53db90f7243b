"""A parameter: a talker's text, which the judge changes while the talker runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.recipes.own_scenario import Met, OwnScenario, once_met
from autograder.kit.rules import Given, StateRule, values

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.model import Bench

PATIENCE = 4.0
"""Seconds of the subject's time within which greetings must have come: eight times their period."""


def greeting(met: Met) -> bool:
    """Listen, set the parameter, and listen again."""
    met.bench.run_time(PATIENCE, until=lambda: met.heard >= 2)
    set_text(met.bench, f"Ahoy {met.bench.random.randint(1000, 9999)}")
    enough = met.heard + 3
    met.bench.run_time(PATIENCE, until=lambda: met.heard >= enough)
    return met.heard >= enough


def set_text(bench: Bench, text: str) -> None:
    """Set the parameter as ``ros2 param set`` does."""
    # 4 is PARAMETER_STRING of rcl_interfaces/msg/ParameterType.
    bench.await_node()
    nodes = [node for survey in bench.seen().of("interface") for node in survey.data["nodes"]]
    caller = bench.call(f"{nodes[0]}/set_parameters", "rcl_interfaces/srv/SetParameters") if nodes else None
    if caller and caller.await_server(PATIENCE):
        caller.ask({"parameters": [{"name": "text", "value": {"type": 4, "string_value": text}}]})
        caller.await_answers(PATIENCE)


greeter = Draft(
    "parameter.greeter",
    "A parameter · The greeter",
    "Publish the text of a parameter, which may change at any time.",
    OwnScenario(once_met(greeting), "publisher"),
)


def text_set(asked: Sequence[Given]) -> str:
    """Return the text that the parameter was last set to; its default if it was never set."""
    return str(asked[-1].value["parameters"][0]["value"]["string_value"]) if asked else "Hello"


text = StateRule(text_set, slack=1.0, given="asked")
greeter.criterion("default", 3, "Says Hello until somebody sets the parameter")(
    text.when(lambda asked: not asked)
)
greeter.criterion("follows", 7, "Says the parameter's text once it was set")(text.when(bool))


greeter.knows(
    "parameter_not_declared",
    lambda seen, _: any(not answer["results"][0]["successful"] for answer in values("answered")(seen)),
    "Your node refused the parameter text: it has no such parameter.",
    'Declare it in __init__, with its default: self.declare_parameter("text", "Hello").',
    certain=True,
)
greeter.knows(
    "parameter_read_once",
    lambda seen, expected: bool(seen.of("answered")) and text.taken_for(lambda _: "Hello")(seen, expected),
    "Your node took the new value of the parameter, and goes on saying the old one: it was read only once.",
    'Ask for it each time, in the method that the timer calls: self.get_parameter("text").value.',
    certain=True,
)
EXERCISE = greeter.exercise()
