"""The judge's subscriptions and publishers, which record messages, matches and QoS errors."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_policy_name_from_kind,
)

from autograder.judge.bench.batch_executor import LONG_QUEUE
from autograder.judge.bench.qos_profiles import profile
from autograder.judge.bench.ros_interfaces import filled, interface, to_data
from autograder.kit.counterparts import Qos

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.judge.bench.judge_nodes import Wire
    from autograder.judge.bench.recorder import Place, Recorder


_LOG_HISTORY = QoSProfile(
    depth=LONG_QUEUE, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)  # fmt: skip


class _RecordedEndpoint:
    """A publisher or subscription of the judge, which records matching endpoints and endpoints with incompatible QoS.

    Attributes:
        matched: The number of the subject's endpoints that are matched with this endpoint now.
        topic: The topic's name as the evidence shows it.
        type_name: The message type, such as ``"std_msgs/msg/String"``.
    """

    def __init__(self, place: Place, qos: Qos) -> None:
        self.matched = 0
        self._place, self._qos = place, qos
        self.topic, self.type_name = place.name, place.type_name

    def _events_of(self, kind: Any) -> Any:
        return kind(matched=self._match, incompatible_qos=self._mismatch, use_default_callbacks=False)

    def _match(self, info: Any) -> None:
        self.matched = info.current_count
        # An endpoint that exists only for a moment is reported once, when it is already gone. Then only the total count
        # shows that it existed.
        self._place.record("matched", count=info.total_count, now=info.current_count)

    def _mismatch(self, info: Any) -> None:
        policy = str(qos_policy_name_from_kind(info.last_policy_kind)).lower()
        own = {} if self._qos is Qos.DEFAULT else {"qos": str(self._qos)}
        self._place.record("mismatch", policy=policy, **own)


class RecordedSubscription(_RecordedEndpoint):
    """A subscription of the judge that records every message."""

    def __init__(self, place: Place, qos: Qos) -> None:
        """Create the subscription.

        Args:
            qos: The QoS of the subscription. By default it is like that of the course's listener, so the judge hears a
                publisher only if the listener can hear the publisher.
        """
        super().__init__(place, qos)
        self.subscription = place.wire.node.create_subscription(
            interface(place.type_name),
            place.at,
            self._hear,  # type: ignore[arg-type]  # a callback with two parameters also gets the message info
            profile(qos, LONG_QUEUE),
            event_callbacks=self._events_of(SubscriptionEventCallbacks),
        )

    def _hear(self, message: Any, info: Any) -> None:
        # The publisher's sequence number shows how many messages were sent before this subscription could receive any.
        # The publisher's time stamp shows when a message was sent, however long its transport took. (rmw_fastrtps
        # provides both in rmw_message_info_t.)
        self._place.record(
            "message",
            fields=to_data(message),
            number=info["publication_sequence_number"],
            sent=info["source_timestamp"] / 1e9,
            arrived=time.time(),
        )


class RecordedPublisher(_RecordedEndpoint):
    """A publisher that records what it sends; by default with the course's QoS (reliable, depth 10)."""

    def __init__(self, place: Place, qos: Qos) -> None:
        super().__init__(place, qos)
        self._type = interface(place.type_name)
        self.publisher = place.wire.node.create_publisher(
            self._type,
            place.at,
            profile(qos),
            event_callbacks=self._events_of(PublisherEventCallbacks),
        )

    def send(self, **fields: Any) -> None:
        """Publish one message with these fields."""
        message = filled(self._type, fields, self._place.name)
        self._place.record("sent", fields=dict(fields))
        self.publisher.publish(message)


class LogReader:
    """Reads ``/rosout``, including lines from before the judge subscribed, because the topic is transient local."""

    def __init__(self, wire: Wire, recorder: Callable[[], Recorder]) -> None:
        """Subscribe. ``recorder`` returns the recorder of the current part."""
        self._recorder = recorder
        self.subscription = wire.node.create_subscription(
            interface("rcl_interfaces/msg/Log"), "/rosout", self._hear, _LOG_HISTORY
        )

    def _hear(self, line: Any) -> None:
        recorder, sent = self._recorder(), line.stamp.sec + line.stamp.nanosec / 1e9
        if sent < recorder.began_at:
            return  # ignore a late line of an earlier part, which a node of the same participant logged
        text, level = line.msg, int(line.level)
        recorder.record("log", line.name, text=text, level=level, sent=sent, arrived=time.time())
