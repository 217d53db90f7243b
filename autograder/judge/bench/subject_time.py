"""Lets time pass for the subject: simulated time if the subject follows the judge's clock, otherwise wall time.

In simulated time the judge publishes ``/clock`` in steps, so that seconds take milliseconds. After each step, the judge
sends requests to the subject's parameter service. The answers prove that the subject's executor has called the timers
of this step, so the result does not depend on how busy the machine is. Some subjects do not follow the clock, because
they call ``time.sleep`` or spin only sometimes. The judge notices this if the subject publishes while the clock stands
still, or if its executor answers slowly, and then looks again in real time.
"""

from __future__ import annotations

import contextlib
import itertools
import threading
import time
from functools import partial
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock

from autograder.judge.bench import discovery
from autograder.judge.bench.subject_presence import MATCH, Presence
from autograder.judge.machine_fitness import Patience
from autograder.kit.bench import STEP, Pace

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.judge.bench.discovery import NodeName
    from autograder.judge.bench.judge_nodes import Wire
    from autograder.judge.bench.recorder import Recorder

ANSWER_LIMIT = 0.5
"""Time limit in seconds of wall time for a spinning node to answer. Simulated time is not used for a node that does not
answer.
"""
PATIENT_ANSWER = 1.5
"""Time limit in seconds of wall time for an answer. A node that has not answered by then counts as not spun."""
TURNS = 3
"""The number of rounds of an executor after which it has called the timers that are due at a new time.

An executor receives the time in one round and calls the timers in the next. But a round may handle only the request: if
the executor checks its subscriptions just before the time arrives, and its services just after the request has arrived.
Then a third round is needed.
"""
FIRST = 100.0
"""The simulated time at the start, in seconds. The jump to this time distorts the first interval, which is therefore
not counted.
"""
SLOW_STEP = 0.25
"""Time limit in seconds of wall time for a step. A longer step is suspicious: the subject sleeps, or the machine is
overloaded.
"""
STANDSTILL = 0.06
"""Seconds of wall time for which the clock stands still before the first step."""
LENT_STEP = 0.1
"""The length of a step in :meth:`NodeClock.lend`, in simulated seconds. A timer with a shorter period fires once a
step, less often than in real time.
"""
_SIM_TIME = "use_sim_time"
_QUESTION = GetParameters.Request()
"""The question for no parameter at all, which costs both sides least."""


class Unanswered(Exception):
    """No node of the subject answers in a fast look. The look in real time has to tell whether they are only slow."""


class NodeClock:
    """Publishes ``/clock`` for nodes of the subject, and checks whether each of them keeps up.

    An answer from the node's parameter service proves that the node's executor has made a round since the request. An
    executor takes only one request of a service in each round (rclpy/executors.py, ``_take_service``). So the answers
    to three requests that are sent together prove three rounds.

    Attributes:
        nodes: The nodes of the subject that follow the clock.
    """

    def __init__(self, wire: Wire, recorder: Recorder, *nodes: NodeName) -> None:
        self.nodes = nodes
        self._wire = wire
        self._recorder = recorder
        self._publisher = wire.node.create_publisher(Clock, "/clock", QoSProfile(depth=10))
        self._set, self._get = (
            [wire.client(kind, f"{node.full}/{name}") for node in nodes]
            for kind, name in ((SetParameters, "set_parameters"), (GetParameters, "get_parameters"))
        )

    def follow(self, simulated: bool) -> bool:
        """Tell the nodes to follow simulated time, or real time again. Return True if all have accepted this."""
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=simulated)
        request = SetParameters.Request(parameters=[Parameter(name=_SIM_TIME, value=value)])
        told = _ask(self._wire, self._recorder, self._set, request, ANSWER_LIMIT)
        return all(answer and answer.results and answer.results[0].successful for answer in told)

    def is_heard(self) -> bool:
        """Wait until the clock has a subscriber for each node. Return True if it has."""
        return self._recorder.wait(
            lambda: self._publisher.get_subscription_count() >= len(self._get), ANSWER_LIMIT, poll=0.002
        )

    def show(self, now: float) -> bool:
        """Publish the time, in seconds. Return True if each node's executor has called the timers that are due."""
        message = Clock()
        message.clock.sec = int(now)
        message.clock.nanosec = round((now - int(now)) * 1e9)
        self._publisher.publish(message)
        return self.keeps_up()

    def keeps_up(self) -> bool:
        """Return True if the nodes' executors make as many rounds as they need to handle what has arrived."""
        return None not in _ask(self._wire, self._recorder, self._get, _QUESTION, ANSWER_LIMIT, turns=TURNS)

    def lend(self, seconds: float, until: Callable[[], bool]) -> bool:
        """Make a node that runs in real time follow a simulated clock for some seconds, so that its timers fire sooner.

        This shows within milliseconds what a program's timers would do in the next seconds. The simulated clock begins
        at the current time, and the node returns to real time at the end, so nothing that the node has begun is lost.
        But code that uses no ROS clock, such as a thread that sleeps, does not get faster.

        Args:
            seconds: The maximum number of simulated seconds.
            until: Stop earlier if this function returns True.

        Returns:
            True if the node accepted the clock and answered after each step.
        """
        began = time.time()
        try:
            if not (self.follow(True) and self.is_heard() and self.show(began)):
                return False
            steps = range(1, round(seconds / LENT_STEP) + 1)
            return all(until() or self.show(began + LENT_STEP * step) for step in steps)
        finally:
            self.follow(False)

    def close(self) -> None:
        self._wire.node.destroy_publisher(self._publisher)
        for client in (*self._set, *self._get):
            self._wire.node.destroy_client(client)


def _ask(
    wire: Wire, recorder: Recorder, clients: Sequence[Any], request: Any, limit: float, *, turns: int = 1
) -> list[Any]:
    """Ask services of the subject at once. Return the answer of each; None if its executor does not answer in time.

    Args:
        recorder: The record of the part. At each new event, this function looks whether the services are there.
        limit: Time limit in seconds for the services to appear, and again for each answer.
        turns: The number of executor rounds to wait for: the request is sent this many times at once, and the last
            answer counts.
    """
    recorder.wait(lambda: all(client.service_is_ready() for client in clients), limit, poll=0.005)
    answers: dict[int, list[Any]] = {
        number: [] for number, client in enumerate(clients) if client.service_is_ready()
    }
    number_of_answers, all_came = itertools.count(1), threading.Event()

    def take(number: int, answer: Any) -> None:
        answers[number].append(answer)
        if next(number_of_answers) == turns * len(answers):
            all_came.set()

    for number in answers:
        for _ in range(turns):
            wire.executor.ask(clients[number], request, partial(take, number))
    patience, before = Patience(limit), 0
    while answers and not all_came.wait(max(0.0, patience.left)):
        count = sum(map(len, answers.values()))
        if count > before:
            patience.restart()
        elif patience.left <= 0:
            break
        before = count
    return [came[-1] if len(came := answers.get(n, [])) == turns else None for n in range(len(clients))]


def silent(
    wire: Wire, recorder: Recorder, nodes: Sequence[NodeName], limit: float = PATIENT_ANSWER
) -> list[NodeName]:
    """Return the nodes that do not answer a request for a parameter in time. Every node that is spun can answer."""
    clients = [_new_client(wire, node) for node in nodes]
    try:
        told = _ask(wire, recorder, clients, _QUESTION, limit)
        return [node for node, answer in zip(nodes, told, strict=True) if answer is None]
    finally:
        for client in clients:
            wire.node.destroy_client(client)


def _new_client(wire: Wire, node: NodeName) -> Any:
    return wire.client(GetParameters, f"{node.full}/get_parameters")


class SimulatedClock(NodeClock):
    """A simulated clock that moves in steps, for nodes of the subject.

    Attributes:
        nodes: The nodes of the subject that follow the clock.
        doubtful: True if the result must be confirmed in real time, because a step took too long or another node
            moved the clock.
    """

    def __init__(self, wire: Wire, recorder: Recorder, *nodes: NodeName) -> None:
        super().__init__(wire, recorder, *nodes)
        self.doubtful = False
        self._now = FIRST

    def take_over(self) -> bool:
        """Make the nodes follow simulated time.

        Returns:
            True if each node accepted, receives the clock, and answers. This does not yet prove that the nodes' timers
            follow the clock; :meth:`stands_still` proves it.
        """
        if not (self.follow(True) and self.is_heard()):
            return False
        self._recorder.simulated_now = self._now
        return self.show(self._now)

    def stands_still(self, silent: Callable[[], bool]) -> bool:
        """Keep the clock still for a moment. Return True if the subject stays silent meanwhile.

        Args:
            silent: Returns True as long as the subject has published no further message.
        """
        self._recorder.wait(lambda: not silent(), STANDSTILL)
        return silent()

    def run(self, seconds: float, until: Callable[[], bool], step: float = STEP) -> bool:
        """Let ``seconds`` of simulated time pass in steps of ``step`` seconds; stop earlier if ``until`` holds.

        Returns:
            True if the subject's executor answered after each step.
        """
        # Round the end as each step is rounded. Otherwise the end, a floating-point sum, could be slightly later than
        # the last step, and the loop would make one step too many.
        end = round(self._now + seconds, 6)
        while self._now < end and not until():
            began = time.monotonic()
            self._now = round(min(self._now + step, end), 6)
            self._recorder.simulated_now = self._now
            if not self.show(self._now):
                self.doubtful = True
                return False
            slow = time.monotonic() - began > SLOW_STEP
            # If another node moves the clock as well, simulated time proves nothing about the subject's rate.
            is_rivaled = self._wire.node.count_publishers("/clock") > 1
            self.doubtful = self.doubtful or slow or is_rivaled
        return True

    def close(self) -> None:
        self._recorder.simulated_now = None
        super().close()


class SubjectTime:
    """Lets time pass for the subject, in simulated time if possible, and checks whether its nodes keep up.

    Args:
        wire: The judge's participant.
        presence: Finds the subject's nodes on the graph.
        opened: The stack of everything that is closed at the end of the part. The clock is added to it.
        doubt: Called if an observation must be confirmed in real time.
    """

    def __init__(
        self, wire: Wire, presence: Presence, opened: contextlib.ExitStack, doubt: Callable[[], None]
    ) -> None:
        self._wire, self._presence, self._open, self._doubt = wire, presence, opened, doubt
        self._recorder, self._subject, self._pace = presence.recorder, presence.subject, presence.pace
        self._clock: SimulatedClock | None = None
        self._clock_refused = False
        self.is_lost = False
        """True if the subject's executor has stopped answering in simulated time. Then no more time passes for it."""
        self._deaf: set[str] = set()
        self._clients: dict[NodeName, Any] = {}

    def run(
        self,
        seconds: float,
        *,
        until: Callable[[], bool] | None = None,
        quiet: float | None = None,
        step: float = STEP,
    ) -> bool:
        """Let ``seconds`` pass for the subject; stop earlier if ``until`` holds or the subject has ended.

        In real time, also stop if nothing was recorded for ``quiet`` seconds.

        Returns:
            False if simulated time could not go on because the subject's executor no longer answers.
        """
        over = until or (lambda: False)
        if self.is_lost:
            return False
        if self._pace is Pace.FAST and self._follow_clock():
            assert self._clock is not None
            turns = self._clock.run(seconds, lambda: over() or self._subject.ended, step)
            if self._clock.doubtful:
                self._doubt()
            self.is_lost = not turns
            return turns
        self._recorder.wait(lambda: over() or self._subject.ended, seconds, quiet=quiet, wall=True)
        return True

    @property
    def is_simulated(self) -> bool:
        """True if the subject's time is simulated and its executor still answers."""
        return self._pace is Pace.FAST and not self.is_lost and self._follow_clock()

    def lend(self, seconds: float, role: str, name: str) -> None:
        """Lend a simulated clock to the node with this endpoint, so that its timers fire sooner.

        See :meth:`NodeClock.lend`. If the node does not accept the clock, wait ``seconds`` of real time instead.
        """
        for node in discovery.owners(self._wire.node, role, name):
            if node.full not in self._deaf:
                with contextlib.closing(NodeClock(self._wire, self._recorder, node)) as clock:
                    if clock.lend(seconds, lambda: self._subject.ended):
                        return
        self._recorder.wait(lambda: self._subject.ended, seconds, wall=True)

    def settle(self) -> None:
        """Wait until the subject has handled the messages that it received, and the judge has recorded its own.

        Each node has to answer two requests, one after the other, so that its executor has made a whole round in
        between. A node that failed to answer before, in this part, is left out. If a node that follows the judge's
        clock is slow, real time has to tell whether its callback sleeps: in simulated time, that would cost nothing.
        """
        limit = ANSWER_LIMIT if self._pace is Pace.FAST else PATIENT_ANSWER
        nodes = [] if self._subject.ended else self._presence.counterparts()
        clocked = {node.full for node in nodes if self._clock is not None and node in self._clock.nodes}
        if self._clock is not None and clocked - self._deaf:
            began = time.monotonic()
            if not self._clock.keeps_up():
                self._deaf |= clocked
            if time.monotonic() - began > SLOW_STEP:
                self._doubt()
        for _ in range(2):
            asked = [node for node in nodes if node.full not in self._deaf | clocked]
            clients = [self._client_of(node) for node in asked]
            told = _ask(self._wire, self._recorder, clients, _QUESTION, limit)
            self._deaf |= {node.full for node, answer in zip(asked, told, strict=True) if answer is None}
        self._recorder.take_in()

    def _client_of(self, node: NodeName) -> Any:
        """Return a client that asks a node. It is kept for the part, because a new client is connected slowly."""
        if node not in self._clients:
            self._clients[node] = client = _new_client(self._wire, node)
            self._open.callback(self._wire.node.destroy_client, client)
        return self._clients[node]

    def await_attention(self) -> None:
        """Wait until each node that the judge is matched with has discovered the judge's publishers.

        For this, the judge sends each node a request from a new client. The judge's announcements arrive in order
        (DDSI-RTPS, 8.5.4), so a node that can answer the new client has discovered the older publishers, too.

        Raises:
            Unanswered: This is a fast look, and no node answers.
        """
        is_fast = self._pace is Pace.FAST
        limit = PATIENT_ANSWER if is_fast else MATCH
        nodes = [] if self._subject.ended else self._presence.counterparts()
        mute = silent(self._wire, self._recorder, nodes, limit)
        if is_fast and mute and len(mute) == len(nodes) and not self._subject.ended:
            for node in mute:
                self._recorder.record("unanswered", node.full)
            raise Unanswered

    def _follow_clock(self) -> bool:
        """Make the subject follow the judge's simulated clock, if possible. Return True if it follows.

        The judge tries this only once, in the first call after it has made a publisher or a subscription.
        """
        tried = self._clock is not None or self._clock_refused
        if not tried and (self._presence.subscriptions or self._presence.publishers):
            self._clock_refused = True
            self._clock = self._clock_taken_over()
        return self._clock is not None

    def _clock_taken_over(self) -> SimulatedClock | None:
        """Return a clock that the subject follows; None if the subject has no node, or does not follow the clock."""
        if any(self._wire.node.count_publishers(topic) > 1 for topic in self._presence.subscriptions):
            # Do not use simulated time for several publishers. They may belong to nodes with the same name, whose
            # parameter services have the same names, too. Then one of the nodes would stay in real time.
            self._doubt()
            return None
        nodes = self._presence.counterparts()
        if not nodes:
            return None
        stepped = SimulatedClock(self._wire, self._recorder, *nodes)
        self._open.callback(stepped.close)
        if stepped.take_over() and stepped.stands_still(self._silence(len(nodes))):
            return stepped
        # The subject may still switch to simulated time later. Its timers would then stand still, because the judge
        # does not step the clock. So only a new run in real time can decide.
        self._recorder.simulated_now = None
        if self._presence.subscriptions:
            self._doubt()
        return None

    def _silence(self, nodes: int) -> Callable[[], bool]:
        """Return a function that returns True as long as no further message is heard."""

        def heard() -> int:
            seen = self._recorder.part()
            return sum(len(seen.of("message", topic)) for topic in self._presence.subscriptions)

        before = heard()
        # One message of each node is allowed, because it may have been on its way when the clock stopped.
        return lambda: heard() <= before + nodes
