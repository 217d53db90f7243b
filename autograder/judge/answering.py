"""Answers that arrive: a service of the judge's that waits until its client can hear it."""

from __future__ import annotations

import threading
import warnings
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.service import Service

ATTEMPTS = 30
"""How often an answer is tried; the middleware waits about 0.1 s each time for the client's reader."""


def patiently(service: Service) -> Callable[[Any, Any], None]:
    """How to send an answer of this service, and make the service send its own answers so.

    A client whose request came at once may not be able to hear yet. The middleware waits 0.1 s for it, drops the
    answer and warns ("client will not receive response", rmw_fastrtps_shared_cpp/rmw_response.cpp): on a busy machine
    a right client would then wait for ever.
    """
    usual = service.send_response

    def send(response: Any, header: Any) -> None:
        for _ in range(ATTEMPTS):
            # Taken down and not made an error: an error that a warning makes in compiled code comes out as another one.
            with _warnings_belong_to_all_threads, warnings.catch_warnings(record=True) as complaints:
                warnings.simplefilter("always", RuntimeWarning)
                usual(response, header)
            if not any(issubclass(complaint.category, RuntimeWarning) for complaint in complaints):
                return

    service.send_response = send  # type: ignore[method-assign]
    return send


_warnings_belong_to_all_threads = threading.Lock()
