"""Nodes on paper: what rclpy gives to a program, without a network, with a simulated clock that an author's tool moves.

Messages and services are the real classes, and go through real serialization. Parameters are rclpy's own code. Only the
solution and its mutants run like this, never a student's program: executors, stacks and discovery do not exist here.
"""

from __future__ import annotations

import heapq
import inspect
import itertools
import threading
import time
from collections import deque
from functools import partial
from typing import TYPE_CHECKING, Any

import rclpy.clock
import rclpy.node
from rclpy.clock import ClockType
from rclpy.parameter_service import ParameterService
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.task import Future
from rclpy.time import Time

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

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


class Network:
    """The graph, the two clocks and everything that is due, for all nodes of one run.

    Attributes:
        nodes: The nodes, in the order in which they were made.
        served: For each service that the bench serves, the function that takes a request and a function for its answer.
        listener: Called with each message: the publisher and the message.
        logged: Called with each line that a node logs: the node's name, the level and the text.
        simulated: The simulated time; None before the first step.
        wall: The computer's time.
    """

    now_running: Network

    def __init__(
        self, listener: Callable[[Publisher, Any], None], logged: Callable[[str, int, str], None]
    ) -> None:
        self.nodes: list[PaperNode] = []
        self.served: dict[str, Callable[[Any, Answer], None]] = {}
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
            timer = next((one for one in self._timers() if one.is_due and id(one) not in called), None)
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
        self.listener(publisher, sent)
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


def _profile(qos: int | QoSProfile) -> QoSProfile:
    return qos if isinstance(qos, QoSProfile) else QoSProfile(depth=qos)


class Publisher:
    """A publisher of a program."""

    def __init__(self, kind: Any, topic: str, profile: QoSProfile) -> None:
        self.kind, self.topic, self.profile = kind, topic, profile
        self.topic_name, self.msg_type, self.qos_profile = topic, kind, profile
        self.sent: list[Any] = []

    def publish(self, message: Any) -> None:
        """Publish a message."""
        Network.now_running.publish(self, message)

    def get_subscription_count(self) -> int:
        """Return 1: the bench listens."""
        return 1


class Subscription:
    """A subscription of a program."""

    def __init__(self, kind: Any, topic: str, callback: Callable[..., Any], profile: QoSProfile) -> None:
        self.kind, self.topic, self.callback, self.profile = kind, topic, callback, profile
        self.topic_name, self.msg_type, self.qos_profile = topic, kind, profile


class Service:
    """A service of a program."""

    def __init__(self, kind: Any, name: str, callback: Callable[..., Any]) -> None:
        self.kind, self.name, self.callback = kind, name, callback
        self.srv_name, self.srv_type = name, kind

    def answer(self, request: Any, answered: Answer) -> None:
        """Call the callback with a request; ``answered`` gets the response as it arrives."""

        def take(response: Any) -> None:
            if not isinstance(response, self.kind.Response):
                raise TypeError(f"expected {self.kind.Response}, got {type(response)}")
            answered(wired(response))

        Network.now_running.call(self.callback, request, self.kind.Response(), then=take)


class Client:
    """A client of a program. Only services of the bench answer it."""

    def __init__(self, kind: Any, name: str) -> None:
        self.kind, self.name, self.srv_name, self.srv_type = kind, name, name, kind

    def service_is_ready(self) -> bool:
        """Return True if the bench serves this service."""
        return self.name in Network.now_running.served

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Return True if the bench serves this service; otherwise the limit passes."""
        if not self.service_is_ready() and timeout_sec is None:
            raise Hangs
        return self.service_is_ready()

    def call_async(self, request: Any) -> Future:
        """Send a request. Return the future of its answer."""
        future = Future()
        self._ask(request, future.set_result)
        return future

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Send a request, and block this thread until the answer is there."""
        network = Network.now_running
        if threading.current_thread() is network.main:
            if timeout_sec is not None:
                self._ask(request, lambda _: None)
                raise TimeoutError
            raise Hangs
        return network.threads.wait_for(partial(self._ask, request))

    def remove_pending_request(self, future: Future) -> None:
        """Do nothing: the answer of a future that is canceled is not looked at."""

    def _ask(self, request: Any, answered: Answer) -> None:
        if not isinstance(request, self.kind.Request):
            raise TypeError(f"expected {self.kind.Request}, got {type(request)}")
        serve = Network.now_running.served.get(self.name)
        if serve is not None:
            network = Network.now_running

            def take(response: Any) -> None:
                network.pending.append(partial(answered, wired(response)))

            serve(wired(request), take)


class PaperTimer:
    """A timer of a program, which follows the robot's clock as rcl's timers do."""

    def __init__(self, period: float, callback: Callable[[], Any], *, autostart: bool) -> None:
        self.timer_period_ns = int(float(period) * SECOND)
        self.callback = callback
        self._canceled = not autostart
        self._next = Network.now_running.time + self.timer_period_ns

    @property
    def next(self) -> int:
        """The time of the next call."""
        return NEVER if self._canceled else self._next

    @property
    def is_due(self) -> bool:
        """True if the callback has to be called now."""
        return self.next <= Network.now_running.time

    def fire(self) -> None:
        """Call the callback, and set the next time, which skips those that are over."""
        now, period = Network.now_running.time, self.timer_period_ns
        self._next += period
        if self._next < now:
            self._next = now if period == 0 else self._next + period * (1 + (now - self._next - 1) // period)
        Network.now_running.call(self.callback)

    def restart(self) -> None:
        """Let a whole period pass from now on."""
        self._next = Network.now_running.time + self.timer_period_ns

    def cancel(self) -> None:
        """Stop the timer."""
        self._canceled = True

    def reset(self) -> None:
        """Start the timer again, with a whole period."""
        self._canceled = False
        self.restart()

    def is_canceled(self) -> bool:
        """Return True if the timer is stopped."""
        return self._canceled

    def is_ready(self) -> bool:
        """Return True if the callback has to be called now."""
        return self.is_due

    def time_until_next_call(self) -> int | None:
        """Return the nanoseconds until the next call."""
        return None if self._canceled else self._next - Network.now_running.time

    def destroy(self) -> None:
        """Stop the timer for good."""
        self._canceled = True


class RobotClock:
    """The clock of a node."""

    clock_type = ClockType.ROS_TIME

    def now(self) -> Time:
        """Return the robot's time."""
        return Time(nanoseconds=Network.now_running.time, clock_type=ClockType.ROS_TIME)


class ComputerClock:
    """A clock of rclpy that a program makes itself: it does not follow simulated time."""

    def __init__(self, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> None:
        self.clock_type = clock_type

    def now(self) -> Time:
        """Return the computer's time."""
        return Time(nanoseconds=Network.now_running.wall, clock_type=self.clock_type)


class _Logger:
    def __init__(self, name: str) -> None:
        self.name = name
        for level, words in ((10, "debug"), (20, "info"), (30, "warning"), (40, "error"), (50, "fatal")):
            setattr(self, words, partial(self._log, level))
        self.warn = self.warning  # type: ignore[attr-defined]

    def _log(self, level: int, text: object, **_: object) -> bool:
        Network.now_running.logged(self.name, level, str(text))
        return True

    def set_level(self, _: object) -> None:
        """Do nothing: every line is taken."""


class _Unheard:
    def publish(self, _: object) -> None:
        """Do nothing: nobody hears of changed parameters."""


class PaperNode(rclpy.node.Node):
    """A node of a program. Of rclpy's own node, it keeps the parameters, and replaces what needs a network."""

    def __init__(self, node_name: str, **options: Any) -> None:
        options.pop("context", None)
        if unknown := options.keys() - {"namespace", "allow_undeclared_parameters", "use_global_arguments"}:
            raise UnknownOnPaper(f"Node({', '.join(sorted(unknown))}=…)")
        self._name = node_name
        self._namespace = f"/{options.get('namespace', '').strip('/')}".rstrip("/")
        self._publishers, self._subscriptions, self._timers = [], [], []
        self._services, self._clients = [], []
        self._parameters, self._parameter_overrides, self._descriptors = {}, {}, {}
        self._pre_set_parameters_callbacks, self._on_set_parameters_callbacks = [], []
        self._post_set_parameters_callbacks = []
        self._allow_undeclared_parameters = options.get("allow_undeclared_parameters", False)
        self._parameter_event_publisher = _Unheard()  # type: ignore[assignment]
        self._clock, self._logger = RobotClock(), _Logger(node_name)  # type: ignore[assignment]
        Network.now_running.nodes.append(self)
        self._parameter_service = ParameterService(self)

    @property
    def full_name(self) -> str:
        """The name of the node with its namespace."""
        return f"{self._namespace}/{self._name}"

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the full name of a topic."""
        del only_expand
        if topic.startswith("~"):
            return self.full_name + topic[1:]
        return topic if topic.startswith("/") else f"{self._namespace}/{topic}"

    resolve_service_name = resolve_topic_name

    def create_publisher(self, msg_type: Any, topic: str, qos_profile: Any, **_: Any) -> Any:
        """Make a publisher."""
        made = Publisher(msg_type, self.resolve_topic_name(topic), _profile(qos_profile))
        self._publishers.append(made)  # type: ignore[arg-type]
        return made

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, qos_profile: Any, **_: Any
    ) -> Any:
        """Make a subscription."""
        made = Subscription(msg_type, self.resolve_topic_name(topic), callback, _profile(qos_profile))
        self._subscriptions.append(made)  # type: ignore[arg-type]
        return made

    def create_service(self, srv_type: Any, srv_name: str, callback: Any, **_: Any) -> Any:
        """Make a service."""
        made = Service(srv_type, self.resolve_topic_name(srv_name), callback)
        self._services.append(made)  # type: ignore[arg-type]
        return made

    def create_client(self, srv_type: Any, srv_name: str, **_: Any) -> Any:
        """Make a client."""
        made = Client(srv_type, self.resolve_topic_name(srv_name))
        self._clients.append(made)  # type: ignore[arg-type]
        return made

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Any,
        callback_group: Any = None,
        clock: Any = None,
        autostart: bool = True,
    ) -> Any:
        """Make a timer of the robot's clock."""
        del callback_group
        if clock not in (None, self._clock):
            raise UnknownOnPaper("a timer of another clock")
        made = PaperTimer(timer_period_sec, callback, autostart=autostart)
        self._timers.append(made)  # type: ignore[arg-type]
        return made

    def destroy_publisher(self, publisher: Any) -> bool:
        """Remove a publisher."""
        return _removed(self._publishers, publisher)

    def destroy_subscription(self, subscription: Any) -> bool:
        """Remove a subscription."""
        return _removed(self._subscriptions, subscription)

    def destroy_service(self, service: Any) -> bool:
        """Remove a service."""
        return _removed(self._services, service)

    def destroy_client(self, client: Any) -> bool:
        """Remove a client."""
        return _removed(self._clients, client)

    def destroy_timer(self, timer: Any) -> bool:
        """Remove a timer."""
        return _removed(self._timers, timer)

    def destroy_node(self) -> None:
        """Remove everything that the node has."""
        for ends in (
            self._publishers,
            self._subscriptions,
            self._timers,
            self._services,
            self._clients,
        ):
            ends.clear()  # type: ignore[attr-defined]

    def get_clock(self) -> Any:
        """Return the robot's clock."""
        return self._clock

    def get_logger(self) -> Any:
        """Return a logger whose lines the bench gets."""
        return self._logger

    def get_name(self) -> str:
        """Return the name."""
        return self._name

    def get_namespace(self) -> str:
        """Return the namespace."""
        return self._namespace or "/"

    def get_fully_qualified_name(self) -> str:
        """Return the name with its namespace."""
        return self.full_name

    def count_subscribers(self, topic_name: str) -> int:
        """Return 1: the bench listens to every topic."""
        del topic_name
        return 1


def _removed(ends: Any, end: Any) -> bool:
    if end not in ends:
        return False
    ends.remove(end)
    return True


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


class _Thread(threading.Thread):
    """A thread of the program, which says whether it runs."""

    def start(self) -> None:
        Network.now_running.threads.began(1)
        super().start()

    def run(self) -> None:
        threads = Network.now_running.threads
        try:
            super().run()
        finally:
            threads.began(-1)

    def join(self, timeout: float | None = None) -> None:
        here = threading.current_thread()
        if here is Network.now_running.main:
            Network.now_running.threads.settle()
            if self.is_alive():
                raise Hangs
            return
        threads = Network.now_running.threads
        threads.began(-1)
        super().join(timeout)
        threads.began(1)


def _computers_seconds() -> float:
    return Network.now_running.wall / SECOND


def _sleep(seconds: float) -> None:
    if threading.current_thread() is Network.now_running.main:
        Network.now_running.wall += round(seconds * SECOND)
    else:
        threads = Network.now_running.threads
        threads.began(-1)
        threading.Event().wait()  # the computer's time stands still for a thread


def replace_rclpy() -> None:
    """Put nodes, clocks and threads on paper into the places of the real ones, in this process for good.

    Call it in a process that was made for one program.
    """
    rclpy.node.Node = PaperNode  # type: ignore[misc]
    rclpy.clock.Clock = ComputerClock  # type: ignore[assignment,misc]
    threading.Thread = _Thread  # type: ignore[misc]
    time.time = time.monotonic = time.perf_counter = _computers_seconds
    time.time_ns = time.monotonic_ns = lambda: Network.now_running.wall
    time.sleep = _sleep
