"""A service server of the judge's: it answers as the scenario says and writes both halves down."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from autograder.judge.answering import patiently
from autograder.judge.interfaces import filled, interface, to_data

if TYPE_CHECKING:
    from autograder.judge.recorder import Recorder
    from autograder.judge.wire import Wire

Answer = Callable[[Mapping[str, Any]], Mapping[str, Any]]
"""From the request's fields to the response's."""


class RecordedServer:
    """Serves until it is closed."""

    def __init__(self, wire: Wire, recorder: Recorder, service: str, type_name: str, answer: Answer) -> None:
        self._wire = wire
        self._recorder = recorder
        self._name = service
        self._answer = answer
        self._service = wire.node.create_service(interface(type_name), service, self._serve)
        patiently(self._service)

    def _serve(self, request: Any, response: Any) -> Any:
        fields = to_data(request)
        self._recorder.record("request", self._name, fields=fields)
        answer = dict(self._answer(fields))
        self._recorder.record("response", self._name, fields=answer)
        return filled(response, answer)

    def close(self) -> None:
        """Take the service away."""
        self._wire.node.destroy_service(self._service)
