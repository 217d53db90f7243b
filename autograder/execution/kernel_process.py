"""An IPython kernel that is forked by a fork server, and uses the sockets that it is given.

The grader provides the listening sockets. So no folder of the host is open to the box, and no program in the box can
replace a socket. Only two of Jupyter's five channels are used, requests and outputs. The others (control, input,
heartbeat) cannot be reached from outside.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib.util
import os
import random
import sys
from typing import TYPE_CHECKING, Any

import zmq
from ipykernel.kernelapp import IPKernelApp
from traitlets.config import Config

from autograder.boxes.fork_server import INTERFACES, RCLPY, preload, preload_ros
from autograder.execution import kernel_desk
from autograder.execution.kernel_channels import IOPUB, SHELL
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


_PRELOADED = (
    "IPython.core.completer",
    "IPython.core.magics.osm",
    "IPython.core.magics.script",
    "IPython.display",
    "matplotlib_inline",
    "importlib.resources.readers",
    "numpy.random",
    "autograder.notebook",
    "autograder.notebook.checking.check",
    "autograder.notebook.live_robot",
    "autograder.cards.html_rendering",
)
_MAGIC = "autograder.notebook.program_magic"
_PREPARED = (("autograder.cards.html_rendering", "templates"),)
"""For a module, the function of it that is called as soon as the module is imported."""


def prepare(*interfaces: str) -> None:
    """Import what nearly every notebook of the course imports. A missing module is skipped; a notebook will report it.

    Args:
        interfaces: The modules with the course's own interfaces. The process sees nothing else of the course.
    """
    # JupyterLab's debugger is useless without a user, and it makes up a seventh of everything that a kernel imports.
    # ipykernel works without it if it is not installed (ipykernel/debugger.py).
    sys.modules.setdefault("debugpy", None)  # type: ignore[arg-type]
    preload((*RCLPY, *_PRELOADED, *_rehearsed()))
    for name, function in _PREPARED:
        with contextlib.suppress(Exception):
            getattr(importlib.import_module(name), function)()
    preload_ros((*INTERFACES, *interfaces))
    kernel_desk.prepare()


def _rehearsed() -> list[str]:
    """Return the modules that a kernel imports before its first cell has run, found by running a kernel in a child."""
    before = set(sys.modules)
    reading, writing = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.close(reading)
        with contextlib.suppress(BaseException):
            _rehearse()
        names = [name for name in sys.modules if name not in before and name != "__main__"]
        with os.fdopen(writing, "w") as pipe:
            pipe.write("\n".join(names))
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        modules = pipe.read().split()
    os.waitpid(pid, 0)
    return modules


def _rehearse() -> None:
    with HeldFolder("autograder-rehearsal-") as held:
        folder = str(held.path)
        os.environ["IPYTHONDIR"] = folder
        app = _kernel_app(b"rehearsal", f"{folder}/k", {})
        app.initialize([])
        assert app.shell is not None
        app.shell.run_cell("import asyncio\n%time 1 + 1\nassert asyncio")
        # The rehearsed kernel has replaced the standard streams by its own, which send text to a client that does not
        # exist. Restore the streams of this process.
        sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Carry out one of the requests in ``_REQUESTS``.

    Args:
        call: Contains ``request``, the name of the request, and ``words``, its further arguments.
        descriptors: As the request needs them.
    """
    _REQUESTS[call["request"]](descriptors, **call["words"])


def _run_kernel(descriptors: Sequence[int], key: str, address: str) -> None:
    """Run a kernel until it is shut down.

    Args:
        descriptors: The listening sockets of the shell and iopub channels, and a descriptor for other output.
        key: The key that signs the messages.
        address: The first part of the sockets' paths.
    """
    shell, iopub, log = descriptors
    for standard in (1, 2):
        os.dup2(log, standard)
    os.close(log)
    # Give this child its own random numbers. Otherwise numpy would draw the same numbers in all forks.
    random.seed()
    if (numpy_random := sys.modules.get("numpy.random")) is not None:
        numpy_random.seed()
    sys.argv = _arguments()
    app = _kernel_app(key.encode(), address, {SHELL: shell, IOPUB: iopub})
    app.initialize([])
    app.start()
    # Run the exit hooks, which among other things write the last outputs. An interpreter runs them when it exits, but
    # a fork does not.
    atexit._run_exitfuncs()


_REQUESTS: Mapping[str, Callable[..., None]] = {"kernel": _run_kernel, "desk": kernel_desk.serve}
"""What a fork of this server can be asked to be.

A kernel's desk is not forked by the server of the desks for files (:mod:`autograder.boxes.desk_program`). It needs what
a kernel has loaded already, ZeroMQ and Jupyter's protocol, on each machine that has kernels. It also needs more system
calls and a box of its own, which shows the sockets of its kernel only.
"""


def _arguments() -> list[str]:
    """Return the ``sys.argv`` that JupyterLab would set, because some programs in cells parse it."""
    launcher = importlib.util.find_spec("ipykernel_launcher")
    name = launcher.origin if launcher is not None and launcher.origin else "ipykernel_launcher.py"
    return [name, "-f", "kernel.json"]


class _GivenSockets(IPKernelApp):
    """A kernel application that uses the given sockets instead of binding its own."""

    given: Mapping[int, int]
    address: str
    key: bytes

    def init_connection_file(self) -> None:
        """Set the addresses that a connection file would contain."""
        self.transport, self.ip = "ipc", self.address
        self.shell_port, self.iopub_port, self.stdin_port, self.control_port, self.hb_port = 1, 2, 3, 4, 5
        self.session.key = self.key

    def write_connection_file(self, **_: Any) -> None:
        """Do nothing, because no program reads a connection file here."""

    def log_connection_info(self) -> None:
        """Only record the ports, as the base class does. The connection details need not be logged."""
        self._ports = {"shell": 1, "iopub": 2, "stdin": 3, "hb": 5, "control": 4}

    def init_heartbeat(self) -> None:
        """Do nothing, because the grader learns of a kernel's end from the operating system."""
        self.heartbeat = None

    def _try_bind_socket(self, s: Any, port: int) -> int:
        descriptor = self.given.get(port)
        if descriptor is not None:
            s.setsockopt(zmq.USE_FD, descriptor)
            s.bind(f"ipc://{self.address}-{port}")
            s.setsockopt(zmq.USE_FD, -1)
        # Bind also to an address inside the process: the debugger's socket connects to the last address of the shell
        # channel's socket.
        s.bind(f"inproc://channel-{port}")
        return port


def _kernel_app(key: bytes, address: str, given: Mapping[int, int]) -> IPKernelApp:
    config = Config()
    # Write no history file, because no user will press the up key.
    config.HistoryManager.hist_file = ":memory:"
    config.HistoryManager.enabled = False
    config.InteractiveShellApp.extensions = [_MAGIC]
    app = _GivenSockets.instance(config=config)
    app.key, app.address, app.given = key, address, given
    return app
