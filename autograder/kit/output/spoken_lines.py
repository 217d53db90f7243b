"""Tells the words of a subject from the words of others in its output: runners, ROS's own loggers, and Fast DDS."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import re2

if TYPE_CHECKING:
    from autograder.kit.evidence import Event

REPORTS = ("@workspace ", "@process ")
"""The beginnings of lines with which a runner reports a build or a launched process; so they are not the subject's
words.
"""
_ROS2_RUN = "[ros2run]: "
"""The prefix of messages from ``ros2 run``, for example that the program exited with failure 3. Such a message does not
count as a report of the failure by the subject.
"""
_PREFIX = re2.compile(r"^\[\w+\] \[[\d.]+\] \[(?P<logger>[^\]]*)\]: ")
"""Matches the prefix of a log line on a terminal: level, time stamp, logger.

rcutils adds this prefix, so it does not count as text from the subject.
"""


_LIBRARIES = re2.compile(r"\.action_(client|server)$|^(rcl|rclpy|rcutils|rmw\w*)(\.|$)")
"""Matches the names of ROS's own loggers, which write lines such as "Ignoring unexpected result response"
(rclpy/action/client.py).
"""
_COLORS = r"(?:\x1b\[[\d;]*m)*"
_MIDDLEWARE = re2.compile(rf"^{_COLORS}\d{{4}}-\d\d-\d\d [\d:.]+ .*\[{_COLORS}\w+{_COLORS} (Error|Warning)\]")
"""Matches the beginning of an error or warning of Fast DDS, which on a busy machine appears even if the program is
right.
"""


def spoken_by(event: Event) -> str | None:
    """Return the text that the subject logged, printed or returned in an event, without prefix; None if none."""
    if event.kind in ("log", "output"):
        text = str(event.data["text"])
        prefix = _PREFIX.match(text) if text.startswith("[") else None
        logger = event.name if event.kind == "log" else prefix["logger"] if prefix else ""
        if (
            text.startswith((*REPORTS, _ROS2_RUN))
            or (logger and _is_a_library(logger))
            or _is_the_middlewares(text)
        ):
            return None
        return text[prefix.end() :] if prefix else text
    if event.kind == "subject" and event.name == "returned" and event.data.get("value") is not None:
        return str(event.data["value"])
    return None


@functools.lru_cache(maxsize=256)
def _is_a_library(logger: str) -> bool:
    return _LIBRARIES.search(logger) is not None


def _is_the_middlewares(text: str) -> bool:
    # The slow pattern is tried only on lines that may match, because this code runs many times for every line of
    # output.
    return ("Error]" in text or "Warning]" in text) and _MIDDLEWARE.match(text) is not None
