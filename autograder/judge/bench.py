"""The bench: what a scenario's words do. One bench serves one look at one subject."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

from autograder.exercises.evidence import Evidence, Part, Reference
from autograder.exercises.model import Look
from autograder.judge import clock, graph, type_hashes
from autograder.judge.action_client import RecordedActionClient
from autograder.judge.actions import ScriptedActionServer
from autograder.judge.callers import RecordedCaller
from autograder.judge.clock import SimulatedClock
from autograder.judge.interfaces import service_fields
from autograder.judge.planted import Bed
from autograder.judge.recorder import Recorder
from autograder.judge.services import Answer, RecordedServer
from autograder.judge.settling import Settling
from autograder.judge.topics import Ear, LogReader, Mouth
from autograder.judge.wire import JudgeFailed, Wire

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from random import Random

    from autograder.judge.subjects import Subject

APPEAR = 12.0
"""Seconds of wall time in which a subject that runs must show up on the graph at all. Generous: starting slowly is
not wrong, and a program needs a quarter of a second."""
SETTLED = {Look.FAST: 1.0, Look.REAL_TIME: 3.0}
"""Seconds without a change of the graph after which a command is taken to have made all that it makes."""
MATCH = 5.0
"""Seconds in which two endpoints that fit must have met."""
GRAPH_POLL = 0.004
"""Seconds between two queries of the graph, which has no event to wait for."""


class TestBench:
    """Implements :class:`autograder.exercises.model.Bench` on real ROS.

    Attributes:
        parts: The finished parts.
        doubtful: Something in a fast look must be confirmed in real time.
    """

    __test__ = False  # not a pytest class

    def __init__(
        self,
        subject: Subject,
        domain_id: int,
        reference: Reference,
        look: Look,
        random: Random,
        before: Evidence | None = None,
    ) -> None:
        self.look = look
        self.random = random
        self.reference = reference
        self.parts: list[Part] = []
        self.doubtful = False
        self._before = before
        self._subject = subject
        self._domain_id = domain_id
        self._recorder = Recorder()
        self._wire: Wire | None = None
        self._bed: Bed | None = None
        self._open = contextlib.ExitStack()
        self._ears: dict[str, Ear] = {}
        self._mouths: dict[str, Mouth] = {}
        self._clock: SimulatedClock | None = None
        self._clock_refused = False
        self._deaf: set[str] = set()
        self._clean = True
        self._in_part = False

    # --- parts ---------------------------------------------------------------------------------------------

    def part(self, name: str, **inputs: Any) -> None:
        """Begin a part: a fresh run of the subject."""
        self.stop()
        self._recorder.begin(name, inputs)
        self._in_part = True
        if self._wire is None or not (self._subject.shares_participant and self._clean):
            self._close_wire()
            self._wire, self._bed = Wire(self._domain_id), Bed(self._domain_id)
            # One reader for all parts of a participant: a new one would be told the log of the parts before.
            self._log = LogReader(self._wire, self._recorder)
            self._subject.renew()

    def keep(self, name: str) -> bool:
        """In a second look, take over what the first one saw in a part, if the subject came to its own end there."""
        known = self._before.part(name) if self._before else Part(name)
        if known.ending is None:
            return False
        self.stop()
        self.parts.append(known)
        return True

    def stop(self) -> None:
        """End the subject, keep what was seen and take away what the judge put up for this part."""
        if not self._in_part:
            return
        self._in_part = False
        self.note_interface()
        self._clean = self._subject.ended
        self.parts.append(_made(self._recorder.part()))
        self._subject.stop()
        self._open.close()
        if self._bed is not None:
            self._bed.clear()
        self._ears, self._mouths, self._clock, self._clock_refused, self._deaf = {}, {}, None, False, set()
        if self.wire.failure is not None:
            raise JudgeFailed(f"the judge's own node failed: {self.wire.failure!r}")

    def close(self) -> None:
        """End everything. Safe to call at any time."""
        try:
            self.stop()
        finally:
            self._close_wire()

    def _close_wire(self) -> None:
        if self._wire is not None and self._bed is not None:
            self._bed.close()
            self._wire.close()
            self._wire = self._bed = None

    @property
    def wire(self) -> Wire:
        """The judge's participant in this part."""
        if self._wire is None:
            raise RuntimeError("a scenario begins with bench.part(...)")
        return self._wire

    # --- the subject ---------------------------------------------------------------------------------------

    def start(self, *arguments: Any, **options: Any) -> None:
        """Start the subject."""
        self._subject.start(self._recorder, arguments, options)

    def release(self) -> None:
        """Let a held subject spin."""
        self._subject.release()

    def await_end(self, within: float) -> bool:
        """Wait until the subject has ended by itself."""
        return self._recorder.wait(lambda: self._subject.ended, within)

    def await_endpoint(self, role: str, name: str) -> bool:
        """Wait until the subject's endpoint is on the graph and matched with the judge's, if it has one."""
        self._await_graph(lambda: name in self._survey().get(role, {}))
        # Written down now, because a subject that ends takes its endpoints along.
        self.note_interface()
        if name not in self._recorder.part().endpoints(role):
            type_name = graph.is_there(self.wire.node, role, name)
            if type_name is None:
                return False
            self._recorder.record("interface", "topic", **{role: {name: type_name}})
        counterparts: dict[str, Mapping[str, Ear | Mouth]] = {
            "publisher": self._ears,
            "subscription": self._mouths,
        }
        counterpart = counterparts.get(role, {}).get(name)
        if counterpart is None or counterpart.type_name != self._recorder.part().endpoints(role)[name]:
            return True  # there is nobody to be matched with
        return self._recorder.wait(
            lambda: counterpart.matched > 0 or self._subject.ended or self._mismatched(name), MATCH
        )

    def await_node(self) -> bool:
        """Wait until a node of the subject's is on the graph; gives up when the subject has ended."""

        def there() -> bool:
            return bool(graph.subject_nodes(self.wire.node))

        self._recorder.wait(lambda: there() or self._subject.ended, APPEAR, poll=GRAPH_POLL)
        self.note_interface()
        return there()

    def await_any_endpoint(self, roles: tuple[str, ...]) -> graph.Interface:
        """Wait until the subject has an endpoint of one of these roles; the whole interface as it is then."""
        self._await_graph(lambda: any(self._survey()[role] for role in roles))
        return self._survey()

    def _await_graph(self, there: Callable[[], bool]) -> None:
        """Wait for something on the graph, until the subject has ended or has surely made all that it makes."""
        settled = Settling(SETTLED[self.look])

        def over() -> bool:
            if there() or self._subject.ended:
                return True
            marker = self._subject.marker
            if marker is not None:
                return graph.shows(self.wire.node, marker)
            return settled.unchanged(self._survey(), len(graph.subject_nodes(self.wire.node)))

        self._recorder.wait(over, APPEAR, poll=GRAPH_POLL)

    def _survey(self) -> graph.Interface:
        return graph.survey(self.wire.node)

    def note_interface(self) -> None:
        """Write down the subject's endpoints as they are now."""
        interface = self._survey()
        nodes = [node.full for node in graph.subject_nodes(self.wire.node)]
        self._recorder.record("interface", "graph", nodes=nodes, **interface)

    def _mismatched(self, name: str) -> bool:
        return self._recorder.part().first("mismatch", name) is not None

    # --- counterparts --------------------------------------------------------------------------------------

    def listen(self, topic: str, type_name: str) -> None:
        """Subscribe as the course's listener does: reliable, so that a best-effort talker is found out."""
        ear = Ear(self.wire, self._recorder, topic, type_name)
        self._ears[topic] = ear
        self._open.callback(self.wire.node.destroy_subscription, ear.subscription)

    def heard(self, topic: str) -> int:
        """How many messages arrived on a topic so far in this part."""
        return len(self._recorder.part().of("message", topic))

    def speak(self, topic: str, type_name: str) -> Mouth:
        """Create a publisher with the course's default QoS."""
        mouth = Mouth(self.wire, self._recorder, topic, type_name)
        self._mouths[topic] = mouth
        self._open.callback(self.wire.node.destroy_publisher, mouth.publisher)
        return mouth

    def plant(self, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str]) -> None:
        """Put a node on the graph, until the next part has planted others."""
        assert self._bed is not None
        self._bed.plant(name, publishes=publishes, subscribes=subscribes)

    def serve(self, service: str, type_name: str, answer: Answer) -> RecordedServer:
        """Serve until the part ends."""
        server = RecordedServer(self.wire, self._recorder, service, type_name, answer)
        self._open.callback(server.close)
        return server

    def call(self, service: str, type_name: str) -> RecordedCaller:
        """Be a client of the subject's service until the part ends."""
        caller = RecordedCaller(
            self.wire, self._recorder, service, type_name, server_is_gone=lambda: self._subject.ended
        )
        self._open.callback(caller.close)
        return caller

    def call_action(self, action: str, type_name: str) -> RecordedActionClient:
        """Be a client of the subject's action until the part ends."""
        caller = RecordedActionClient(
            self.wire, self._recorder, action, type_name, server_is_gone=lambda: self._subject.ended
        )
        self._open.callback(caller.close)
        return caller

    def serve_action(
        self, action: str, type_name: str, *, accept_goal: bool = True, accept_cancel: bool = True
    ) -> ScriptedActionServer:
        """Serve an action whose every step the scenario decides, until the part ends."""
        server = ScriptedActionServer(
            self.wire,
            self._recorder,
            action,
            type_name,
            accept_goal=accept_goal,
            accept_cancel=accept_cancel,
            client_is_gone=lambda: self._subject.ended,
        )
        self._open.callback(server.close)
        return server

    # --- time ----------------------------------------------------------------------------------------------

    def run_time(
        self, seconds: float, *, until: Callable[[], bool] | None = None, quiet: float | None = None
    ) -> None:
        """Let ``seconds`` of the subject's time pass, or fewer where ``until`` holds or nothing happens."""
        over = until or (lambda: False)
        if self.look is Look.FAST and self._follow_clock():
            assert self._clock is not None
            self._clock.run(seconds, lambda: over() or self._subject.ended)
            self.doubtful = self.doubtful or self._clock.doubtful
            return
        self._recorder.wait(lambda: over() or self._subject.ended, seconds, quiet=quiet, wall=True)

    def _follow_clock(self) -> bool:
        if self._clock is None and not self._clock_refused and (self._ears or self._mouths):
            self._clock_refused = True
            if any(self.wire.node.count_publishers(topic) > 1 for topic in self._ears):
                # Two nodes of one name share their parameter services: one of them would keep to real time.
                self.doubtful = True
                return False
            node = next(iter(self._nodes()), None)
            if node is not None:
                stepped = SimulatedClock(self.wire, self._recorder, node)
                self._open.callback(stepped.close)
                if stepped.take_over() and stepped.stands_still(self._silence()):
                    self._clock = stepped
                else:
                    # It may yet obey later and then stop: only a fresh run in real time can tell.
                    self._recorder.simulated_now = None
                    self.doubtful = self.doubtful or bool(self._ears)
        return self._clock is not None

    def _silence(self) -> Callable[[], bool]:
        def heard() -> int:
            return sum(map(self.heard, self._ears))

        before = heard()
        # One message may still have been on its way when the clock stopped.
        return lambda: heard() <= before + 1

    def doubt(self) -> None:
        """What is seen in this look must be confirmed in real time."""
        self.doubtful = True

    def settle(self) -> None:
        """Ask each node of the subject's twice; a node that did not answer once is not asked again in this part."""
        limit = clock.ANSWER_LIMIT if self.look is Look.FAST else clock.PATIENT_ANSWER
        for node in self._nodes():
            if node.full in self._deaf or self._subject.ended:
                continue
            if not all(clock.answers(self.wire, self._recorder, node, limit) for _ in range(2)):
                self._deaf.add(node.full)

    def note_whether_it_spins(self) -> None:
        """Ask each node of the subject's for a parameter; write down which one does not answer."""
        for node in self._nodes():
            if not self._subject.ended and not clock.answers(self.wire, self._recorder, node):
                self._recorder.record("unanswered", node.full)
                self.note_where_it_hangs()

    def note_where_it_hangs(self) -> None:
        """Write down the subject's stacks; a command ends by that. To be asked last in a part."""
        if not self._subject.ended:
            self.note_interface()
            self._recorder.record("stack", "subject", text=self._subject.stack())

    def _nodes(self) -> list[graph.NodeName]:
        """The subject's nodes, those that the judge is matched with first, once their names are known."""
        found: list[graph.NodeName] = []

        def named() -> bool:
            found[:] = graph.counterparts(self.wire.node, list(self._ears), list(self._mouths))
            return bool(found) or self._subject.ended

        if not (self._ears or self._mouths):
            return graph.subject_nodes(self.wire.node)
        self._recorder.wait(named, 1.0, poll=GRAPH_POLL)
        return found

    def wait_until(
        self, condition: Callable[[Evidence], bool], within: float, *, quiet: float | None = None
    ) -> bool:
        """Wait for something in the evidence of this part; gives up when the subject has ended."""

        def holds() -> bool:
            return condition(Evidence([self._recorder.part()], self.reference, self.look is Look.REAL_TIME))

        self._recorder.wait(lambda: holds() or self._subject.ended, within, quiet=quiet)
        return holds()

    def compare_type(self, service: str, like: str) -> None:
        """Write down whether a service's type has the fields of the type ``like``, by its hashes on the graph."""
        made = self._survey()["service"].get(service, "")
        expected = type_hashes.expected_hashes(like, made.partition("/")[0])
        seen: dict[str, str] = {}

        def announced() -> bool:
            seen.update(type_hashes.served_hashes(self.wire.node, service))
            return len(seen) == len(expected) or self._subject.ended

        self._recorder.wait(announced, MATCH, poll=GRAPH_POLL)
        self._recorder.record("type", service, type=made, same=seen == expected, fields=service_fields(like))

    def note_its_log(self) -> None:
        """Write down each text of its log once, for the reference output."""
        for text in dict.fromkeys(event.data["text"] for event in self._recorder.part().of("log")):
            self._recorder.record("said", "log", text=text)


def _made(part: Part) -> Part:
    """The part; of a node whose constructor never ended only that counts: nobody could use it."""
    if part.first("subject", "never_constructed") is None:
        return part
    return Part(
        part.name, part.inputs, [event for event in part.events if event.kind in ("subject", "stack")]
    )
