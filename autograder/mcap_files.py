"""Writes messages as MCAP, the format that ``ros2 bag``, Foxglove and Python programs can open."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import IO, TYPE_CHECKING

import re2
from ament_index_python import PackageNotFoundError, get_package_share_directory
from mcap.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Iterator

_LINE = "=" * 80
"""The line that separates the definition of a type from the definitions of the types of its fields."""
_FIELD = re2.compile(r"^\s*([A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+\w")
"""Matches a field in a definition: a type, which may be an array or have a maximum length, and a name."""


class MessageFile:
    """An MCAP file that is being written. It is complete only after :meth:`close`.

    Args:
        stream: The stream to write to. The caller closes it.
    """

    def __init__(self, stream: IO[bytes]) -> None:
        self._writer = Writer(stream)
        self._writer.start(profile="ros2", library="ros2-on-the-wire")
        self._counts: Counter[int] = Counter()

    def channel(self, topic: str, type_name: str, definition: str) -> int:
        """Add a channel for messages of one type on one topic. Return the number of the channel.

        Args:
            topic: The name of the topic.
            type_name: The type of the messages, such as ``"std_msgs/msg/String"``.
            definition: ROS's definition of the type.
        """
        schema = self._writer.register_schema(type_name, "ros2msg", definition.encode())
        return self._writer.register_channel(topic, "cdr", schema, {"offered_qos_profiles": ""})

    def add(self, channel: int, data: bytes, *, arrived: int, sent: int) -> None:
        """Write one message.

        Args:
            channel: The number that :meth:`channel` returned.
            data: The message in CDR.
            arrived: The Unix time of arrival, in nanoseconds.
            sent: The Unix time of sending, in nanoseconds.
        """
        self._counts[channel] += 1
        self._writer.add_message(
            channel, log_time=arrived, data=data, publish_time=sent, sequence=self._counts[channel]
        )

    def close(self) -> None:
        """Complete the file."""
        self._writer.finish()  # type: ignore[no-untyped-call]


def definition(type_name: str) -> str:
    """Return the definition of a type such as ``"geometry_msgs/msg/Twist"``, and those of the types of its fields.

    Raises:
        LookupError: The type is not installed.
    """
    found = {type_name: _text(type_name)}
    waiting = [type_name]
    while waiting:
        for inner in _types_in(found[owner := waiting.pop()], owner.partition("/")[0]):
            if inner not in found:
                found[inner] = _text(inner)
                waiting.append(inner)
    first, *others = found.items()
    return "\n".join([first[1], *(f"{_LINE}\nMSG: {_short(name)}\n{text}" for name, text in others)])


def _text(type_name: str) -> str:
    try:
        package, kind, name = type_name.split("/")
        return (Path(get_package_share_directory(package)) / kind / f"{name}.msg").read_text(encoding="utf-8")
    except (ValueError, PackageNotFoundError, OSError) as error:
        raise LookupError(f"no definition of {type_name} was found here") from error


def _types_in(text: str, package: str) -> Iterator[str]:
    """Yield the types of the fields that are messages. Such a type begins with a capital letter or with a package."""
    for line in text.splitlines():
        field = _FIELD.match(line)
        if field is None or not (field[1][0].isupper() or "/" in field[1]):
            continue
        owner, _, name = field[1].rpartition("/")
        yield f"{owner.removesuffix('/msg') or package}/msg/{name}"


def _short(type_name: str) -> str:
    package, _, name = type_name.split("/")
    return f"{package}/{name}"
