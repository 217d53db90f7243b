"""A ROS context for checks alone: fresh, on the judge's domain, and rclpy's default for as long as a check runs.

A student's class says ``super().__init__("talker_node")`` and means the default context. While a check runs,
that is
this one, so that nodes of the notebook's demonstrations are neither heard nor disturbed.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Self

import rclpy
import rclpy.utilities
from rclpy.context import Context
from rclpy.signals import SignalHandlerOptions

from autograder.ros_domain import DOMAIN_VARIABLE

if TYPE_CHECKING:
    from types import TracebackType

_GLOBAL_EXECUTOR = "__executor"
"""The name in ``rclpy/__init__.py``."""


class CheckContext:
    """Swaps rclpy's default context within a ``with`` block."""

    def __init__(self, domain_id: int) -> None:
        self._domain_id = domain_id
        self._usual: Context | None = None
        self.context = Context()

    def __enter__(self) -> Self:
        with rclpy.utilities.g_context_lock:
            self._usual = rclpy.utilities.g_default_context
        # rclpy.spin and its kin share one executor, which stays with the context it was first used on.
        self._usual_executor = getattr(rclpy, _GLOBAL_EXECUTOR, None)
        setattr(rclpy, _GLOBAL_EXECUTOR, None)
        # What the subject starts as a process, such as the ros2 command, must be on the judge's domain, too.
        self._usual_domain = os.environ.get(DOMAIN_VARIABLE)
        os.environ[DOMAIN_VARIABLE] = str(self._domain_id)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()
        setattr(rclpy, _GLOBAL_EXECUTOR, self._usual_executor)
        self._put(self._usual)
        if self._usual_domain is None:
            os.environ.pop(DOMAIN_VARIABLE, None)
        else:
            os.environ[DOMAIN_VARIABLE] = self._usual_domain

    def ensure(self, *, fresh: bool) -> None:
        """Make a new context where one is asked for, or where the student's code has shut the last one down."""
        if fresh or not self.context.ok():
            self.renew()
        else:
            self._put(self.context)

    def renew(self) -> None:
        """Begin with a fresh participant."""
        self._end()
        self.context = Context()
        rclpy.init(
            args=["--ros-args", "--disable-external-lib-logs"],
            context=self.context,
            domain_id=self._domain_id,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self._put(self.context)

    def _end(self) -> None:
        self.context.try_shutdown()

    @staticmethod
    def _put(context: Context | None) -> None:
        with rclpy.utilities.g_context_lock:
            rclpy.utilities.g_default_context = context  # type: ignore[assignment]
