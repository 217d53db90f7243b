"""Sends a message between two processes over ROS: ``python -m course_runtime.loopback talk|listen TOPIC SECONDS``.

The doctor starts both processes and waits for the listener. They use the domain and transports of the caller, because
a student's nodes will use these, too.
"""

from __future__ import annotations

import subprocess
import sys
import time
import uuid
from typing import TYPE_CHECKING

from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from subprocess import Popen

# Discovery on one host takes well under a second. If it takes ten, the labs will not work either.
LIMIT = 10.0


def seconds_to_first_message(limit: float = LIMIT) -> float | None:
    """Start a talker and a listener. Return the seconds until the message arrived.

    Args:
        limit: Time limit in seconds for the two processes.

    Returns:
        None if the message did not arrive, or if one of the processes could not run.
    """
    # No other program uses this topic.
    topic = f"/course_doctor_{uuid.uuid4().hex}"
    started = time.monotonic()
    with _start("talk", topic, limit) as talker, _start("listen", topic, limit) as listener:
        try:
            heard = listener.wait() == 0
            return time.monotonic() - started if heard else None
        finally:
            talker.kill()


def _start(role: str, topic: str, limit: float) -> Popen[bytes]:
    partner = python_child("-m", "course_runtime.loopback", role, topic, str(limit))
    return partner.start(stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def main(role: str, topic: str, limit: float) -> int:
    """Run as the talker or the listener. Return 0 if the listener heard the message."""
    import rclpy
    from rclpy.utilities import try_shutdown
    from std_msgs.msg import String

    rclpy.init()
    node = rclpy.create_node(f"course_doctor_{role}")
    heard: list[str] = []
    if role == "talk":
        publisher = node.create_publisher(String, topic, 10)
        node.create_timer(0.05, lambda: publisher.publish(String(data="hello")))
    else:

        def hear(message: String) -> None:
            heard.append(message.data)

        node.create_subscription(String, topic, hear, 10)
    end = time.monotonic() + limit
    while not heard and (left := end - time.monotonic()) > 0:
        rclpy.spin_once(node, timeout_sec=left)
    try_shutdown()
    return 0 if heard else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], float(sys.argv[3])))
