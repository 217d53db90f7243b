"""The judge's side of services: a server that answers as the scenario says, and a client. Both record events."""

from __future__ import annotations

import threading
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rclpy.qos import qos_profile_parameters

from autograder.judge.bench.ros_interfaces import filled, interface, to_data
from autograder.judge.bench.subject_presence import GRAPH_POLL

if TYPE_CHECKING:
    from collections.abc import Container

    from rclpy.service import Service

    from autograder.judge.bench.judge_nodes import Wire
    from autograder.judge.bench.recorder import Recorder

    Take = Callable[[Any, Any], Any]
    """A service's callback: it takes a request and an empty response."""

Answer = Callable[[Mapping[str, Any]], Mapping[str, Any]]
"""A function of the request's fields that returns the response's fields."""


NONE_LATE: Mapping[int, float] = MappingProxyType({})


class RecordedServer:
    """A service that the judge offers until :meth:`close`, with answers at once, late, or after :meth:`release`.

    Attributes:
        services: A tuple with the full name of the service.
    """

    def __init__(
        self,
        wire: Wire,
        recorder: Recorder,
        service: str,
        type_name: str,
        answer: Answer,
        *,
        at: str = "",
        hold: int = 0,
        late: Mapping[int, float] = NONE_LATE,
        never: Container[int] = (),
    ) -> None:
        """Create the service.

        Args:
            wire: The judge's participant.
            recorder: Records requests and responses.
            service: The full name of the service as the evidence shows it.
            type_name: The service type, such as ``"std_srvs/srv/Empty"``.
            answer: Returns the response to a request.
            at: The full name that the subject's client uses for the service, if this name is different.
            hold: Which request, counted from 1, is answered only after :meth:`release`; 0 for none.
            late: The requests that are answered late, with the delay in seconds of the subject's time.
            never: The requests that are never answered.
        """
        self._wire = wire
        self._recorder = recorder
        self._name = service
        self.services = (at or service,)
        self._answer = answer
        self._hold, self._late, self._never, self._count = hold, late, never, 0
        self._held: list[tuple[Any, Any]] = []
        self._delayed: list[tuple[float, Any, Any]] = []
        self._holding = threading.Lock()
        made = threading.Event()
        self._service = wire.node.create_service(
            interface(type_name), at or service, once_it_is_set(made, self._serve)
        )
        self._send = patiently(self._service)
        # rclpy sends what the callback returns at once; the judge decides itself when an answer is sent.
        self._service.send_response = self._answer_or_hold  # type: ignore[method-assign]
        made.set()

    def _serve(self, request: Any, response: Any) -> Any:
        fields = to_data(request)
        self._recorder.record("request", self._name, fields=fields)
        return filled(response, dict(self._answer(fields)))

    def _answer_or_hold(self, response: Any, header: Any) -> None:
        with self._holding:
            self._count += 1
            if self._count == self._hold:
                self._held.append((response, header))
                return
            if self._count in self._late:
                self._delayed.append((self._recorder.moment + self._late[self._count], response, header))
                return
            if self._count in self._never:
                return
        self._answer_now(response, header)

    def _answer_now(self, response: Any, header: Any) -> None:
        self._recorder.record("response", self._name, fields=to_data(response))
        self._send(response, header)

    def release(self) -> None:
        """Send the answer that was held back, and hold back no later answer."""
        with self._holding:
            self._hold = 0
            held, self._held = self._held, []
        for response, header in held:
            self._answer_now(response, header)

    def answer_due(self) -> None:
        """Send the answers whose delay is over."""
        with self._holding:
            now = self._recorder.moment
            due = [one for one in self._delayed if one[0] <= now]
            self._delayed = [one for one in self._delayed if one[0] > now]
        for _, response, header in due:
            self._answer_now(response, header)

    def close(self) -> None:
        self._wire.node.destroy_service(self._service)


ROOM_FOR_ALL = qos_profile_parameters
"""A QoS profile for services with a queue of 1,000 (rclpy, ``qos.py``) instead of 10.

If two servers share a name, more than ten answers may come at once. In a shorter queue, chance would decide which
answers are lost.
"""


class Client(ABC):
    """Base class of the judge's service client and action client, which waits for a server and counts servers.

    Args:
        wire: The judge's participant.
        recorder: Records requests and answers.
        name: The full name of the service or action as the evidence shows it.
        service: The name that the subject uses for the service whose servers are counted.
        server_is_gone: Returns True if waiting for a server has become useless, because the subject has ended.
    """

    def __init__(
        self, wire: Wire, recorder: Recorder, name: str, service: str, server_is_gone: Callable[[], bool]
    ) -> None:
        self._wire = wire
        self._recorder = recorder
        self._name = name
        self._service = service
        self._server_is_gone = server_is_gone

    def await_server(self, within: float) -> bool:
        """Wait until a server is matched, and record the number of servers. Return True if one is matched."""
        self._recorder.wait(lambda: self._ready() or self._server_is_gone(), within, poll=GRAPH_POLL)
        self._note_servers()
        return self._ready()

    @abstractmethod
    def _ready(self) -> bool:
        """True if a server is matched with the client."""

    def _note_servers(self) -> None:
        count = self._wire.node.count_services(self._service)
        self._recorder.record("servers", self._name, count=count)


class RecordedCaller(Client):
    """A service client that records events. It implements :class:`autograder.kit.counterparts.Caller`."""

    def __init__(
        self,
        wire: Wire,
        recorder: Recorder,
        service: str,
        type_name: str,
        *,
        at: str = "",
        server_is_gone: Callable[[], bool],
    ) -> None:
        super().__init__(wire, recorder, service, at or service, server_is_gone)
        self._type = interface(type_name)
        self._calls = 0
        self._client = wire.node.create_client(self._type, at or service, qos_profile=ROOM_FOR_ALL)

    def _ready(self) -> bool:
        return bool(self._client.service_is_ready())

    def ask(self, *requests: Mapping[str, Any]) -> None:
        """Send all requests without waiting for an answer between them."""
        numbered = list(enumerate(requests, self._calls))
        self._calls += len(numbered)
        # Record all calls before the first is sent, because otherwise chance would decide whether an answer is recorded
        # before a later call.
        for number, fields in numbered:
            self._recorder.record("asked", self._name, call=number, fields=dict(fields))
        for number, fields in numbered:
            request = filled(self._type.Request(), fields)
            self._wire.executor.ask(self._client, request, partial(self._take, number))

    def await_answers(self, quiet: float) -> bool:
        """Wait until every call is answered. Return False if nothing was recorded for ``quiet`` seconds before that."""
        self._recorder.wait(
            lambda: self._all_answered() or self._server_is_gone(), self._calls * quiet, quiet=quiet
        )
        if not self._all_answered():
            return False
        self._note_servers()
        return True

    def close(self) -> None:
        self._wire.node.destroy_client(self._client)

    def _all_answered(self) -> bool:
        return len(self._recorder.part().of("answered", self._name)) >= self._calls

    def _take(self, number: int, response: Any) -> None:
        self._recorder.record("answered", self._name, call=number, fields=to_data(response))


ATTEMPTS = 30
"""The maximum number of attempts to send an answer. In each attempt the middleware waits about 0.1 s for the client's
reader.
"""


def patiently(service: Service, wanted: Callable[[], bool] = lambda: True) -> Callable[[Any, Any], None]:
    """Make a service send each answer again until the client receives it. Return the new function that sends answers.

    A new client can often send a request before it can receive an answer. The middleware waits 0.1 s for the client,
    then drops the answer and warns ("client will not receive response", rmw_fastrtps_shared_cpp/rmw_response.cpp). On a
    busy machine a correct client would then wait forever. So each answer is sent again until there is no warning.

    Args:
        wanted: Returns False once answers are not wanted any more.
    """
    usual = service.send_response

    def send(response: Any, header: Any) -> None:
        for _ in range(ATTEMPTS):
            if not wanted():
                return
            # The warning is recorded, not raised as an error, because rclpy's compiled code would raise a different
            # error instead.
            with _warnings_belong_to_all_threads, warnings.catch_warnings(record=True) as complaints:
                warnings.simplefilter("always", RuntimeWarning)
                usual(response, header)
            if not any(issubclass(complaint.category, RuntimeWarning) for complaint in complaints):
                return

    service.send_response = send  # type: ignore[method-assign]
    return send


_warnings_belong_to_all_threads = threading.Lock()


def once_it_is_set(made: threading.Event, take: Take) -> Take:
    """Return a service callback that waits for the event ``made`` before it calls ``take``.

    A service can receive a request as soon as it is created, before :func:`patiently` has replaced the function that
    sends answers. Without the event, the answer to such a request would be sent by the usual function and could be
    lost.
    """

    def wait_and_take(request: Any, response: Any) -> Any:
        made.wait()
        return take(request, response)

    return wait_and_take


class LateAnswers:
    """Delays each answer of a service, while the service goes on taking requests.

    Args:
        seconds: The delay from a request to its answer, in seconds of wall time.
        sending: Called with each answer just before it is sent.
    """

    def __init__(
        self,
        service: Service,
        seconds: float,
        *,
        sending: Callable[[Any], None],
    ) -> None:
        self._closed = False
        self._send_now = patiently(service, wanted=lambda: not self._closed)
        self._seconds = seconds
        self._sending = sending
        self._delivering = threading.Lock()
        service.send_response = self._send  # type: ignore[method-assign]

    def close(self) -> None:
        """Stop sending answers. Call this before the service is destroyed."""
        self._closed = True
        with self._delivering:  # wait, because an answer that is being sent right now still needs the service
            pass

    def _send(self, response: Any, header: Any) -> None:
        if self._seconds <= 0.0:
            self._deliver(response, header)
            return
        timer = threading.Timer(self._seconds, self._deliver, (response, header))
        timer.daemon = True
        timer.start()

    def _deliver(self, response: Any, header: Any) -> None:
        with self._delivering:
            if not self._closed:
                self._sending(response)
                self._send_now(response, header)
