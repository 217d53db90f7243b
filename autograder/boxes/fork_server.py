"""Fork servers: processes that have made the slow imports, and fork a child for each connection.

``python -P -m autograder.boxes.fork_server MODE MODULE DESCRIPTOR [WORD...]``: ``MODULE`` has two functions:
``prepare``, called once with the words, and ``run``, called in each child. In the mode ``inside``, the child first
enters the box named in the request (:mod:`autograder.boxes.process_isolation`). In the mode ``beside``, ``run`` gets
the connection itself.

Forking is safe because this process starts with a clean environment, and makes no thread and no ROS context. (LTTng,
which rclpy loads, has two threads, but they sleep until a tracing daemon runs.) Each child reads its request itself, so
the memory with which the next kernel begins contains no data of an earlier submission. The process ends when its
standard input ends, and its children end with it.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import importlib
import os
import select
import signal
import socket
import subprocess
import sys
import traceback
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from autograder.boxes.box_connection import Channel
from autograder.boxes.process_isolation import enter
from autograder.boxes.run_limits import raise_own
from autograder.boxes.visible_host import base_environment
from autograder.process_trees import end_soon
from autograder.safe_files import HeldFolder
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

BESIDE, INSIDE = "beside", "inside"
FOLDER_PREFIX = "autograder-held-"
"""The prefix of the names of the fork servers' folders.

Folders of older versions have another prefix and no lock, so they are never removed.
"""
_LIBRARY_FOLDERS = 8
"""The maximum number of folders for libraries, which is more than any workspace of the course needs."""
SUPERVISOR_MODULE = "autograder.boxes.box_supervisor"
KERNEL_MODULE = "autograder.execution.kernel_process"
PROGRAM_MODULE = "autograder.execution.program_process"
_GOODBYE_SECONDS = 3.0
RCLPY = (
    "rclpy",
    "rclpy.action",
    "rclpy.callback_groups",
    "rclpy.executors",
    "rclpy.node",
    "rclpy.parameter",
    "rclpy.qos",
    "rclpy.task",
)
INTERFACES = (
    "action_msgs.msg",
    "action_msgs.srv",
    "geometry_msgs.msg",
    "nav_msgs.msg",
    "rcl_interfaces.msg",
    "rcl_interfaces.srv",
    "rosgraph_msgs.msg",
    "sensor_msgs.msg",
    "std_msgs.msg",
    "std_srvs.srv",
    "type_description_interfaces.msg",
)
_MIDDLEWARE = "librmw_fastrtps_cpp.so"


def library_folders(address: str) -> list[Path]:
    """Return the folders in which the forks of a fork server first look for libraries.

    The list is fixed because the loader reads it only once, before it is known which box a fork will enter. Outside a
    box, the folders are empty. In a box, they are links to the box's folders with libraries, which a student may have
    made. Such libraries can do no harm, because a process that enters a box loads nothing by name before it has given
    up its rights.

    Args:
        address: The socket address of the fork server.
    """
    return [Path(f"{address}.libraries-{number}") for number in range(_LIBRARY_FOLDERS)]


def main(arguments: list[str]) -> None:
    """Serve requests until standard input ends.

    Args:
        arguments: The mode, the module, the descriptor of the listening socket, and the words for the module.
    """
    raise_own()
    mode, name, descriptor, *words = arguments
    listener = socket.socket(fileno=int(descriptor))
    module = importlib.import_module(name)
    module.prepare(*words)
    gc.collect()
    # Exclude the objects that exist now from garbage collection in the children, so that their memory stays shared.
    gc.freeze()
    # The exit status of a child is not needed, so no zombie has to be kept.
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    while True:
        watched: list[Any] = [listener, 0]
        ready, _, _ = select.select(watched, [], [])
        if 0 in ready and not os.read(0, 1):
            _tidy(listener.getsockname())
            return
        if listener in ready:
            connection, _ = listener.accept()
            if os.fork() == 0:
                _child(mode, module, listener, connection)
            connection.close()


def _tidy(address: str) -> None:
    """Remove the socket and its folder, because the process that made them may have been killed."""
    socket_file = Path(address)
    with contextlib.suppress(OSError):
        socket_file.unlink(missing_ok=True)
        for folder in library_folders(address):
            if folder.is_dir():
                folder.rmdir()
        if socket_file.parent.name.startswith(FOLDER_PREFIX):
            socket_file.parent.rmdir()


def _child(mode: str, module: Any, listener: socket.socket, connection: socket.socket) -> None:
    code = 1
    try:
        listener.close()
        null = os.open(os.devnull, os.O_RDWR)
        os.dup2(null, 0)
        os.dup2(null, 1)
        os.close(null)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        channel = Channel(connection)
        if mode == INSIDE:
            enter(channel, module.run)
        else:
            module.run(channel)
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(code)


def preload(modules: Iterable[str]) -> None:
    """Import modules, and skip those that cannot be imported. Code that needs such a module reports the error later."""
    for name in modules:
        with contextlib.suppress(Exception):
            importlib.import_module(name)


def preload_ros(interfaces: Iterable[str]) -> None:
    """Load the type support of interfaces, and everything that the first node and the first log line would load.

    Args:
        interfaces: The names of modules with generated interfaces.
    """
    for name in interfaces:
        with contextlib.suppress(ImportError):
            for kind in list(vars(importlib.import_module(name)).values()):
                load = getattr(type(kind), "__import_type_support__", None)
                if load is not None:
                    load()
    with contextlib.suppress(OSError):
        # rclpy.init would load this library in each child. Load it now, so that each child has it already.
        ctypes.CDLL(_MIDDLEWARE)
    with contextlib.suppress(ImportError):
        # For a process's first log line, rclpy searches the files of all modules for the caller
        # (rclpy/impl/rcutils_logger.py), and inspect.getmodule remembers them. In a kernel this takes 46 ms of
        # processor time, but only 8 ms if it was done here before the fork.
        importlib.import_module("rclpy.impl.rcutils_logger").CallerId()


class ForkServer:
    """A fork server that this process started. It ends when :meth:`stop` is called or when this process ends.

    Args:
        mode: ``BESIDE`` or ``INSIDE``; see :mod:`autograder.boxes.fork_server`.
        module: The module that it serves.
        address: The path of the socket to create. It must not be visible in any box.
        extra: More environment variables, which are set while modules are imported.
        words: The arguments for the module's ``prepare``. The children can read them and the environment.
    """

    def __init__(
        self,
        mode: str,
        module: str,
        address: Path,
        extra: Mapping[str, str] | None = None,
        words: Sequence[str] = (),
    ) -> None:
        raise_own()  # so that no box can keep this process from sending descriptors to the server
        self.address = str(address)
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
            listener.bind(self.address)
            # Clients can connect from now on, but they are served only once the imports are done.
            listener.listen(128)
            arguments = ("-m", "autograder.boxes.fork_server", mode, module, str(listener.fileno()), *words)
            variables = {**base_environment(), "PYDEVD_DISABLE_FILE_VALIDATION": "1", **(extra or {})}
            if mode == BESIDE:
                variables["PATH"] = os.environ.get(
                    "PATH", os.defpath
                )  # a box may not see bubblewrap's folder
            self._process = python_child(*arguments, environment=variables).start(
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=(listener.fileno(),),
                # Ctrl-C must reach only the grader, which then ends its boxes in an orderly way.
                start_new_session=True,
            )

    @property
    def alive(self) -> bool:
        """True if the process still runs."""
        return self._process.poll() is None

    def stop(self) -> None:
        """End the server and all its children. This may be called twice."""
        assert self._process.stdin is not None
        with contextlib.suppress(OSError):
            self._process.stdin.close()
        end_soon(self._process, _GOODBYE_SECONDS)
        with contextlib.suppress(OSError):
            os.unlink(self.address)  # noqa: PTH108


@dataclass(frozen=True)
class Addresses:
    """The addresses of the fork servers.

    Attributes:
        supervisors: The address used by :class:`autograder.boxes.sandbox.Enclosure`; empty without a sandbox.
        kernels: The address used by :class:`autograder.execution.jupyter_kernel.Kernel`.
        judges: The address used to start judges.
        programs: The address used by :meth:`autograder.boxes.sandbox.Enclosure.ros2`; empty without a sandbox, and
            before :meth:`ForkServers.with_programs`.
    """

    supervisors: str
    kernels: str
    judges: str
    programs: str = ""


class ForkServers:
    """The fork servers of a batch, which are started together, except that for programs.

    Args:
        judge_module: The module that the judges' fork server serves. It is a parameter, because boxes do not import
            the judge.
        boxed: True to start the fork server for supervisors, too.
        environment: More environment variables for all fork servers except that for supervisors. They are set here
            because libraries read some variables when they are loaded.
        of_judges: More environment variables for the judges only, such as the folder of the course.
        interfaces: The modules of the course's interfaces, which are imported before the forks, so that a kernel starts
            faster. No other module of the course is imported.
    """

    def __init__(
        self,
        judge_module: str,
        *,
        boxed: bool,
        environment: Mapping[str, str] | None = None,
        of_judges: Mapping[str, str] | None = None,
        interfaces: Sequence[str] = (),
    ) -> None:
        of_judges = {**(environment or {}), **(of_judges or {})}
        self._environment = environment
        self._servers: list[ForkServer] = []
        with contextlib.ExitStack() as self._open:
            folder = HeldFolder(FOLDER_PREFIX)
            self._open.callback(folder.remove)
            place = folder.path
            kernels = self._keep(
                ForkServer(INSIDE, KERNEL_MODULE, place / "kernels", environment, interfaces)
            )
            judges = self._keep(ForkServer(INSIDE, judge_module, place / "judges", of_judges))
            supervisors = ""
            if boxed:
                # The supervisors are started after kernels and judges, so they are stopped before these, and end their
                # boxes in an orderly way.
                supervisors = self._keep(ForkServer(BESIDE, SUPERVISOR_MODULE, place / "supervisors"))
            self.addresses = Addresses(supervisors, kernels, judges)
            self._open = self._open.pop_all()

    def with_programs(self) -> Addresses:
        """Start the fork server for programs unless it runs or there are no boxes, and return all addresses."""
        if self.addresses.supervisors and not self.addresses.programs:
            place = Path(self.addresses.kernels).with_name("programs")
            self.addresses = replace(
                self.addresses, programs=self._keep(_of_programs(place, self._environment))
            )
        return self.addresses

    def _keep(self, server: ForkServer) -> str:
        self._servers.append(server)
        self._open.callback(server.stop)
        return server.address

    @property
    def alive(self) -> bool:
        """True if all fork servers still run."""
        return all(server.alive for server in self._servers)

    def stop(self) -> None:
        """End the fork servers, and all boxes, kernels and judges that they started. This may be called twice."""
        self._open.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


def _of_programs(address: Path, environment: Mapping[str, str] | None) -> ForkServer:
    """Start the fork server for programs, with folders for the libraries of a workspace."""
    folders = library_folders(str(address))
    for folder in folders:
        folder.mkdir()
    given = {**base_environment(), **(environment or {})}.get("LD_LIBRARY_PATH", "")
    path = os.pathsep.join([*map(str, folders), *([given] if given else [])])
    return ForkServer(
        INSIDE,
        PROGRAM_MODULE,
        address,
        {**(environment or {}), "LD_LIBRARY_PATH": path},
        [given, *map(str, folders)],
    )


if __name__ == "__main__":
    main(sys.argv[1:])
