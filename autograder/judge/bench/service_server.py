"""A service server of the judge's: it answers as the scenario says and writes both halves down."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from autograder.judge.bench.answering import once_it_is_set, patiently
from autograder.judge.bench.interfaces import filled, interface, to_data

if TYPE_CHECKING:
    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.bench.wire import Wire

Answer = Callable[[Mapping[str, Any]], Mapping[str, Any]]
"""From the request's fields to the response's."""


class RecordedServer:
    """Serves until it is closed; one of its answers may be held back until it is released.

    Attributes:
        services: The full names of what it serves.
    """

    def __init__(
        self, wire: Wire, recorder: Recorder, service: str, type_name: str, answer: Answer, *, hold: int = 0
    ) -> None:
        """Serve.

        Args:
            wire: The judge's participant.
            recorder: Takes down requests and responses.
            service: The full name.
            type_name: Such as ``"std_srvs/srv/Empty"``.
            answer: Gives the response to a request.
            hold: Which request's answer is held back, from 1 on; 0 for none.
        """
        self._wire = wire
        self._recorder = recorder
        self._name = service
        self.services = (service,)
        self._answer = answer
        self._hold, self._count = hold, 0
        self._held: list[tuple[Any, Any]] = []
        self._holding = threading.Lock()
        made = threading.Event()
        self._service = wire.node.create_service(
            interface(type_name), service, once_it_is_set(made, self._serve)
        )
        self._send = patiently(self._service)
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
        self._answer_now(response, header)

    def _answer_now(self, response: Any, header: Any) -> None:
        self._recorder.record("response", self._name, fields=to_data(response))
        self._send(response, header)

    def release(self) -> None:
        """Give the answer that was held back; the next one is not held any more."""
        with self._holding:
            self._hold = 0
            held, self._held = self._held, []
        for response, header in held:
            self._answer_now(response, header)

    def close(self) -> None:
        """Take the service away."""
        self._wire.node.destroy_service(self._service)
