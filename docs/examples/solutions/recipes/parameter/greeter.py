"""A parameter: a talker's text, which the judge changes while the talker runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.model import Bench, Finding
from autograder.kit.recipes.own_scenario import OwnScenario

if TYPE_CHECKING:
    from autograder.kit.evidence import Part

PATIENCE = 4.0
"""Seconds of the subject's time in which greetings must have come: eight times their period."""


def scenario(bench: Bench) -> None:
    """Listen, set the parameter, and listen again."""
    topic, type_name = bench.reference.only("publisher")
    bench.part("greeting", text=f"Ahoy {bench.random.randint(1000, 9999)}")
    bench.listen(topic, type_name)
    bench.start()
    if bench.await_endpoint("publisher", topic) and bench.await_node():
        bench.release()
        bench.run_time(PATIENCE, until=lambda: bench.heard(topic) >= 2)
        set_text(bench, bench.seen().inputs["text"])
        enough = bench.heard(topic) + 3
        bench.run_time(PATIENCE, until=lambda: bench.heard(topic) >= enough)
        if bench.heard(topic) < enough:
            bench.note_whether_it_spins()
    bench.stop()


def set_text(bench: Bench, text: str) -> None:
    """Set the parameter as ``ros2 param set`` does."""
    # 4 is PARAMETER_STRING of rcl_interfaces/msg/ParameterType.
    nodes = [node for survey in bench.seen().of("interface") for node in survey.data["nodes"]]
    caller = bench.call(f"{nodes[0]}/set_parameters", "rcl_interfaces/srv/SetParameters") if nodes else None
    if caller and caller.await_server(PATIENCE):
        caller.ask({"parameters": [{"name": "text", "value": {"type": 4, "string_value": text}}]})
        caller.await_answers(PATIENCE)


greeter = Draft(
    "parameter.greeter",
    "A parameter · The greeter",
    "Publish the text of a parameter, which may change at any time.",
    OwnScenario(scenario, "publisher"),
)


def heard(seen: Part) -> tuple[list[str], list[str]]:
    """The greetings until the parameter was set, and those afterwards."""
    texts = [str(event.data["fields"]["data"]) for event in seen.of("message")]
    kinds = [event.kind for event in seen.events if event.kind in ("message", "answered")]
    before = kinds.index("answered") if "answered" in kinds else len(kinds)
    return texts[:before], texts[before + 1 :]  # one more with the old text may have been on its way


@greeter.criterion("default", 3, "Says Hello until somebody sets the parameter")
def default(seen: Part, _: Part) -> Finding:
    """Before anybody sets it, the parameter has its default."""
    before, _after = heard(seen)
    return Finding(set(before) == {"Hello"}, "“Hello”", f"“{before[0]}”" if before else "no greeting")


@greeter.criterion("follows", 7, "Says the parameter's text once it was set")
def follows(seen: Part, _: Part) -> Finding:
    """After the parameter was set, every greeting has its text."""
    _before, after = heard(seen)
    text = str(seen.inputs.get("text"))
    odd = [said for said in after if said != text]
    return Finding(bool(after) and not odd, f"“{text}”", f"“{(odd or after)[0]}”" if after else "no greeting")


@greeter.mistake(
    "parameter_not_declared",
    certain=True,
    says="Your node refused the parameter text: it has no such parameter.",
    next_step='Declare it in __init__, with its default: self.declare_parameter("text", "Hello").',
)
def parameter_not_declared(seen: Part, _: Part) -> bool:
    """The node refuses the parameter."""
    return any(not event.data["fields"]["results"][0]["successful"] for event in seen.of("answered"))


@greeter.mistake(
    "parameter_read_once",
    certain=True,
    says="Your node took the new value of the parameter, and goes on saying the old one: it was read only once.",
    next_step='Ask for it each time, in the method that the timer calls: self.get_parameter("text").value.',
)
def parameter_read_once(seen: Part, _: Part) -> bool:
    """It takes the parameter, and goes on with the old text."""
    before, after = heard(seen)
    return bool(before and after) and set(after) == {before[0]}


EXERCISE = greeter.exercise()
