"""A service client of the judge's: it calls what the subject serves and writes both halves down."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.qos import qos_profile_parameters

from autograder.judge.bench.interfaces import filled, interface, to_data

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from autograder.judge.bench.recorder import Recorder
    from autograder.judge.bench.wire import Wire

ROOM_FOR_ALL = qos_profile_parameters
"""The profile of services with a queue of 1,000 (rclpy, ``qos.py``) instead of 10. Where two servers share a name, more
than ten answers come at once, and those that find no room would be lost by chance."""
GRAPH_POLL = 0.004
"""Seconds between two looks for a server."""


class RecordedCaller:
    """Implements :class:`autograder.kit.counterparts.Caller`."""

    def __init__(
        self,
        wire: Wire,
        recorder: Recorder,
        service: str,
        type_name: str,
        *,
        server_is_gone: Callable[[], bool],
    ) -> None:
        self._wire = wire
        self._recorder = recorder
        self._name = service
        self._type = interface(type_name)
        self._server_is_gone = server_is_gone
        self._calls = 0
        self._client = wire.node.create_client(self._type, service, qos_profile=ROOM_FOR_ALL)

    def await_server(self, within: float) -> bool:
        """Wait until a server is matched, and write down how many there are."""
        self._recorder.wait(
            lambda: self._client.service_is_ready() or self._server_is_gone(), within, poll=GRAPH_POLL
        )
        self._recorder.record("servers", self._name, count=self._wire.node.count_services(self._name))
        return bool(self._client.service_is_ready())

    def ask(self, *requests: Mapping[str, Any]) -> None:
        """Send requests, one right after the other."""
        numbered = list(enumerate(requests, self._calls))
        self._calls += len(numbered)
        # All are written down before the first is sent, so that a recording does not depend on who is faster.
        for number, fields in numbered:
            self._recorder.record("asked", self._name, call=number, fields=dict(fields))
        for number, fields in numbered:
            future = self._client.call_async(filled(self._type.Request(), fields))
            future.add_done_callback(lambda done, number=number: self._take(number, done.result()))

    def await_answers(self, quiet: float) -> bool:
        """Wait until every call is answered, as long as anything happens."""
        self._recorder.wait(
            lambda: self._all_answered() or self._server_is_gone(), self._calls * quiet, quiet=quiet
        )
        if not self._all_answered():
            return False
        self._recorder.record("servers", self._name, count=self._wire.node.count_services(self._name))
        return True

    def close(self) -> None:
        """Take the client away."""
        self._wire.node.destroy_client(self._client)

    def _all_answered(self) -> bool:
        return len(self._recorder.part().of("answered", self._name)) >= self._calls

    def _take(self, number: int, response: Any) -> None:
        self._recorder.record("answered", self._name, call=number, fields=to_data(response))
