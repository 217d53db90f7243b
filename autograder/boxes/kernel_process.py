"""A fork of the fork server: an IPython kernel on sockets that it was given.

The listening sockets come from the grader, so that no folder of the host is open to the box, and nothing in the box
can put another socket in their place. Only two of Jupyter's five channels are served: requests and outputs. What
the grader does not use (control, input, heartbeat) is bound to nothing.
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
from autograder.boxes.kernel import IOPUB, SHELL
from autograder.temporary_folders import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


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
    "autograder.notebook.robot.starting",
    "autograder.cards.bundle",
)
_MAGIC = "autograder.notebook.cells.program_files"
_PREPARED = ("autograder.cards.bundle",)
"""The modules of these that have a function ``prepare`` to be called."""


def prepare(*interfaces: str) -> None:
    """Import what nearly every notebook of the course does; what is not there is left to the notebook to miss.

    Args:
        interfaces: The modules with the course's own interfaces. Of the course itself this process sees nothing.
    """
    # JupyterLab's debugger is of no use where nobody sits before the notebook, and a seventh of what a kernel imports.
    # ipykernel does without where it is not installed (ipykernel/debugger.py).
    sys.modules.setdefault("debugpy", None)  # type: ignore[arg-type]
    preload((*RCLPY, *_PRELOADED, *_rehearsed()))
    for name in _PREPARED:
        with contextlib.suppress(Exception):
            importlib.import_module(name).prepare()
    preload_ros((*INTERFACES, *interfaces))


def _rehearsed() -> list[str]:
    """The modules that a kernel imports until its first cell has run; a child becomes a kernel and lists them."""
    before = set(sys.modules)
    reading, writing = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.close(reading)
        with contextlib.suppress(BaseException):
            _rehearse()
        names = [name for name in sys.modules if name not in before and name != "__main__"]
        with os.fdopen(writing, "w") as told:
            told.write("\n".join(names))
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as told:
        found = told.read().split()
    os.waitpid(pid, 0)
    return found


def _rehearse() -> None:
    with HeldFolder("autograder-rehearsal-") as held:
        folder = str(held.path)
        os.environ["IPYTHONDIR"] = folder
        app = _kernel_app(b"rehearsal", f"{folder}/k", {})
        app.initialize([])
        assert app.shell is not None
        app.shell.run_cell("import asyncio\n%time 1 + 1\nassert asyncio")
        # Before the folder goes; the standard streams are those of the kernel by now, and nobody listens.
        sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Be a kernel until it is shut down.

    Args:
        call: ``key``, what messages are signed with; ``address``, the path in the names of the sockets.
        descriptors: Listening sockets of the shell and the iopub channel, and where stray output goes.
    """
    shell, iopub, log = descriptors
    for standard in (1, 2):
        os.dup2(log, standard)
    os.close(log)
    _forget_the_fork()
    sys.argv = _arguments()
    app = _kernel_app(call["key"].encode(), call["address"], {SHELL: shell, IOPUB: iopub})
    app.initialize([])
    app.start()
    # What an interpreter does at its end and a fork does not: hooks, the last outputs among them.
    atexit._run_exitfuncs()


def _arguments() -> list[str]:
    """The ``sys.argv`` that a program in a cell has in JupyterLab, where some meet the kernel's own arguments."""
    launcher = importlib.util.find_spec("ipykernel_launcher")
    name = launcher.origin if launcher is not None and launcher.origin else "ipykernel_launcher.py"
    return [name, "-f", "kernel.json"]


def _forget_the_fork() -> None:
    """Draw anew what a fork has in common with its siblings: random numbers. Python reseeds ``random`` itself."""
    random.seed()
    numpy_random = sys.modules.get("numpy.random")
    if numpy_random is not None:
        numpy_random.seed()


class _GivenSockets(IPKernelApp):
    """A kernel's application that binds nothing of its own."""

    given: Mapping[int, int]
    address: str
    key: bytes

    def init_connection_file(self) -> None:
        """Take the addresses that a connection file would hold."""
        self.transport, self.ip = "ipc", self.address
        self.shell_port, self.iopub_port, self.stdin_port, self.control_port, self.hb_port = 1, 2, 3, 4, 5
        self.session.key = self.key

    def write_connection_file(self, **_: Any) -> None:
        """Nobody reads one."""

    def log_connection_info(self) -> None:
        """Nobody reads that either; the ports are noted as the base class does it."""
        self._ports = {"shell": 1, "iopub": 2, "stdin": 3, "hb": 5, "control": 4}

    def init_heartbeat(self) -> None:
        """The grader hears of a kernel's end from the operating system."""
        self.heartbeat = None

    def _try_bind_socket(self, s: Any, port: int) -> int:
        descriptor = self.given.get(port)
        if descriptor is not None:
            s.setsockopt(zmq.USE_FD, descriptor)
            s.bind(f"ipc://{self.address}-{port}")
            s.setsockopt(zmq.USE_FD, -1)
        # Inside of the process: the debugger's socket connects to whatever the shell was bound to last.
        s.bind(f"inproc://channel-{port}")
        return port


def _kernel_app(key: bytes, address: str, given: Mapping[int, int]) -> IPKernelApp:
    config = Config()
    # No history file: it would be one more thing to write, and nobody will press the up key.
    config.HistoryManager.hist_file = ":memory:"
    config.HistoryManager.enabled = False
    config.InteractiveShellApp.extensions = [_MAGIC]
    app = _GivenSockets.instance(config=config)
    app.key, app.address, app.given = key, address, given
    return app
