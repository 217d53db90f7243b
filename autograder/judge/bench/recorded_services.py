"""The judge's side of services: a server that answers as the scenario says, and a client. Both record events."""

from __future__ import annotations

import math
import threading
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

    from autograder.judge.bench.recorder import Place

    Send = Callable[[Any], None]
    """A function that sends a response to the client."""

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
        place: Place,
        answer: Answer,
        *,
        hold: int = 0,
        late: Mapping[int, float] = NONE_LATE,
        never: Container[int] = (),
    ) -> None:
        """Create the service.

        Args:
            answer: Returns the response to a request.
            hold: Which request, counted from 1, is answered only after :meth:`release`; 0 for none.
            late: The requests that are answered late, with the delay in seconds of the subject's time.
            never: The requests that are never answered.
        """
        self._place, self._answer = place, answer
        self.services = (place.at,)
        self._hold, self._late, self._never, self._count = hold, late, never, 0
        self._delayed: list[tuple[float, Any, Send]] = []
        self._holding = threading.Lock()
        self._type = interface(place.type_name)
        # The executor gives the callback a function that sends, and no response.
        self._service = place.wire.node.create_service(self._type, place.at, self._take)  # type: ignore[misc]

    def _take(self, request: Any, send: Send) -> None:
        fields = to_data(request)
        self._place.record("request", fields=fields)
        response = filled(self._type.Response, self._answer(fields), f"The answer of {self._place.name}")
        with self._holding:
            self._count += 1
            delay = math.inf if self._count == self._hold else self._late.get(self._count)
            if delay is not None:
                self._delayed.append((self._place.recorder.moment + delay, response, send))
                return
            if self._count in self._never:
                return
        self._send(response, send)

    def _send(self, response: Any, send: Send) -> None:
        self._place.record("response", fields=to_data(response))
        send(response)

    def release(self) -> None:
        """Send the answer that was held back, and hold back no later answer."""
        self._hold = 0
        self._send_those(math.isinf)

    def answer_due(self) -> None:
        """Send the answers whose delay is over."""
        now = self._place.recorder.moment
        self._send_those(lambda due: due <= now)

    def _send_those(self, is_due: Callable[[float], bool]) -> None:
        with self._holding:
            due = [one for one in self._delayed if is_due(one[0])]
            self._delayed = [one for one in self._delayed if not is_due(one[0])]
        for _, response, send in due:
            self._send(response, send)

    def close(self) -> None:
        self._place.wire.node.destroy_service(self._service)


ROOM_FOR_ALL = qos_profile_parameters
"""A QoS profile for services with a queue of 1,000 (rclpy, ``qos.py``) instead of 10.

If two servers share a name, more than ten answers may come at once. In a shorter queue, chance would decide which
answers are lost.
"""


class Client(ABC):
    """Base class of the judge's service client and action client, which waits for a server and counts servers.

    Args:
        place: The place of the service or action.
        service: The name that the subject uses for the service whose servers are counted.
        server_is_gone: Returns True if waiting for a server has become useless, because the subject has ended.
    """

    def __init__(self, place: Place, service: str, server_is_gone: Callable[[], bool]) -> None:
        self._place, self._service, self._server_is_gone = place, service, server_is_gone

    def await_server(self, within: float) -> bool:
        """Wait until a server is matched, and record the number of servers. Return True if one is matched."""
        self._place.recorder.wait(lambda: self._ready() or self._server_is_gone(), within, poll=GRAPH_POLL)
        self._note_servers()
        return self._ready()

    @abstractmethod
    def _ready(self) -> bool:
        """True if a server is matched with the client."""

    def _note_servers(self) -> None:
        self._place.record("servers", count=self._place.wire.count_servers(self._service))


class RecordedCaller(Client):
    """A service client that records events. It implements :class:`autograder.kit.counterparts.Caller`."""

    def __init__(self, place: Place, server_is_gone: Callable[[], bool]) -> None:
        super().__init__(place, place.at, server_is_gone)
        self._type = interface(place.type_name)
        self._calls = 0
        self._client = place.wire.client(self._type, place.at, qos_profile=ROOM_FOR_ALL)

    def _ready(self) -> bool:
        return bool(self._client.service_is_ready())

    def ask(self, *requests: Mapping[str, Any]) -> None:
        """Send all requests without waiting for an answer between them."""
        messages = [filled(self._type.Request, fields, self._place.name) for fields in requests]
        numbered = list(enumerate(requests, self._calls))
        self._calls += len(numbered)
        # Record all calls before the first is sent, because otherwise chance would decide whether an answer is recorded
        # before a later call.
        for number, fields in numbered:
            self._place.record("asked", call=number, fields=dict(fields))
        for (number, _), request in zip(numbered, messages, strict=True):
            self._place.wire.executor.ask(self._client, request, partial(self._take, number))

    def await_answers(self, quiet: float) -> bool:
        """Wait until every call is answered. Return False if nothing was recorded for ``quiet`` seconds before that."""
        self._place.recorder.wait(
            lambda: self._all_answered() or self._server_is_gone(), self._calls * quiet, quiet=quiet
        )
        if not self._all_answered():
            return False
        self._note_servers()
        return True

    def close(self) -> None:
        self._place.wire.node.destroy_client(self._client)

    def _all_answered(self) -> bool:
        return len(self._place.recorder.part().of("answered", self._place.name)) >= self._calls

    def _take(self, number: int, response: Any) -> None:
        self._place.record("answered", call=number, fields=to_data(response))
