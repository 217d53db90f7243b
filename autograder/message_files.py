"""Messages as a file that ``ros2 bag``, Foxglove and Python programs open: MCAP, written in one place for all."""

from __future__ import annotations

from collections import Counter
from typing import IO, TYPE_CHECKING

from mcap.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Mapping

ROS_2 = "ros2"
"""The profile of a file whose messages are in CDR, with the definitions of their types."""


class MessageFile:
    """An MCAP file while it is written; without :meth:`close` it is not complete.

    Args:
        stream: Where to; stays the caller's.
        profile: What kind of file it is, such as :data:`ROS_2`; empty for messages as JSON.
    """

    def __init__(self, stream: IO[bytes], profile: str = "") -> None:
        self._writer = Writer(stream)
        self._writer.start(profile=profile, library="ros2-course-autograder")
        self._counts: Counter[int] = Counter()

    def channel(
        self, topic: str, type_name: str, definition: str, *, as_json: bool = False, about: Mapping[str, str]
    ) -> int:
        """Announce messages of one type on one topic; the number to write them under.

        Args:
            topic: Where they were sent.
            type_name: Of the message, such as ``"std_msgs/msg/String"``.
            definition: What is in it: as ROS defines it, or as JSON Schema.
            as_json: The messages are JSON; in CDR where not.
            about: More that is known of them.
        """
        encodings = ("jsonschema", "json") if as_json else ("ros2msg", "cdr")
        schema = self._writer.register_schema(type_name, encodings[0], definition.encode())
        return self._writer.register_channel(topic, encodings[1], schema, dict(about))

    def add(self, channel: int, data: bytes, *, arrived: int, sent: int) -> None:
        """Write one message.

        Args:
            channel: What :meth:`channel` has said.
            data: The message.
            arrived: When, in nanoseconds of Unix time.
            sent: When, likewise.
        """
        self._counts[channel] += 1
        self._writer.add_message(
            channel, log_time=arrived, data=data, publish_time=sent, sequence=self._counts[channel]
        )

    def note(self, name: str, words: Mapping[str, str]) -> None:
        """Write something about the whole file."""
        self._writer.add_metadata(name, dict(words))

    def close(self) -> None:
        """Complete the file."""
        self._writer.finish()  # type: ignore[no-untyped-call]
