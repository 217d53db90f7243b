"""A process, forked by a fork server, that runs `ros2 run` and a student's program after their slow imports.

Most of a program's start-up time is spent on imports that all programs share. This process is forked from one that has
already made these imports. It runs the installed script `ros2`, which finds programs as usual, and prints the usual
messages. Only one thing differs: a Python script for this interpreter becomes another fork, not a new process. That
fork has its own arguments, path, standard streams, ``__main__`` and exit, like a new process.

Everything else is started as `ros2 run` starts it: a script for another interpreter, a program in another language,
and a script that has a module or library of its own whose name is already loaded in this process.
"""

from __future__ import annotations

import builtins
import ctypes
import faulthandler
import importlib
import io
import os
import pkgutil
import runpy
import signal
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn

from autograder.boxes.fork_server import INTERFACES, RCLPY, preload, preload_ros
from course_runtime import program_start
from course_runtime.python_child import INTERPRETER, installed_program

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_OF_SCRIPTS = (
    *("course_runtime.ros2_command.main", "course_runtime.ros2_command.real_installation"),
    *("course_runtime.ros2_command.run", "ament_index_python.packages", "importlib.metadata", "re"),
)
"""Modules that are imported by the script `ros2` that the set-up writes, and by the scripts that setuptools makes."""
_AT_START = ("sitecustomize", "usercustomize")
"""The modules that Python imports by itself when it starts (documentation of ``site``)."""
_UNBUFFERED = 2
"""The value of ``_IONBF`` in stdio.h."""
_HEAD = 1024
"""The number of bytes to read of a script to get its first line."""
_FOR_THE_LOADER = "LD_LIBRARY_PATH"
"""The environment variable with the loader's search path (ld.so(8)). The loader reads it only when a process starts.
The folders in it are opened at each search.
"""
_OF_PROCESSORS = "glibc-hwcaps"
"""A folder that the loader searches first, but only if it existed at the loader's first search (ld.so(8))."""
_environment: dict[str, str] = {}
"""The environment of every box."""
_library_folders: list[str] = []
"""The folders that this process's loader searches first; see :func:`autograder.boxes.fork_server.library_folders`."""


def prepare(libraries: str, *library_folders: str) -> None:
    """Import what nearly every program with a node imports.

    Args:
        libraries: The ``LD_LIBRARY_PATH`` of every box.
        library_folders: The folders that come before ``libraries`` in this process's own library path.
    """
    _environment.update({**os.environ, _FOR_THE_LOADER: libraries})
    _library_folders.extend(library_folders)
    _never_unload()
    preload((*RCLPY, *_OF_SCRIPTS))
    preload_ros(INTERFACES)


def _never_unload() -> None:
    """Make this process and its forks exit without unloading shared libraries.

    LTTng, which rclpy loads, would otherwise stop two threads that a fork does not have, and crash
    (``lttng_ust_exit``). Handlers run in reverse order (atexit(3)), so everything imported after this call is cleaned
    up as usual.
    """
    libc = ctypes.CDLL(None)
    libc.on_exit(libc._exit, None)
    libc.__cxa_atexit(libc.fflush, None, None)


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Run `ros2 run` until its program has ended.

    Args:
        call: Contains ``words``, the words after `ros2` on the command line.
        descriptors: The descriptors for standard output and standard error.

    Raises:
        SystemExit: Always, with the exit code of `ros2`.
    """
    (output,) = descriptors
    for standard in (1, 2):
        os.dup2(output, standard)
    os.close(output)
    ros2 = installed_program("ros2")
    sys.argv = [str(ros2), *call["words"]]
    if not ros2.exists():
        os.execvp("ros2", sys.argv)  # the one of the sourced ROS
    program_start.start = _start
    runpy.run_path(str(ros2), run_name="__main__")


def _start(command: Sequence[str]) -> program_start.Process:
    """Start a program: as a fork if the program cannot tell the difference, else as a new process.

    Args:
        command: The program and its arguments.
    """
    given = _python_path(_environment)
    own = [folder for folder in _python_path(os.environ) if folder not in given]
    if (
        not _loads_the_same_libraries()
        or not _is_ours(command[0])
        or _names_in([*own, str(Path(command[0]).parent)]) & {*_imported(), *_AT_START}
    ):
        return subprocess.Popen(command)
    return _Fork(command, [folder for folder in sys.path if folder not in given])


def _loads_the_same_libraries() -> bool:
    """Return True if this process finds each library in the same file as a new process with this environment would."""
    given, wanted = (
        path.split(os.pathsep) if (path := environment.get(_FOR_THE_LOADER)) else []
        for environment in (_environment, os.environ)
    )
    own = wanted[: len(wanted) - len(given)]
    if [*own, *given] != wanted or len(own) > len(_library_folders):
        return False
    leads_there = all(
        os.path.realpath(here) == os.path.realpath(there)
        for here, there in zip(_library_folders, own, strict=False)
    )
    return leads_there and not _names_in(own) & {*_loaded_libraries(), _OF_PROCESSORS}


def _loaded_libraries() -> set[str]:
    """Return the names of the libraries loaded in this process, in the form of :func:`_names_in`."""
    lines = Path("/proc/self/maps").read_text(encoding="utf-8", errors="replace").splitlines()
    return {line.rpartition("/")[2].partition(".")[0] for line in lines if ".so" in line}


def _python_path(environment: Mapping[str, str]) -> list[str]:
    return [folder for folder in environment.get("PYTHONPATH", "").split(os.pathsep) if folder]


def _is_ours(script: str) -> bool:
    """Return True if a file is a Python script for this interpreter, or an archive of one (``zipapp``)."""
    line = _head(Path(script)).split(b"\n")[0]
    return line == f"#!{INTERPRETER}".encode() and pkgutil.get_importer(script) is None


def _head(script: Path) -> bytes:
    with script.open("rb") as file:
        return file.read(_HEAD)


def _imported() -> set[str]:
    return {name.partition(".")[0] for name in sys.modules}


def _names_in(folders: Sequence[str]) -> set[str]:
    """Return the names of all modules and libraries in these folders; a few other names may be among them."""
    return {
        entry.name.partition(".")[0]
        for folder in map(Path, folders)
        if folder.is_dir()
        for entry in folder.iterdir()
    }


class _Fork:
    """A forked program, with those methods of :class:`subprocess.Popen` that `ros2 run` uses."""

    def __init__(self, command: Sequence[str], standard_path: Sequence[str]) -> None:
        self._code: int | None = None
        # Block SIGINT until the fork has its own handler. Before, it has the handler of `ros2 run`, which leaves Ctrl-C
        # to the program.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        self._pid = os.fork()
        if self._pid == 0:
            _be(command, standard_path)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})

    def send_signal(self, number: int) -> None:
        """Send a signal, unless the program has ended."""
        if self._code is None:
            os.kill(self._pid, number)

    def wait(self) -> int:
        """Wait for the program to end. Return the exit code, negative if a signal ended it."""
        if self._code is None:
            _, status = os.waitpid(self._pid, 0)
            self._code = os.waitstatus_to_exitcode(status)
        return self._code


def _be(command: Sequence[str], standard_path: Sequence[str]) -> NoReturn:
    """Run a Python script in this process, until the interpreter ends."""
    script, *_ = command
    # In a new process, Ctrl-C has its default action until Python installs its handler.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if os.environ.get("PYTHONFAULTHANDLER"):
        faulthandler.enable(file=2)
    sys.argv = list(command)
    sys.orig_argv = [INTERPRETER, *command]
    sys.path[:] = [str(Path(script).resolve().parent), *_python_path(os.environ), *standard_path]
    importlib.invalidate_caches()
    _open_standard_streams()
    sys.excepthook = sys.__excepthook__
    ctypes.pythonapi.Py_Exit(_exit_code(script))
    raise AssertionError("Py_Exit does not return")


def _open_standard_streams() -> None:
    """Open the streams as Python does when it starts (config_init_stdio, create_stdio in Python/pylifecycle.c)."""
    at_once = bool(os.environ.get("PYTHONUNBUFFERED"))
    if at_once:  # C code writes ROS's log lines, so C's buffer has to be switched off, too
        libc = ctypes.CDLL(None)
        libc.setvbuf(ctypes.c_void_p.in_dll(libc, "stdout"), None, _UNBUFFERED, ctypes.c_size_t(0))
    for name, number, errors in (("stdout", 1, None), ("stderr", 2, "backslashreplace")):
        old = getattr(sys, f"__{name}__")
        raw = open(number, "wb", buffering=0 if at_once else -1, closefd=False)  # noqa: SIM115
        stream = io.TextIOWrapper(
            raw,
            encoding=old.encoding,
            errors=errors or old.errors,
            line_buffering=number == 2 and not at_once,
            write_through=at_once,
        )
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def _exit_code(script: str) -> int:
    """Run a script as ``__main__``. Return Python's exit code, unless the script has ended the process itself.

    Python's own function for running a script is used, and reports the error that ended the script.
    """
    main = sys.modules["__main__"] = ModuleType("__main__")
    main.__dict__.update(__builtins__=builtins, __annotations__={})
    libc = ctypes.CDLL(None)
    libc.fopen.restype = ctypes.c_void_p
    name = os.fsencode(script)
    file = ctypes.c_void_p(libc.fopen(name, b"rb"))
    if ctypes.pythonapi.PyRun_SimpleFileExFlags(file, name, 1, None) == 0:
        return 0
    if getattr(sys, "last_type", None) is KeyboardInterrupt:
        # As Python does after a KeyboardInterrupt, clean up, and then end this process with SIGINT (Py_RunMain).
        libc.__cxa_atexit(libc["raise"], ctypes.c_void_p(signal.SIGINT), None)
    return 1
