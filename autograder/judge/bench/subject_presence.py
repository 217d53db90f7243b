"""Watches the subject's nodes and endpoints on the ROS graph during one part, and records each change.

The result of each query is recorded at once. A second query could find less, because the endpoints of a program
disappear when it ends.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from autograder.judge.bench import discovery
from autograder.judge.machine_fitness import Patience
from autograder.kit.bench import Pace
from autograder.kit.counterparts import Qos
from autograder.kit.output.workspace_reports import report_of
from autograder.kit.runners import BUILDING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rclpy.node import Node

    from autograder.judge.bench.recorded_topics import RecordedPublisher, RecordedSubscription
    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.subject import Subject

    Counterparts = Mapping[str, RecordedSubscription | RecordedPublisher]


SETTLED = {Pace.FAST: 1.0, Pace.REAL_TIME: 3.0}
"""If the graph has not changed for this many seconds, a command is assumed to have made all its endpoints. By pace."""


class _Settling:
    """Tells when a command's nodes and endpoints have not changed for a while.

    Args:
        seconds: How long the nodes and endpoints must not change. These seconds get longer on a busy machine
            (:mod:`autograder.judge.machine_fitness`), because a program that has made its node may have to wait for a
            processor before it can make its endpoints.
    """

    def __init__(self, seconds: float) -> None:
        self._last: Any = None
        self._patience = Patience(seconds)

    def unchanged(self, interface: discovery.Interface, nodes: int) -> bool:
        """Return True if there are nodes, and the graph has been the same for ``seconds``."""
        state = (nodes, interface)
        if state != self._last:
            self._last = state
            self._patience.restart()
        return nodes > 0 and self._patience.left <= 0


APPEAR = 12.0
"""Time limit for a running subject to appear on the graph, in seconds that get longer on a busy machine.

A program usually appears within a quarter of a second. The limit is much longer, because a slow start is not a mistake.
"""
MAX_RESTARTS = 2
"""The maximum number of times in a part that the time limit :data:`APPEAR` starts again.

The limit starts again when the subject has started more processes, because a command may build a package before it runs
the program. Without this maximum, a program that forks without end would restart the limit forever.
"""
NAMED = 1.0
"""Time limit in seconds for the names of the nodes that use the judge's topics to be discovered."""
MATCH = 5.0
"""Time limit in seconds for two compatible endpoints to be matched."""
GRAPH_POLL = 0.004
"""Seconds between two queries of the graph; the graph has no event to wait for."""
START_POLL = 0.02
"""Seconds between two queries while a process starts or a build runs, as long as no node was announced."""


@dataclass
class Presence:
    """The subject's nodes and endpoints on the graph, as the judge's node sees them.

    Attributes:
        node: The judge's node.
        recorder: The record of the part.
        subject: The subject.
        pace: The pace of the look.
        announced: Returns True if a process of the subject is known to have made a node.
        subscriptions: The judge's subscriptions, by the names that the subject uses for their topics.
        publishers: The judge's publishers, by the names that the subject uses for their topics.
    """

    node: Node
    recorder: Recorder
    subject: Subject
    pace: Pace
    announced: Callable[[], bool]
    subscriptions: dict[str, RecordedSubscription] = field(default_factory=dict)
    publishers: dict[str, RecordedPublisher] = field(default_factory=dict)
    _again: int = field(default=MAX_RESTARTS, init=False)
    _unused: tuple[list[str], list[str]] | None = field(default=None, init=False)
    """The judge's topics when a wait for a node that uses one of them was in vain; None before."""

    def nodes(self) -> list[discovery.NodeName]:
        return discovery.subject_nodes(self.node, self.subject.keeper)

    def counterparts(self) -> list[discovery.NodeName]:
        """Return the subject's nodes that use the judge's topics; all of the subject's nodes if none uses one.

        This waits up to a second until the names of these nodes are discovered, and for a node that uses one of these
        topics only once, because it is called again in each step of a run.
        """
        topics = list(self.subscriptions), list(self.publishers)
        found: list[discovery.NodeName] | None = []

        def named() -> bool:
            nonlocal found
            found = discovery.counterparts(self.node, *topics)
            is_missing = found == [] and self._unused == topics
            return bool(found) or is_missing or self.subject.ended

        if any(topics) and not self.recorder.wait(named, NAMED, poll=GRAPH_POLL):
            self._unused = topics
        return self.nodes() if found == [] and not self.subject.ended else found or []

    def await_endpoint(self, role: str, name: str) -> bool:
        """Wait until the subject's endpoint is on the graph and, if an endpoint of the judge fits, matched with it."""
        self.await_interface(
            lambda interface: name in interface.get(role, {}) or name in self._matched().get(role, {})
        )
        self._note_matched_endpoints()
        if name not in self.recorder.part().endpoints(role):
            return False
        counterparts: dict[str, Counterparts] = {
            "publisher": self.subscriptions,
            "subscription": self.publishers,
        }
        counterpart = counterparts.get(role, {}).get(name)
        if counterpart is None or counterpart.type_name != self.recorder.part().endpoints(role)[name]:
            return True  # the judge has no endpoint that could match the subject's
        return self.recorder.wait(
            lambda: (
                counterpart.matched > 0
                or self.subject.ended
                or self.recorder.part().first("mismatch", counterpart.topic) is not None
            ),
            MATCH,
        )

    def await_node(self) -> bool:
        """Wait for a node of the subject on the graph. Also return True if the subject had a node but has ended."""
        nodes: list[discovery.NodeName] = []

        def there() -> bool:
            nodes[:] = self.nodes()
            return bool(nodes)

        self._await_appearance(lambda: there() or self.subject.ended)
        self.note_interface()
        return bool(nodes) or self.note_short_life()

    def await_sign_of_life(self, within: float) -> bool:
        """Wait until the subject has printed something or has a node on the graph; give up if the subject has ended."""
        alive = False

        def there() -> bool:
            nonlocal alive
            seen = self.recorder.part()
            alive = bool(seen.of("output") or seen.of("log") or self.nodes())
            return alive

        self._wait_on_graph(lambda: there() or self.subject.ended, within)
        return alive

    def await_interface(self, there: Callable[[discovery.Interface], bool]) -> discovery.Interface:
        """Wait until a condition on the graph holds, the subject has ended, or all its endpoints are on the graph.

        Returns:
            The endpoints that the last query found. Exactly these are recorded, because a new query could find fewer:
                the endpoints of a program disappear when it ends.
        """
        settled = _Settling(SETTLED[self.pace])
        interface: discovery.Interface = {}

        def over() -> bool:
            nonlocal interface
            marker = self.subject.marker
            # Look for the marker topic (see discovery.shows) before the survey. The subject makes it last. So if it is
            # on the graph, the survey finds all endpoints.
            all_made = marker is not None and discovery.shows(self.node, marker)
            interface = discovery.survey(self.node)
            if there(interface) or self.subject.ended or all_made:
                return True
            return marker is None and settled.unchanged(interface, len(self.nodes()))

        self._await_appearance(over)
        self.note_interface(interface)
        return interface

    def _await_appearance(self, condition: Callable[[], bool]) -> None:
        """Wait until a condition holds, at most :data:`APPEAR` seconds, longer if the subject starts more processes."""
        patience = Patience(APPEAR)
        # A command's runner normally starts the command at once. So if a process begins in the second half of the time
        # limit, something else goes on, such as a build.
        earlier: frozenset[int] | None = None

        def overdue() -> bool:
            nonlocal earlier
            left = patience.left
            if left <= 0 and self._is_building():
                patience.restart()
                return False
            if left <= APPEAR / 2 and earlier is None:
                earlier = self.subject.processes()
            if left > 0 or earlier is None:
                return False
            if not self._again or self.subject.processes() <= earlier:
                return True
            self._again -= 1
            patience.restart()
            earlier = None
            return False

        self._wait_on_graph(lambda: condition() or overdue(), BUILDING + (MAX_RESTARTS + 2) * APPEAR)

    def _is_building(self) -> bool:
        """Return True if a runner has reported the packages that it builds, and not yet the end of the build."""
        part = self.recorder.part()
        return report_of(part, "found") is not None and report_of(part) is None

    def _wait_on_graph(self, condition: Callable[[], bool], within: float) -> None:
        """Poll the graph: often once a process of the subject is known to have made a node, and rarely before that."""
        patience = Patience(within)
        held = False

        def over() -> bool:
            nonlocal held
            held = condition()
            return held

        heard = self.subject.shares_participant or self.recorder.wait(
            lambda: over() or self.announced(), within, poll=START_POLL
        )
        if heard and not held:
            self.recorder.wait(over, patience.left, poll=GRAPH_POLL)

    def note_interface(self, interface: discovery.Interface | None = None) -> None:
        """Record the subject's endpoints if they have changed.

        Args:
            interface: The endpoints as seen a moment ago. If not given, they are queried now.
        """
        nodes = sorted(node.full for node in discovery.every_node(self.node, self.subject.keeper))
        topic_ends = discovery.topic_ends(self.node)
        ends = sorted([end.role, end.topic, end.process] for end in topic_ends)
        seen: dict[str, Any] = {
            "nodes": nodes,
            "ends": ends,
            **(interface or discovery.survey(self.node, topic_ends)),
        }
        if unusual := sorted(
            [end.role, end.topic, str(end.qos)] for end in topic_ends if end.qos is not Qos.DEFAULT
        ):
            seen["qos"] = unusual
        surveys = self.recorder.part().of("interface", "graph")
        if not surveys or surveys[-1].data != seen:
            self.recorder.record("interface", "graph", **seen)

    def note_last_state(self) -> None:
        """Record the subject's endpoints before its run ends. If a program is ending by itself, wait for its end.

        A program is ending if all its endpoints have disappeared. Without this wait, chance would decide whether the
        exit code and the last lines of output are recorded.
        """
        self.note_interface()
        surveys = self.recorder.part().of("interface", "graph")
        had_endpoints = [any(survey.data[role] for role in discovery.ROLES) for survey in surveys]
        if not self.subject.shares_participant and any(had_endpoints) and not had_endpoints[-1]:
            self.recorder.wait(lambda: self.subject.ended, MATCH)
        self._note_matched_endpoints()

    def note_short_life(self) -> bool:
        """If a subject has ended and the graph never showed its node, record that the subject had announced a node.

        Returns:
            True if the subject has ended and had announced a node, no matter whether the judge discovered the node.
        """
        if not self.subject.ended or not self.announced():
            return False
        part = self.recorder.part()
        if not part.had_node:
            self.recorder.record("announced", "a node")
        return True

    def _note_matched_endpoints(self) -> None:
        """Record the subject's endpoints that were matched with the judge's, even if the graph never showed them."""
        known = self.recorder.part()
        for role, ends in self._matched().items():
            for name, type_name in ends.items():
                if name not in known.endpoints(role):
                    self.recorder.record("interface", "topic", **{role: {name: type_name}})

    def _matched(self) -> discovery.Interface:
        """Return the subject's endpoints that were matched with one of the judge's."""
        part = self.recorder.part()
        sides: tuple[tuple[str, Counterparts, Counterparts], ...] = (
            ("publisher", self.subscriptions, self.publishers),
            ("subscription", self.publishers, self.subscriptions),
        )
        return {
            role: {
                name: end.type_name
                for name, end in ends.items()
                # Skip topics on which the judge is at both ends, because its own endpoints match.
                if name not in others and any(event.data["count"] for event in part.of("matched", end.topic))
            }
            for role, ends, others in sides
        }
