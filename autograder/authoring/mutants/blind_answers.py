"""Answers that do not look at their inputs, made from the recorded drawings: a table of what the solution did.

They show what a student earns who counts the inputs, or who has the practice drawings by heart.
"""

from __future__ import annotations

import json
from collections import Counter
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult

from autograder.authoring.mutants.engine import Mutant
from autograder.authoring.mutants.trials import rounded
from autograder.authoring.paper.nodes import PaperNode
from autograder.judge.bench.qos_profiles import profile
from autograder.judge.bench.ros_interfaces import filled, interface, to_data
from autograder.kit.counterparts import Qos

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from rclpy.parameter import Parameter

    from autograder.authoring.mutants.trials import PaperTask
    from autograder.kit.evidence import Event, Part

OPERATOR = "does_not_look"
"""In the place of an operator, for what is not a change of the solution."""
COUNTS, USUAL, LAST = "counts its inputs", "always does the usual", "always does the last"
BY_HEART = "knows the practice drawings by heart"
_SET, _DESCRIBE = "/set_parameters", "/describe_parameters"
_DIGITS = 4
"""Digits behind the point of the numbers by which an input is found again."""
Reaction = dict[str, Any]
"""The solution's reaction to an input: ``input``, ``messages`` as (seconds, topic, fields), ``answer``."""


def blind_answers(task: PaperTask) -> Iterator[Mutant]:
    """Yield the answers that do not look, as programs for paper; nothing if the inputs are not drawn by name."""
    if not (task.exercise.is_drawn and task.parts):
        return
    react = _reactions if task.reference.interface else _returned
    drawings = [react(part) for part in task.parts]
    first = drawings[0]
    if len(first) < 2:
        return
    common = Counter(_did(one) for one in first[1:]).most_common(1)[0][0]
    usual = next(place for place, one in enumerate(first) if place and _did(one) == common)
    table = {_key(one["input"]): one for drawing in drawings for one in drawing[1:]}
    for kind, reactions, known in (
        (COUNTS, first, {}),
        (USUAL, [first[0], first[usual]], {}),
        (LAST, [first[0], first[-1]], {}),
        (BY_HEART, [first[0], first[usual]], table),
    ):
        key = f"{OPERATOR}:{kind.replace(' ', '_')}"
        yield Mutant(key, OPERATOR, kind, 0, "", -1, "", "", 1, _program(task, reactions, known))


def _program(task: PaperTask, reactions: Sequence[Reaction], known: Mapping[str, Reaction]) -> str:
    """Return the program of an answer: a node, or a function, with a table of reactions.

    Args:
        task: The exercise on paper.
        reactions: The reaction at the start, and those to the inputs in their order; the last one is repeated.
        known: The reactions to inputs that the answer recognizes, by their texts.
    """
    data = {"reactions": reactions, "known": known, "interface": task.reference.interface}
    data |= {"qos": task.reference.qos, "parameters": _parameters(task.parts[0])}
    base, makes = (
        (BlindNode.__name__, f"type({task.root!r}, ({BlindNode.__name__},), {{'data': data}})")
        if task.reference.interface
        else (recall.__name__, f"partial({recall.__name__}, data)")
    )
    return (
        "import json\nfrom functools import partial\n"
        f"from {__name__} import {base}\n"
        f"data = json.loads({json.dumps(data, default=dict)!r})\n{task.root} = {makes}\n"
    )


def _reactions(part: Part) -> list[Reaction]:
    """Return what the solution did at the start, and after each input of a drawing."""
    found: list[Reaction] = [{"input": None, "messages": [], "answer": None}]
    began = None
    for event in part.events:
        is_input = event.kind in ("sent", "asked") and not event.name.endswith(_DESCRIBE)
        if is_input:
            found.append({"input": [event.name, _as_input(event)], "messages": [], "answer": None})
        if is_input or began is None:
            began = event.sim
        if event.kind == "message":
            delay = (event.sim or 0.0) - (began or event.sim or 0.0)
            found[-1]["messages"].append([round(delay, 6), event.name, event.data["fields"]])
        elif event.kind == "answered" and not event.name.endswith(_DESCRIBE):
            found[-1]["answer"] = event.data["fields"]
    return found


def _as_input(event: Event) -> Any:
    fields = event.data["fields"]
    return fields["parameters"][0]["value"] if event.name.endswith(_SET) else fields


def _returned(part: Part) -> list[Reaction]:
    """Return what a function returned for each item of its list."""
    values = [(event.data["given"], event.data["values"][0][0]) for event in part.of("noted")]
    return [{"input": None, "answer": None}, *({"input": given, "answer": value} for given, value in values)]


def _parameters(part: Part) -> list[Any]:
    described = [event for event in part.of("answered") if event.name.endswith(_DESCRIBE)]
    return [one for event in described for one in event.data["fields"]["descriptors"]]


def _did(reaction: Reaction) -> str:
    return json.dumps([reaction.get("messages"), reaction["answer"]], default=str)


def _key(of: Any) -> str:
    return json.dumps(rounded(of, _DIGITS), sort_keys=True, default=str)


def _filled_in(given: Any, whole: Any) -> Any:
    """Return the fields of an input that a recorded input names."""
    if isinstance(given, dict) and isinstance(whole, dict):
        return {key: _filled_in(one, whole.get(key)) for key, one in given.items()}
    return whole


def _found(data: Mapping[str, Any], number: int, given: Any) -> Reaction:
    """Return the reaction to the input of a number, counted from 1."""
    reactions: Sequence[Reaction] = data["reactions"]
    for known in data["known"].values():
        is_same_kind = isinstance(given, str) == isinstance(known["input"], str)
        if is_same_kind and _key(known["input"]) == _key(_like(known["input"], given)):
            return known
    return reactions[min(number, len(reactions) - 1)]


def _like(known: Any, given: Any) -> Any:
    if isinstance(known, list) and isinstance(given, list) and len(known) == len(given) == 2:
        return [given[0], _filled_in(known[1], given[1])]
    return given


def recall(data: Mapping[str, Any], given: Sequence[Any]) -> list[Any]:
    """Return what the solution returned for another list."""
    return [_found(data, number, str(one))["answer"] for number, one in enumerate(given, 1)]


class BlindNode(PaperNode):
    """A node that does what the solution did in another drawing, by the number of its inputs.

    Attributes:
        data: The reactions of the solution, and its endpoints.
    """

    data: ClassVar[Mapping[str, Any]]

    def __init__(self) -> None:
        super().__init__("blind")
        ends, qos = self.data["interface"], self.data["qos"]

        def profile_of(role: str, name: str) -> Any:
            return profile(Qos(qos.get(role, {}).get(name, Qos.DEFAULT)))

        self._number = 0
        self._ahead: list[Any] = []
        self._said = {
            name: self.create_publisher(interface(kind), name, profile_of("publisher", name))
            for name, kind in ends.get("publisher", {}).items()
        }
        for name, kind in ends.get("subscription", {}).items():
            hears = partial(self._hear, name)
            self.create_subscription(interface(kind), name, hears, profile_of("subscription", name))
        for name, kind in ends.get("service", {}).items():
            self.create_service(interface(kind), name, partial(self._serve, name))
        for name, kind in ends.get("client", {}).items():
            self.create_client(interface(kind), name)
        for described in self.data["parameters"]:
            descriptor = filled(ParameterDescriptor, described, self._name)
            ranges = [*descriptor.floating_point_range, *descriptor.integer_range]
            value = ranges[0].from_value if ranges else _DEFAULTS[descriptor.type]
            self.declare_parameter(descriptor.name, value, descriptor)
        self.add_on_set_parameters_callback(self._set)
        self._do(self.data["reactions"][0])

    def _hear(self, name: str, message: Any) -> None:
        self._react(name, to_data(message))

    def _serve(self, name: str, request: Any, response: Any) -> Any:
        return filled(type(response), self._react(name, to_data(request))["answer"] or {}, name)

    def _set(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        value = to_data(parameters[0].get_parameter_value())
        answer = self._react(f"/{self._name}{_SET}", value)["answer"] or {}
        (result,) = answer.get("results") or [{"successful": True}]
        return filled(SetParametersResult, result, self._name)

    def _react(self, name: str, fields: Any) -> Reaction:
        self._number += 1
        for timer in self._ahead:
            timer.cancel()
        self._ahead.clear()
        reaction = _found(self.data, self._number, [name, fields])
        self._do(reaction)
        return reaction

    def _do(self, reaction: Reaction) -> None:
        for delay, topic, fields in reaction["messages"]:
            publisher = self._said[topic]
            publish = partial(publisher.publish, filled(publisher.kind, fields, topic))
            if delay:
                self._later(delay, publish)
            else:
                publish()

    def _later(self, delay: float, publish: Any) -> None:
        def once() -> None:
            timer.cancel()
            publish()

        timer = self.create_timer(delay, once)
        self._ahead.append(timer)


_DEFAULTS = {1: False, 2: 0, 3: 0.0, 4: ""}
"""A value for each type of a parameter (rcl_interfaces/msg/ParameterType.msg)."""
