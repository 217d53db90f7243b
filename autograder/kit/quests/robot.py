"""A robot that the judge draws, and what a subject says that it has found on the robot's graph."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit import giving_up
from autograder.kit.giving_up import NOT_AVAILABLE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.kit.evidence import Part

IMPATIENT = 3.0
"""Seconds within which no patient subject has given up; on a busy machine a single look may take one second."""
EVERY_NODE_HAS = ("/rosout", "/parameter_events", "/clock")
"""Topics that tell nothing about a robot."""
_TEXT = r"""['"]([^'"\\]*)['"]"""
_ENTRY = re2.compile(
    rf"""['"](\w+)['"]\s*[:,]\s*(?:{_TEXT}|[\[(\{{]\s*{_TEXT}\s*,?\s*[\])\}}]|None|null|\[\]|\(\))"""
)
"""Matches one entry of a dictionary, as ``print``, ``pprint``, ``json`` or an ``OrderedDict`` shows it.

The value is a text, a list of one text, or nothing: a list of several texts is a guess, not an answer.
"""
_ENDS = {"publishes": ("publishes", "serves"), "subscribes": ("subscribes to", "has a client of")}
"""What a node does with a topic, and with an action."""
_PACKAGE = re2.compile(r"[/.](?:msg|srv|action)[/.]")


@dataclass(frozen=True)
class Robot:
    """The nodes and services that the judge puts on the graph for one run, and the answer that has to be found.

    Attributes:
        asked: The arguments of the student's function or program.
        answer: What there is to find: the right name or type for each key of the dictionary that the task asks for.
            With a single key, the task asks for the name alone. Empty if there is nothing to find: then the subject has
            to say so.
        nodes: The nodes by name, such as ``"arm"`` or ``"/mia/arm"``. Each has the arguments of
            :meth:`autograder.kit.bench.Bench.plant` that it needs, such as ``{"publishes": {topic: type}}``. A node
            that is made first comes first among the ends of a topic.
        services: The services with their types; the judge itself serves them.
        late: The names of nodes and services that come only when the subject is already looking.

    Example::

        Robot(
            asked=("/mia/arm",),
            answer={"topic": "/mia/reach", "type": "geometry_msgs/msg/Point"},
            nodes={"/mia/arm": {"subscribes": {"/mia/reach": "geometry_msgs/msg/Point"}}},
        )
    """

    asked: Sequence[Any] = ()
    answer: Mapping[str, str] = field(default_factory=dict)
    nodes: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    services: Mapping[str, str] = field(default_factory=dict)
    late: Sequence[str] = ()


@dataclass(frozen=True)
class Search:
    """One run of a subject: the robot that the judge drew for it, and what the subject says about this robot."""

    part: Part

    @functools.cached_property
    def robot(self) -> Robot:
        """The robot; one without anything if the run was not reached."""
        return Robot(
            **{key: value for key, value in self.part.inputs.items() if key in Robot.__annotations__}
        )

    @property
    def finds_nothing(self) -> bool:
        """True if this is a run in which there is nothing to find."""
        return bool(self.part.inputs) and not self.robot.answer

    @functools.cached_property
    def names(self) -> Mapping[str, str]:
        """The types of the robot's topics and services by name; the robot's nodes, without a type."""
        names = {f"/{node.lstrip('/')}": "" for node in self.robot.nodes} | {**self.robot.services}
        for ends in self.robot.nodes.values():
            names |= {**ends.get("publishes", {}), **ends.get("subscribes", {})}
        return names

    @functools.cached_property
    def given(self) -> Mapping[str, str]:
        """The subject's answer by key: what it printed last, or returned. Empty if it gave none.

        A single name is the last one that a line names alone, or the end of what the subject lists. If there is nothing
        to find, a subject that reports this may name what exists instead.
        """
        said = self.part.said()
        if len(self.robot.answer) > 1:
            entries = _ENTRY.findall("\n".join(said))
            return {key: text or listed for key, text, listed in entries if key in self.robot.answer}
        possible = sorted({*self.names, *self.robot.answer.values()})
        named = [[name for name in possible if _mentions(line, name)] for line in reversed(said)]
        alone = [names for names in named if len(names) == 1]
        names = next(iter(alone or filter(None, named)), [])
        if self.finds_nothing:
            is_last = len(names) == 1 and names[0] in named[0]
            names = names if is_last and not NOT_AVAILABLE.lines(self.part) else []
        return dict.fromkeys(self.robot.answer or [""], ", ".join(names)) if names else {}

    def has(self, *keys: str) -> bool:
        """Return True if the answer is right for these keys; without keys, for all of them.

        The first slash of a name and a node's namespace may be missing. A type may be written as Python imports it.
        """
        right = self.robot.answer
        return bool(right) and all(
            self._is_named(right[key], self.given.get(key, "")) for key in keys or right
        )

    def _is_named(self, right: str, given: str) -> bool:
        bare = right.rpartition("/")[2] if right in self.robot.nodes else ""
        return _plain(given) in (_plain(right), bare or _plain(right))

    @property
    def has_answered(self) -> bool:
        """True if the subject has ended, or has given a whole answer. A program may stay.

        A function that has to return a name has not answered by printing it.
        """
        if self.is_function:
            return self.part.ending is not None
        whole = self.robot.answer.keys() <= self.given.keys() if len(self.robot.answer) > 1 else self.has()
        return self.part.ending is not None or whole

    @property
    def is_function(self) -> bool:
        """True if the subject is a notebook's function, which returns or raises; a program can do neither."""
        ending = self.part.ending
        has_ended = ending is not None and ending.name in ("returned", "raised")
        return has_ended or self.part.first("subject", "started") is not None

    @property
    def returned(self) -> bool:
        """True if a notebook's function that has named the right name has also returned it; a program returns none."""
        if not self.is_function or len(self.robot.answer) != 1:
            return True
        return _plain(str(self.part.returned).strip("'\"")) in map(_plain, self.robot.answer.values())

    @property
    def limit_fault(self) -> str:
        """What is wrong with the end of a run in which there is nothing to find, in words; empty if nothing is.

        A function has to raise TimeoutError when its patience is over. A program, which can raise nothing, has to end.
        """
        part = self.part
        if not part.events:
            return "not reached"
        if part.ending is None:
            limit = f"still looking after {giving_up.GIVE_UP_LIMIT:g} s"
            return "" if giving_up.goes_on_waiting(part) else limit
        if not self.is_function:
            named = [text or listed for _, text, listed in _ENTRY.findall("\n".join(part.said()))]
            return f"named {', '.join(filter(None, named))}" if any(named) else ""
        if part.returned is not None:
            return f"returned {part.returned}"
        raised = part.traceback.rstrip().rpartition("\n")[2]
        return giving_up.broken_patience(part) if raised.startswith("TimeoutError") else f"raised {raised}"

    @property
    def astray(self) -> list[str]:
        """The names in the answer that the robot has, or that every node has, but that are not asked for."""
        told = {f"/{name.lstrip('/')}" for value in self.given.values() for name in value.split(", ")}
        return sorted(told & {*self.names, *EVERY_NODE_HAS} - {*self.robot.answer.values()})

    @property
    def astray_in_words(self) -> str:
        """The names that lead astray, and the nodes of the graph that use them; empty if there are none."""
        deeds = [
            f"{node} {verbs['/action/' in kind]} {end} ({kind})"
            for node, has in self.robot.nodes.items()
            for way, verbs in _ENDS.items()
            for end, kind in has.get(way, {}).items()
            if not {f"/{node.lstrip('/')}", end}.isdisjoint(self.astray)
        ]
        return " and ".join(self.astray) + (f". On the graph, {', '.join(deeds)}" if deeds else "")

    @property
    def since_it_appeared(self) -> Part:
        """The run from the first moment at which there was a node that is not the robot's; empty if there was none."""
        nodes = [{*event.data.get("nodes", ())} - self.names.keys() for event in self.part.events]
        first = next((place for place, own in enumerate(nodes) if own), len(nodes))
        return replace(self.part, events=self.part.events[first:])

    @property
    def gave_up_at_once(self) -> bool:
        """True if the subject ended much too early, and neither named nor returned anything."""
        ending, node = self.part.ending, self.since_it_appeared.first("interface")
        early = ending is not None and (node is None or ending.t < node.t + IMPATIENT)
        return early and not self.given and self.part.returned in (None, "None")

    @property
    def in_words(self) -> str:
        """How a run without an answer went, for the card."""
        if self.part.ending is None:
            return "no answer, and it never ended" if self.part.events else "not reached"
        return f"“{said[-1]}”" if (said := self.part.said()) else "no answer"


def _mentions(line: str, name: str) -> bool:
    """Return True if a line has the whole name in it, with or without the slash in front."""
    whole = rf"(?:^|[^\pL\pN_/])/?{re2.escape(name.lstrip('/'))}(?:[^\pL\pN_/]|$)"
    return re2.search(whole, line) is not None


def _plain(name: str) -> str:
    return str(_PACKAGE.sub("/", name.strip().lstrip("/")))
