"""Delays the answers of the judge's services until the scenario wants them and the client can receive them."""

from __future__ import annotations

import threading
import warnings
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.service import Service

    Take = Callable[[Any, Any], Any]
    """A service's callback: it takes a request and an empty response."""

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
        service: The service.
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
        service: The service.
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
