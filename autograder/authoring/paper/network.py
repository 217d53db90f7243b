"""The graph, the clocks and the threads of one run on paper: a simulated clock moves them, and no network exists."""

from __future__ import annotations

import heapq
import inspect
import itertools
import threading
from collections import deque
from functools import partial
from typing import TYPE_CHECKING, Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from autograder.authoring.paper.endpoints import PaperTimer, Publisher

    Answer = Callable[[Any], None]
    """Takes the response of a service."""

SECOND = 1_000_000_000
"""Nanoseconds in a second. All times on paper are whole nanoseconds, as in rclpy."""
EPOCH = 1_800_000_000 * SECOND
"""The time of the computer's clock at the beginning, which only has to be far from simulated time."""
NEVER = 2**62
"""A time that never comes."""
SETTLED = 0.02
"""Seconds of wall time after which a thread that does not report counts as blocked."""


class Hangs(BaseException):
    """The program waits in its only executor for something that only this executor could bring."""


class UnknownOnPaper(BaseException):
    """The program uses something of rclpy that paper does not have."""


class Threads:
    """The threads that a program starts. The bench goes on only when each of them has ended or waits."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._running = 0

    def settle(self) -> None:
        """Wait until no thread of the program runs."""
        with self._changed:
            self._changed.wait_for(lambda: not self._running, SETTLED)

    def began(self, more: int) -> None:
        """Count a thread that runs now (1), or that waits or has ended (-1)."""
        with self._changed:
            self._running += more
            self._changed.notify_all()

    def wait_for(self, ask: Callable[[Answer], None]) -> Any:
        """Block the calling thread until a question is answered. Return the answer."""
        answered, answers = threading.Event(), []

        def take(answer: Any) -> None:
            answers.append(answer)
            self.began(1)
            answered.set()

        ask(take)
        self.began(-1)
        answered.wait()
        return answers[0]


class Network:
    """The graph, the two clocks and everything that is due, for all nodes of one run.

    Attributes:
        nodes: The nodes, in the order in which they were made.
        served: For each service that the bench serves, the function that takes a request and a function for its answer.
        actions: For each action that the bench serves, the function that takes a goal and a function for its feedback.
        action_clients: The action clients, in the order in which they were made.
        listener: Called with each message: the publisher, the message, and its number from this publisher.
        logged: Called with each line that a node logs: the node's name, the level and the text.
        simulated: The simulated time; None before the first step.
        wall: The computer's time.
    """

    now_running: Network

    def __init__(
        self, listener: Callable[[Publisher, Any, int], None], logged: Callable[[str, int, str], None]
    ) -> None:
        self.nodes: list[Any] = []  # of PaperNode, whose endpoints have other types than those of rclpy
        self.served: dict[str, Callable[[Any, Answer], None]] = {}
        self.actions: dict[str, Callable[[Any, Callable[[Any, Any], None]], Any]] = {}
        self.action_clients: list[Any] = []
        self.listener, self.logged = listener, logged
        self.simulated: int | None = None
        self.wall = EPOCH
        self.pending: deque[Callable[[], object]] = deque()
        self._due: list[tuple[int, int, Callable[[], object]]] = []
        self._coroutines: list[Any] = []
        self._numbers = itertools.count()
        self.main = threading.current_thread()
        self.threads = Threads()
        Network.now_running = self

    @property
    def time(self) -> int:
        """The time of the robot's clock: simulated time, or before the first step the computer's."""
        return self.wall if self.simulated is None else self.simulated

    def begin_simulated_time(self, now: int) -> None:
        """Let all nodes follow simulated time. Their timers begin again then, as rclpy's do after such a jump."""
        self.simulated = now
        for timer in self._timers():
            timer.restart()

    def later(self, delay: int, what: Callable[[], object]) -> None:
        """Do something after a delay of the robot's time, in nanoseconds."""
        heapq.heappush(self._due, (self.time + delay, next(self._numbers), what))

    def send_due(self) -> None:
        """Do what is due by now, before the next step begins."""
        while self._due and self._due[0][0] <= self.time:
            heapq.heappop(self._due)[2]()

    @property
    def next_due(self) -> int:
        """The time at which a timer, or something that was to be done later, is due next."""
        return min(
            [due for due, *_ in self._due[:1]] + [timer.next for timer in self._timers()], default=NEVER
        )

    def call(self, callback: Callable[..., Any], *arguments: Any, then: Answer = lambda _: None) -> None:
        """Call a callback of the program; if it is a coroutine, go on with it whenever it can go on."""
        result = callback(*arguments)
        if inspect.iscoroutine(result):
            self._coroutines.append((result, then))
        else:
            then(result)

    def spin(self) -> None:
        """Call everything that is due at this moment, each timer at most once."""
        called: set[int] = set()
        while True:
            self.threads.settle()
            if self.pending:
                self.pending.popleft()()
                continue
            timer = next((one for one in self._timers() if one.is_ready() and id(one) not in called), None)
            if timer is not None:
                called.add(id(timer))
                timer.fire()
            elif not self._some_went_on():
                return

    def _timers(self) -> Iterator[PaperTimer]:
        return (timer for node in self.nodes for timer in list(node.timers))

    def _some_went_on(self) -> bool:
        return any(list(itertools.starmap(self._went_on, list(self._coroutines))))

    def _went_on(self, coroutine: Any, then: Answer) -> bool:
        try:
            coroutine.send(None)
        except StopIteration as end:
            self._coroutines = [one for one in self._coroutines if one[0] is not coroutine]
            then(end.value)
            return True
        return False

    def publish(self, publisher: Publisher, message: Any) -> None:
        """Deliver a message to the bench, and to the subscriptions of the program itself."""
        if not isinstance(message, publisher.kind):
            raise TypeError(f"expected {publisher.kind}, got {type(message)}")
        sent = wired(message)
        publisher.sent.append(sent)
        self.listener(publisher, sent, len(publisher.sent))
        self.deliver(publisher.topic, publisher.profile, sent)

    def deliver(self, topic: str, profile: QoSProfile, message: Any) -> None:
        """Hand a message to all subscriptions that match its publisher."""
        for node in self.nodes:
            for heard in list(node.subscriptions):
                if heard.topic == topic and heard.kind is type(message) and matches(profile, heard.profile):
                    self.pending.append(partial(self.call, heard.callback, wired(message)))


def wired(message: Any) -> Any:
    """Return a message as it arrives: with 32-bit numbers rounded, and with what the wire makes of wrong types."""
    return deserialize_message(serialize_message(message), type(message))


def matches(offered: QoSProfile, asked: QoSProfile) -> bool:
    """Return True if a subscription hears a publisher."""
    unreliable = offered.reliability == ReliabilityPolicy.BEST_EFFORT
    volatile = offered.durability != DurabilityPolicy.TRANSIENT_LOCAL
    return not (unreliable and asked.reliability == ReliabilityPolicy.RELIABLE) and not (
        volatile and asked.durability == DurabilityPolicy.TRANSIENT_LOCAL
    )
