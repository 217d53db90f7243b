"""Starts ROS in a notebook's kernel, on a separate ROS domain, and shuts it down when the kernel ends."""

from __future__ import annotations

import atexit
import os
import sys
import threading
from dataclasses import dataclass

import rclpy
from rclpy.signals import SignalHandlerOptions, get_current_signal_handlers_options, uninstall_signal_handlers
from rclpy.utilities import get_default_context, ok, try_shutdown

from autograder.ros_domain import (
    DOMAIN_VARIABLE,
    DomainClaim,
    claim_free_domain,
    domain_from_environment,
)

_CHECK_FIELDS = "ROS_PYTHON_CHECK_FIELDS"

_DEFAULTS = {
    # Log to stdout, because nbgrader without this package gives no points to a graded cell that wrote to stderr.
    "RCUTILS_LOGGING_USE_STDOUT": "1",
    "RCUTILS_COLORIZED_OUTPUT": "0",
    # Write each line at once. Otherwise, if the kernel's output does not go to a terminal (in a batch, or on a
    # JupyterHub), the C library holds log lines back until there are 4 KB, and they appear below another cell or never.
    "RCUTILS_LOGGING_BUFFERED_STREAM": "1",
    # Make messages raise an error if a field is set to a value of the wrong type.
    _CHECK_FIELDS: "1",
}
_DISCOVERY_VARIABLES = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY")


@dataclass(frozen=True, repr=False)
class RosSession:
    """How ROS was started in this kernel.

    Attributes:
        domain: The ROS domain of the kernel's nodes.
        picked: True if ``start_ros`` chose the domain because ``ROS_DOMAIN_ID`` was not set.
    """

    domain: int
    picked: bool

    def __repr__(self) -> str:
        """Return one line, shown if this is the last expression of a cell."""
        line = f"ROS 2 is up on domain {self.domain}."
        if self.picked:
            line += f" To join it from a terminal: export {DOMAIN_VARIABLE}={self.domain}"
        return line


_lock = threading.RLock()
_claim: DomainClaim | None = None


def prepare_environment() -> None:
    """Set the environment variables that ROS needs in a notebook, unless the user has set them.

    With these variables, log lines go to standard output without color codes, the types of message fields are checked,
    and discovery is limited to this computer. Processes that a cell starts inherit the variables.
    """
    for name, value in _DEFAULTS.items():
        os.environ.setdefault(name, value)
    if not any(os.environ.get(name) for name in _DISCOVERY_VARIABLES):
        os.environ[_DISCOVERY_VARIABLES[0]] = "LOCALHOST"
    if os.environ[_CHECK_FIELDS] == "1":
        _check_fields_of_imported_messages()


def _check_fields_of_imported_messages() -> None:
    """Switch on type checks in generated message modules that were imported before the variable was set.

    When such a module is imported, it copies the variable into a global, which the constructors of its messages read
    (``rosidl_generator_py/resource/_msg.py.em``). This function changes the global.
    """
    for module in list(sys.modules.values()):
        names = getattr(module, "__dict__", {})
        if names.get("ros_python_check_fields") == "":
            names["ros_python_check_fields"] = "1"


def start_ros() -> RosSession:
    """Start ROS in this kernel. If ROS already runs, change nothing. Return how ROS was started.

    The ROS domain is taken from ``ROS_DOMAIN_ID``. If this variable is not set, a free domain is chosen, reserved until
    the kernel ends, and written to the variable, so that processes started from the notebook use the same domain. ROS
    gets no signal handlers: interrupting the kernel stops the cell and not the nodes. After ``rclpy.shutdown()``, this
    function starts ROS again.

    Raises:
        ValueError: ``ROS_DOMAIN_ID`` is not a valid domain number.
        NoFreeDomainError: Every domain on this computer is in use.
    """
    with _lock:
        prepare_environment()
        if ok():
            _drop_signal_handlers()
        else:
            # If the default context was shut down, this makes rclpy create a new one.
            try_shutdown()
            rclpy.init(args=[], domain_id=_session_domain(), signal_handler_options=SignalHandlerOptions.NO)
        domain = get_default_context().get_domain_id()
        os.environ[DOMAIN_VARIABLE] = os.environ.get(DOMAIN_VARIABLE) or str(domain)
        return RosSession(domain=domain, picked=_claim is not None and _claim.domain == domain)


def _drop_signal_handlers() -> None:
    """Remove the signal handlers of an earlier ``rclpy.init()``, which would end ROS when the kernel is interrupted."""
    if get_current_signal_handlers_options() != SignalHandlerOptions.NO:
        uninstall_signal_handlers()


def _session_domain() -> int:
    global _claim
    domain = domain_from_environment()
    if domain is None:
        if _claim is None:
            _claim = claim_free_domain()
        domain = _claim.domain
    return domain


# This exit handler is registered before that of background.py and therefore runs after it: nodes end first, then ROS.
atexit.register(try_shutdown)
