"""Implements the bench, whose methods a scenario calls.

A bench is for one look, that is, one execution of a scenario with one subject: a fast look in simulated time or, to
confirm its result, a look in real time.
"""

from __future__ import annotations

import contextlib
import itertools
import time
from typing import TYPE_CHECKING, Any, TypeVar

from autograder.judge.bench import discovery
from autograder.judge.bench.discovery import Announcements, process_of
from autograder.judge.bench.judge_nodes import DecoyNodes, Wire
from autograder.judge.bench.recorded_action_server import RecordedActionServer
from autograder.judge.bench.recorded_actions import RecordedActionClient, ScriptedActionServer
from autograder.judge.bench.recorded_services import Answer, RecordedCaller, RecordedServer
from autograder.judge.bench.recorded_topics import LogReader, RecordedPublisher, RecordedSubscription
from autograder.judge.bench.recorder import Place, Recorder
from autograder.judge.bench.ros_interfaces import MisfitError, expected_hashes, served_hashes, service_fields
from autograder.judge.bench.subject_presence import GRAPH_POLL, MATCH, Presence
from autograder.judge.bench.subject_time import SubjectTime, silent
from autograder.judge.bench.unreadable import UnreadableSubject
from autograder.judge.machine_fitness import JudgeFailed
from autograder.kit.bench import STEP, Pace
from autograder.kit.counterparts import Qos
from autograder.kit.evidence import INTERRUPTED, Evidence, Part, Reference
from autograder.kit.giving_up import patience

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from random import Random

    from autograder.judge.subject import Subject
    from autograder.kit.counterparts import Work

INPUTS = frozenset(
    {"sent", "asked", "response", "goal_sent", "cancel_sent", "goal_answered", "feedback", "result"}
)
"""The kinds of events with which the judge gives the subject something to do."""
WORKS = frozenset(
    {"message", "answered", "request", "goal", "goal_answer", "feedback_heard", "cancel", "cancel_answer"}
    | {"result_request", "result_heard", "log", "output"}
)
"""The kinds of events that show that the subject works."""
GRAPH_LOOK = 0.02
"""Seconds between two queries of the graph whose results are recorded."""
PACED_STEP = 0.1
"""Seconds of the subject's simulated time that pass at once while the judge waits for something in wall time."""
_T = TypeVar("_T")
_Client = TypeVar("_Client", RecordedCaller, RecordedActionClient)


class Confirmed(Exception):
    """The look in real time goes as the first one went."""


class TestBench:
    """Implements :class:`autograder.kit.bench.Bench` on real ROS. Its methods are documented there.

    Attributes:
        in_a_cell: True if the subject runs in a notebook's kernel.
        is_waited_for: True if a student waits for the check's card.
        begin_run: Called at the beginning of each run, with the finished parts.
        parts: The finished parts, in order.
        doubtful: True if an observation in a fast look must be confirmed in real time.
        unmet: True if a run began although the subject's participant had not reported that it discovered the judge's
            endpoints.
    """

    __test__ = False  # not a pytest class

    def __init__(
        self,
        subject: Subject,
        domain_id: int,
        reference: Reference,
        pace: Pace,
        random: Random,
        before: Evidence | None = None,
        hurry: Callable[[], None] = lambda: None,
        misnamed: Mapping[str, Mapping[str, str]] | None = None,
    ) -> None:
        self._misnamed = misnamed or {}
        """Misnamed endpoints. The keys are the names in the task; ``real`` is the name that the subject uses."""
        self.pace = pace
        self.random = random
        self.reference = reference
        self.in_a_cell = subject.shares_participant
        self.is_waited_for = False
        self.begin_run: Callable[[Sequence[Part]], None] = lambda _: None
        self.parts: list[Part] = []
        self.doubtful = False
        self.unmet = False
        self.before = before
        self._subject = subject
        self._domain_id = domain_id
        self._hurry = hurry
        self._recorder = Recorder(hurry=hurry)
        self._participant: Wire | None = None
        self._decoys: DecoyNodes | None = None
        # Announcements show that a program has made a node. For a notebook they would show nothing, because its kernel
        # announces one participant for all runs.
        self._announcements = None if subject.shares_participant else Announcements(domain_id)
        self._older_processes: set[bytes] = set()
        self._open = contextlib.ExitStack()
        self._servers: list[RecordedServer | RecordedActionServer] = []
        self._on_graph: Presence | None = None
        self._time_of_part: SubjectTime | None = None
        self._there: set[discovery.Endpoint] = set()
        self._gone: set[discovery.Endpoint] = set()
        self._clean = True
        self._in_part = False

    def part(self, name: str, **inputs: Any) -> None:
        self.stop()
        self.begin_run(self.parts)
        self._recorder = recorder = Recorder(name, inputs, self._hurry)
        for asked, facts in self._misnamed.items():
            self._recorder.record("misnamed", asked, **facts)
        self._in_part = True
        if self._participant is None or not (self._subject.shares_participant and self._clean):
            self._close_wire()
            self._participant, self._decoys = Wire(self._domain_id), DecoyNodes(self._domain_id)
            # Each participant of the judge gets one log reader for all parts, because a new reader would receive the
            # log lines of earlier parts again.
            self._log = LogReader(self._participant, lambda: self._recorder)
            self._subject.renew()
        recorder.take_in = self._participant.take_in
        self._on_graph = Presence(
            self._participant.node, self._recorder, self._subject, self.pace, self._has_announced_itself
        )
        self._time_of_part = SubjectTime(self._participant, self._on_graph, self._open, self.doubt)

    def again(self, name: str = "") -> None:
        self.stop()
        dropped = next(part for part in reversed(self.parts) if name in ("", part.name))
        self.parts.remove(dropped)
        self.part(dropped.name, **dropped.inputs)

    def leave_out(self, name: str) -> None:
        self.stop()
        self.parts = [part for part in self.parts if part.name != name]

    def keep(self, name: str) -> bool:
        known = self.before.part(name) if self.before else Part(name)
        if known.ending is None or patience(known) is not None:  # how long it waits depends on the pace
            return False
        self.stop()
        self.parts.append(known)
        return True

    def stop(self) -> None:
        """End the part: record the subject's last state, stop the subject, and remove the judge's endpoints."""
        if not self._in_part:
            return
        self._in_part = False
        with self.noting_what_is_unreadable():
            if self._is_silent():
                self._ask(self._presence.nodes())
            self._presence.note_last_state()
            self._presence.note_short_life()
        # After Ctrl-C, the old endpoints of the subject may stay on the graph for a while. So the judge uses a new
        # participant in the next part, because a new participant never discovers them.
        self._clean = self._subject.ended and not self._recorder.part().of("subject", INTERRUPTED)
        self.parts.append(self._recorder.part())
        self._subject.stop()
        self._open.close()
        self._servers.clear()
        self._gone, self._there = self._gone | self._there, set()
        if self._decoys is not None:
            self._decoys.clear()
        if isinstance(self._wire.failure, MisfitError):
            raise self._wire.failure  # an answer that the exercise gives
        if self._wire.failure is not None:
            raise JudgeFailed(f"the judge's own node failed: {self._wire.failure!r}")

    @contextlib.contextmanager
    def noting_what_is_unreadable(self) -> Iterator[None]:
        """End the block as soon as the subject does what no judge can read, and record that."""
        try:
            yield
        except UnreadableSubject as error:
            self._recorder.record("unreadable", error.why)

    def close(self) -> None:
        """Stop the subject and remove everything from the graph. A call is allowed at any time."""
        try:
            self.stop()
        finally:
            self._close_wire()
            if self._announcements is not None:
                self._announcements.close()

    def _close_wire(self) -> None:
        if self._participant is not None and self._decoys is not None:
            self._decoys.close()
            self._participant.close()
            self._participant = self._decoys = None
            # The endpoints disappear together with the judge's participant, so the next subject cannot discover them.
            self._gone = set()

    @property
    def _wire(self) -> Wire:
        """The judge's DDS participant in this part of the check."""
        return _of_a_part(self._participant)

    @property
    def _presence(self) -> Presence:
        return _of_a_part(self._on_graph)

    @property
    def _time(self) -> SubjectTime:
        return _of_a_part(self._time_of_part)

    def start(self, *arguments: Any, **options: Any) -> None:
        # Before the start, wait until the subject's process knows which endpoints the judge has added and removed.
        if (self._there or self._gone) and not self._subject.knows(there=self._there, gone=self._gone):
            self.unmet = True
        if self._announcements is not None:
            self._older_processes = {process_of(self._wire.node), *self._announcements.heard()}
        self._subject.start(self._recorder, arguments, options)

    def _has_announced_itself(self) -> bool:
        """Return True if a process that did not exist before the subject's start has made a node."""
        return self._announcements is not None and bool(self._announcements.heard() - self._older_processes)

    def release(self) -> None:
        self._subject.release()

    def press_ctrl_c(self, within: float) -> bool:
        if self._subject.ended:
            return False
        self._presence.note_last_state()
        if self._subject.ended:
            return False
        self._recorder.record("subject", INTERRUPTED)
        self._subject.interrupt()
        return self.await_end(within)

    def await_end(self, within: float) -> bool:
        return self._recorder.wait(lambda: self._subject.ended, within)

    def await_endpoint(self, role: str, name: str) -> bool:
        at = self._real(name)
        there = self._presence.await_endpoint(role, at)
        if there or not self._subject.may_make_more:
            return there
        self.release()
        return self._presence.await_endpoint(role, at)

    def _real(self, name: str) -> str:
        """Return the name that the subject uses for the endpoint that the task calls ``name``."""
        return self._misnamed[name]["real"] if name in self._misnamed else name

    def await_node(self) -> bool:
        return self._presence.await_node()

    def await_sign_of_life(self, within: float) -> bool:
        return self._presence.await_sign_of_life(within)

    def await_any_endpoint(self, roles: tuple[str, ...]) -> discovery.Interface:
        """Wait until the subject has an endpoint of one of these roles. Return all its endpoints at that time."""
        return self._presence.await_interface(lambda interface: any(interface[role] for role in roles))

    def watch_graph(self, condition: Callable[[Evidence], bool], within: float) -> bool:
        def look() -> Evidence:
            self._presence.note_interface()
            return self._evidence()

        return self._wait_for(condition, look, within, poll=GRAPH_LOOK)

    def _evidence(self) -> Evidence:
        return Evidence([self._recorder.part()], self.reference, self.pace is Pace.REAL_TIME)

    def listen(self, topic: str, type_name: str, *, qos: Qos = Qos.DEFAULT) -> None:
        place = self._place(topic, type_name)
        self._presence.subscriptions[place.at] = subscription = RecordedSubscription(place, qos)
        self._open.callback(self._wire.node.destroy_subscription, subscription.subscription)

    def note(self, name: str, **data: Any) -> None:
        self._recorder.record("noted", name, **data)

    def seen(self) -> Part:
        return self._recorder.part()

    def heard(self, topic: str) -> int:
        return len(self._recorder.part().of("message", topic))

    def speak(self, topic: str, type_name: str, *, qos: Qos = Qos.DEFAULT) -> RecordedPublisher:
        place = self._place(topic, type_name)
        self._presence.publishers[place.at] = publisher = RecordedPublisher(place, qos)
        self._open.callback(self._wire.node.destroy_publisher, publisher.publisher)
        return publisher

    def plant(
        self,
        name: str,
        *,
        publishes: Mapping[str, str],
        subscribes: Mapping[str, str],
        qos: Qos = Qos.DEFAULT,
    ) -> None:
        assert self._decoys is not None
        self._there |= self._decoys.plant(name, publishes=publishes, subscribes=subscribes, qos=qos)

    def serve(self, service: str, type_name: str, answer: Answer, **how: Any) -> RecordedServer:
        self._get_ready_to_serve(service)
        server = RecordedServer(self._place(service, type_name), answer, **how)
        self._servers.append(server)
        self._open.callback(server.close)
        self._announce(server.services)
        return server

    def _place(self, name: str, type_name: str) -> Place:
        return Place(self._wire, self._recorder, name, type_name, self._real(name))

    def call(self, service: str, type_name: str) -> RecordedCaller:
        return self._client(RecordedCaller, service, type_name)

    def call_action(self, action: str, type_name: str) -> RecordedActionClient:
        return self._client(RecordedActionClient, action, type_name)

    def _client(self, kind: type[_Client], name: str, type_name: str) -> _Client:
        client = kind(self._place(name, type_name), lambda: self._subject.ended)
        self._open.callback(client.close)
        return client

    def serve_action(self, action: str, type_name: str, **how: Any) -> ScriptedActionServer:
        self._get_ready_to_serve(action)
        place = self._place(action, type_name)
        server = ScriptedActionServer(place, lambda: self._subject.ended, **how)
        self._open.callback(server.close)
        self._announce(server.services)
        return server

    def serve_goals(self, action: str, type_name: str, work: Callable[[Mapping[str, Any]], Work]) -> None:
        self._get_ready_to_serve(action)
        server = RecordedActionServer(self._place(action, type_name), work)
        self._servers.append(server)
        self._open.callback(server.close)
        self._announce(server.services)

    def _get_ready_to_serve(self, name: str) -> None:
        """Wait until the existing clients are discovered, then record the event ``serving``.

        Without this wait, an existing client would get no answer, because a service cannot answer a client that it has
        not discovered.
        """
        self._recorder.take_in()
        self._recorder.record("serving", name)

    def _announce(self, services: Iterable[str]) -> None:
        # Subtract removed endpoints, because the judge's participant may still see them.
        self._there |= discovery.server_endpoints(self._wire.node, services) - self._gone

    def run_time(
        self,
        seconds: float,
        *,
        until: Callable[[], bool] | None = None,
        quiet: float | None = None,
        step: float = STEP,
    ) -> bool:
        def until_then() -> bool:
            for server in self._servers:
                server.answer_due()
            return until is not None and until()

        return self._time.run(seconds, until=until_then, quiet=quiet, step=step)

    def pass_time(self, seconds: float, role: str, name: str) -> None:
        self._time.lend(seconds, role, self._real(name))

    def let_wait(self, seconds: float) -> None:
        self._recorder.wait(lambda: self._subject.ended, seconds, wall=True)

    def settle(self) -> None:
        self._time.settle()

    def take_in(self) -> None:
        self._recorder.take_in()

    @property
    def moment(self) -> float:
        return self._recorder.moment

    def await_attention(self) -> None:
        self._time.await_attention()

    def confirm(self) -> None:
        raise Confirmed

    def doubt(self) -> None:
        self.doubtful = True

    def note_whether_it_spins(self) -> None:
        nodes = self._presence.counterparts()
        if not nodes:
            # A program that has destroyed its nodes is about to end, so wait for its end: the exit code and the last
            # lines of output tell more than missing answers.
            self.await_end(MATCH)
        self._ask(nodes)

    def _ask(self, nodes: Iterable[discovery.NodeName]) -> None:
        """Record which of the nodes do not answer, and the lines at which the subject hangs."""
        mute = [] if self._subject.ended else silent(self._wire, self._recorder, list(nodes))
        for node in mute:
            self._recorder.record("unanswered", node.full)
        if mute:
            self.note_where_it_hangs()

    def _is_silent(self) -> bool:
        """Return True if a subject that runs has done nothing since the judge's last input, and was not asked why."""
        if self._subject.ended or self._subject.is_held:
            return False
        kinds = [event.kind for event in reversed(self._recorder.part().events)]
        since = list(itertools.takewhile(lambda kind: kind not in INPUTS, kinds))
        return not {*since} & WORKS and not {*kinds} & {"unanswered", "stack"}

    def note_where_it_hangs(self) -> None:
        if not self._subject.ended:
            self._presence.note_interface()
            text = self._subject.stack()
            self._recorder.record("stack", "subject", text=text, busy=self._subject.busy)

    def wait_until(
        self,
        condition: Callable[[Evidence], bool],
        within: float,
        *,
        quiet: float | None = None,
        paced: bool = False,
    ) -> bool:
        last, poll = time.monotonic(), PACED_STEP if paced else 0.5

        def look() -> Evidence:
            nonlocal last
            passed = time.monotonic() - last
            if paced and self._time.is_simulated and passed >= PACED_STEP:
                last += passed
                self.run_time(min(passed, PACED_STEP))
            return self._evidence()

        return self._wait_for(condition, look, within, quiet=quiet, poll=poll)

    @property
    def _is_lost(self) -> bool:
        # A subject whose executor stopped in simulated time does not go on; the second look is in real time.
        return self._time_of_part is not None and self._time_of_part.is_lost

    def _wait_for(
        self, condition: Callable[[Evidence], bool], look: Callable[[], Evidence], within: float, **how: Any
    ) -> bool:
        """Wait until a condition holds or the subject has ended. Return what the condition last returned."""
        held = False

        def over() -> bool:
            nonlocal held
            # Ask whether the subject has ended before reading the evidence, so that the evidence contains everything
            # from before the end.
            ended = self._subject.ended
            held = condition(look())
            return held or ended or self._is_lost

        self._recorder.wait(over, within, **how)
        return held

    def compare_type(self, service: str, like: str) -> None:
        at = self._real(service)
        made = discovery.survey(self._wire.node)["service"].get(at, "")
        expected = expected_hashes(like, made.partition("/")[0])
        seen: dict[str, str] = {}

        def hashes_known() -> bool:
            seen.update(served_hashes(self._wire.node, at))
            return len(seen) == len(expected) or self._subject.ended

        self._recorder.wait(hashes_known, MATCH, poll=GRAPH_POLL)
        self._recorder.record("type", service, type=made, same=seen == expected, fields=service_fields(like))

    def note_its_log(self) -> None:
        for text in dict.fromkeys(event.data["text"] for event in self._recorder.part().of("log")):
            self._recorder.record("said", "log", text=text)


def _of_a_part(made: _T | None) -> _T:
    """Return ``made``. Raise an error if ``made`` is None because the scenario has not begun a part."""
    if made is None:
        raise RuntimeError("a scenario begins with bench.part(...)")
    return made
