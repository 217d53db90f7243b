"""Records messages as MCAP, the format that ``ros2 bag``, Foxglove and Python programs can open.

Messages are written in the format in which they are received (CDR), with the definition of their type. So messages of
any type can be recorded.
"""

from __future__ import annotations

import contextlib
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Self

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from autograder.mcap_files import MessageFile, definition
from autograder.notebook.observing.live_picture import GONE
from autograder.notebook.observing.ros_graph import hidden_node, is_shown_topic, message_class

if TYPE_CHECKING:
    import os
    from collections.abc import Collection, Iterator

    from rclpy.node import Node
    from rclpy.subscription import Subscription


LOOK_AGAIN = 0.05
"""Seconds between two checks for new messages and new topics."""
DEPTH = 1000
"""The maximum number of messages on a topic between two checks; if more arrive, some of them are lost."""


@dataclass(frozen=True)
class Recorded:
    """A message of a recording.

    Attributes:
        t: The Unix time in seconds at which the message was sent.
        topic: The name of the topic.
        type: The name of the message type, such as ``"std_msgs/msg/String"``.
        message: The message. Its attributes are the fields.
    """

    t: float
    topic: str
    type: str
    message: Any


def recording(path: str | os.PathLike[str], topics: Collection[str] = ()) -> Recording:
    """Record the messages of topics while a ``with`` block runs.

    For example::

        with recording("hello.mcap"), spinning(TalkerNode()):
            time.sleep(3)

    A topic is recorded from the moment its publisher is discovered, a few hundredths of a second after the publisher
    was made. When the block ends, even by an error, the file is complete.

    Args:
        path: The file to write. An existing file is overwritten.
        topics: The topics to record; by default all except ``/rosout``, ``/parameter_events`` and hidden topics.

    Raises:
        ValueError: ``path`` does not end in ``.mcap``.
        OSError: The file cannot be written.
    """
    file = Path(path)
    if file.suffix != ".mcap":
        raise ValueError(f"a recording is a file such as hello.mcap: {file.name} does not end in .mcap")
    return Recording(file, [name if name.startswith("/") else f"/{name}" for name in topics])


class Recording:
    """A recording, for use in a ``with`` statement. ``recording`` returns this object.

    Attributes:
        counts: The number of recorded messages of each topic.
    """

    def __init__(self, path: Path, topics: Collection[str]) -> None:
        self.counts: dict[str, int] = {}
        self._path = path
        self._topics = topics
        self._over = threading.Event()
        self._known: set[tuple[str, str]] = set()
        self._subscriptions: dict[int, Subscription] = {}

    def __enter__(self) -> Self:
        # Make the node before the file is opened: if ROS is not started, this fails, and no file is overwritten.
        self._node = hidden_node("_recorder")
        try:
            self._file: IO[bytes] = self._path.open("wb")
        except OSError:
            self._node.destroy_node()
            raise
        self._messages = MessageFile(self._file)
        self._look_for_topics()
        self._thread = threading.Thread(target=self._record, name="recorder", daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End the recording and complete the file."""
        self._over.set()
        self._thread.join()
        self._messages.close()
        self._file.close()

    def __repr__(self) -> str:
        """Return one line that describes the recording."""
        listed = ", ".join(f"{count} on {topic}" for topic, count in sorted(self.counts.items()))
        return f"{self._path}: {listed or 'no messages'}"

    def _record(self) -> None:
        # If ROS is shut down or the node is destroyed, keep the recording so far.
        with contextlib.suppress(*GONE):
            while not self._over.wait(LOOK_AGAIN):
                self._take()
                self._look_for_topics()
            self._take()
            self._node.destroy_node()

    def _take(self) -> None:
        """Write the messages that have arrived since the last check."""
        for channel, subscription in self._subscriptions.items():
            with subscription.handle:
                while (taken := subscription.handle.take_message(subscription.msg_type, True)) is not None:
                    data, info = taken
                    self.counts[subscription.topic_name] += 1
                    self._messages.add(
                        channel, data, arrived=info["received_timestamp"], sent=info["source_timestamp"]
                    )

    def _look_for_topics(self) -> None:
        for topic, types in self._node.get_topic_names_and_types():
            wanted = topic in self._topics if self._topics else is_shown_topic(topic)
            for type_name in types if wanted else ():
                if (topic, type_name) not in self._known and self._node.count_publishers(topic):
                    self._known.add((topic, type_name))
                    self._subscribe(topic, type_name)

    def _subscribe(self, topic: str, type_name: str) -> None:
        try:
            kind, text = message_class(type_name), definition(type_name)
        except LookupError:
            return  # the package that defines the type is not installed, so skip the topic
        channel = self._messages.channel(topic, type_name, text)
        self.counts[topic] = 0
        self._subscriptions[channel] = self._node.create_subscription(
            kind, topic, lambda _: None, _as_offered(self._node, topic), raw=True
        )


def _as_offered(node: Node, topic: str) -> QoSProfile:
    """Return the strictest QoS for a subscription that is compatible with every publisher of a topic."""
    offered = [info.qos_profile for info in node.get_publishers_info_by_topic(topic)]
    reliable = all(profile.reliability is ReliabilityPolicy.RELIABLE for profile in offered)
    kept = all(profile.durability is DurabilityPolicy.TRANSIENT_LOCAL for profile in offered)
    return QoSProfile(
        depth=DEPTH,
        history=HistoryPolicy.KEEP_LAST,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
    )


def read_recording(path: str | os.PathLike[str], topics: Collection[str] = ()) -> Iterator[Recorded]:
    """Yield the messages of a recording, in the order in which they arrived.

    Args:
        path: A file from ``recording`` or ``ros2 bag record -s mcap``.
        topics: The topics to read; by default all.

    Raises:
        OSError: The file cannot be read.
        mcap.exceptions.McapError: The file is not a recording.
    """
    with Path(path).open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in reader.iter_decoded_messages(topics=list(topics) or None):
            yield Recorded(message.publish_time / 1e9, channel.topic, schema.name if schema else "", decoded)
