"""What a node on paper makes: publishers, subscriptions, services, clients and timers."""

from __future__ import annotations

import threading
from functools import partial
from typing import TYPE_CHECKING, Any

from rclpy.qos import QoSProfile
from rclpy.task import Future

from autograder.authoring.paper.network import NEVER, SECOND, Hangs, Network, wired

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.authoring.paper.network import Answer


def profile_of(qos: int | QoSProfile) -> QoSProfile:
    """Return the profile of an endpoint that is given by a profile, or by the depth of its queue."""
    return qos if isinstance(qos, QoSProfile) else QoSProfile(depth=qos)


class Publisher:
    """A publisher of a program."""

    def __init__(self, kind: Any, topic: str, profile: QoSProfile) -> None:
        self.kind = self.msg_type = kind
        self.name = self.topic = self.topic_name = topic
        self.profile = self.qos_profile = profile
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
        self.kind = self.msg_type = kind
        self.name = self.topic = self.topic_name = topic
        self.profile = self.qos_profile = profile
        self.callback = callback


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

    def is_ready(self) -> bool:
        """Return True if the callback has to be called now."""
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

    def time_until_next_call(self) -> int | None:
        """Return the nanoseconds until the next call."""
        return None if self._canceled else self._next - Network.now_running.time

    def destroy(self) -> None:
        """Stop the timer for good."""
        self._canceled = True
