"""Lets an interrupt of the kernel end a wait of rclpy in which nothing arrives, such as ``rclpy.spin(node)``.

rclpy waits in compiled code, and Python raises KeyboardInterrupt only when that code returns. Each wait of rclpy
includes a guard condition that should end it at Ctrl-C (``rclpy/signals.py``). But only rclpy's own signal handler
triggers this guard condition, and that handler also shuts ROS down. So this module triggers it: Python writes a byte to
a file descriptor as soon as a signal arrives (``signal.set_wakeup_fd``), and a thread reads it.
"""

from __future__ import annotations

import functools
import os
import signal
import threading
import weakref
from contextlib import suppress
from typing import Any

from rclpy.exceptions import InvalidHandle
from rclpy.signals import SignalHandlerGuardCondition

_conditions: list[weakref.ref[SignalHandlerGuardCondition]] = []


@functools.cache
def end_waits_from_now_on() -> None:
    """Let each interrupt from now on end a wait in the main thread. ROS and the nodes go on. Call it in that thread.

    If something else in this process uses Python's wakeup file descriptor, nothing changes.
    """
    reads, writes = os.pipe()
    os.set_blocking(writes, False)
    earlier = signal.set_wakeup_fd(writes, warn_on_full_buffer=False)
    if earlier != -1:
        signal.set_wakeup_fd(earlier)
        return
    plain_init: Any = SignalHandlerGuardCondition.__init__

    def init(condition: SignalHandlerGuardCondition, *args: Any, **kwargs: Any) -> None:
        global _conditions
        plain_init(condition, *args, **kwargs)
        # A wait for one message in another thread would end without a message.
        if threading.current_thread() is threading.main_thread():
            _conditions = [*(one for one in _conditions if one()), weakref.ref(condition)]

    SignalHandlerGuardCondition.__init__ = init  # type: ignore[method-assign, assignment]
    threading.Thread(target=_end_waits, args=(reads,), name="interrupts", daemon=True).start()


def _end_waits(reads: int) -> None:
    while numbers := os.read(reads, 100):
        for reference in _conditions if signal.SIGINT in numbers else ():
            if condition := reference():
                with suppress(InvalidHandle):
                    condition.trigger()
