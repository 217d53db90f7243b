"""The executor of the judge's node, which takes in one round whatever has arrived.

rclpy's executors take one message of each endpoint in a round, and for each round they make a wait set, for each
message a task and two coroutines. This took a third of a check's processor time.
"""

from __future__ import annotations

import contextlib
import threading
import warnings
from collections import deque
from functools import partial
from typing import TYPE_CHECKING, Any

from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.subscription import Subscription

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node


InvalidHandle = rclpy_implementation.InvalidHandle
"""The error that rclpy raises if an entity is destroyed while another thread uses it."""
LONG_QUEUE = 1000
"""The depth of the judge's longest queues, so that nothing is lost while the judge is slow."""
ATTEMPTS = 30
"""The maximum number of attempts to send an answer. In each attempt the middleware waits about 0.1 s for the client's
reader.
"""


class BatchExecutor:
    """Spins one node, which has no timers, guard conditions or coroutines.

    A round takes one message of each endpoint in turn, until none is left of those that had arrived before the round.
    After that, it does the tasks that were given before the round.

    In place of an empty response, a service's callback gets a function that sends a response, and may call it later.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._guard = GuardCondition(None, None, node.context)
        self._tasks: deque[Callable[[], object]] = deque()
        self._awaited: dict[tuple[Any, int], Callable[[Any], object]] = {}
        self._asking = threading.Lock()
        self._is_outdated = True
        self._has_to_stop = False
        self._watched = contextlib.ExitStack()
        node.executor = self  # type: ignore[assignment]  # from now on, the node calls wake()

    def add_node(self, node: Node) -> bool:
        """Return True: the node calls this when it gets this executor."""
        return node is self._node

    def wake(self) -> None:
        """Watch other endpoints from now on. The node calls this when it has made or destroyed one."""
        self._is_outdated = True
        self._guard.trigger()

    def do(self, task: Callable[[], object]) -> None:
        """Do a task in the spinning thread, when everything that has arrived by now is taken."""
        self._tasks.append(task)
        self._guard.trigger()

    def ask(self, client: Any, request: Any, take: Callable[[Any], object]) -> None:
        """Send a request. The spinning thread calls ``take`` with the answer."""
        with self._asking, client.handle:
            self._awaited[client, client.handle.send_request(request)] = take

    def stop(self) -> None:
        """Have :meth:`spin` return after the current round."""
        self._has_to_stop = True
        self._guard.trigger()

    def spin(self) -> None:
        """Do rounds until :meth:`stop`.

        Raises:
            InvalidHandle: A callback has used an endpoint that another thread has destroyed.
        """
        self._is_outdated = True
        with self._watched:
            while not self._has_to_stop:
                if self._is_outdated:
                    self._watch_endpoints()
                self._do_round()

    def _watch_endpoints(self) -> None:
        """Make a wait set for the endpoints that the node has now. They are not destroyed while they are watched."""
        self._is_outdated = False
        self._watched.close()
        self._take: dict[int, Callable[[], bool]] = {}
        self._events: list[Any] = []
        kinds: dict[str, tuple[list[Any], Callable[[Any], bool]]] = {
            "subscription": (list(self._node.subscriptions), _take_message),
            "client": (list(self._node.clients), self._take_answer),
            "service": (list(self._node.services), _take_request),
        }
        events = list(self._node.waitables)
        sizes = [len(endpoints) for endpoints, _ in kinds.values()]
        context = self._node.context.handle
        self._ready = ready = rclpy_implementation.WaitSet(sizes[0], 1, 0, *sizes[1:], len(events), context)
        self._watched.enter_context(self._guard.handle)
        self._add = [partial(ready.add_guard_condition, self._guard.handle)]
        for kind, (endpoints, take) in kinds.items():
            for endpoint in endpoints:
                # Suppress the error if another thread has destroyed the endpoint, and will call wake().
                with contextlib.suppress(InvalidHandle):
                    self._watched.enter_context(endpoint.handle)
                    self._take[endpoint.handle.pointer] = partial(take, endpoint)
                    self._add.append(partial(getattr(ready, f"add_{kind}"), endpoint.handle))
        for event in events:
            with contextlib.suppress(InvalidHandle):
                self._watched.enter_context(event)
                self._events.append(event)
                self._add.append(partial(event.add_to_wait_set, ready))

    def _do_round(self) -> None:
        tasks, ready = len(self._tasks), self._ready
        ready.clear_entities()
        for add in self._add:
            add()
        ready.wait(0 if tasks else -1)
        kinds = ("subscription", "client", "service")
        arrived = {pointer for kind in kinds for pointer in ready.get_ready_entities(kind)}
        for event in self._events:
            if event.is_ready(ready) and (told := event.take_data()):
                event.callback(told)
        takes = [take for pointer, take in self._take.items() if pointer in arrived]
        for _ in range(LONG_QUEUE):
            if not takes:
                break
            takes = [take for take in takes if take()]
        for _ in range(tasks):
            self._tasks.popleft()()

    def _take_answer(self, client: Any) -> bool:
        header, response = client.handle.take_response(client.srv_type.Response)
        if header is None:
            return False
        with self._asking:
            # If two servers have this name, both answer, and only the first answer counts.
            take = self._awaited.pop((client, header.request_id.sequence_number), None)
        if take is not None:
            take(response)
        return True


def _take_message(subscription: Any) -> bool:
    taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    if taken is None:
        return False
    with_info = subscription._callback_type is Subscription.CallbackType.WithMessageInfo
    subscription.callback(*(taken if with_info else taken[:1]))
    return True


def _take_request(service: Any) -> bool:
    request, header = service.handle.service_take_request(service.srv_type.Request)
    if header is None:
        return False
    send = partial(send_until_received, service, header)
    # Each rclpy node has a service of its own, whose callback returns its response.
    if (response := service.callback(request, send)) is not None:
        send(response)
    return True


def send_until_received(service: Any, header: Any, response: Any) -> None:
    """Send the answer to a request again and again until the client receives it, or the service is destroyed.

    A new client can often send a request before it can receive an answer. The middleware waits 0.1 s for the client,
    then drops the answer and warns ("client will not receive response", rmw_fastrtps_shared_cpp/rmw_response.cpp). On a
    busy machine a correct client would then wait forever. So the answer is sent again until there is no warning.
    """
    with contextlib.suppress(InvalidHandle):
        for _ in range(ATTEMPTS):
            # The warning is recorded, not raised as an error, because rclpy's compiled code would raise a different
            # error instead.
            with _warnings_belong_to_all_threads, warnings.catch_warnings(record=True) as complaints:
                warnings.simplefilter("always", RuntimeWarning)
                service.send_response(response, header)
            if not any(issubclass(complaint.category, RuntimeWarning) for complaint in complaints):
                return


_warnings_belong_to_all_threads = threading.Lock()
