"""Python programs run in forks of a process that has imported ROS already: what starting each anew costs is saved.

An answer is judged with half of the processor time: of ten drawn, 0.9 instead of 1.8 s each.

For the bank of answers alone, which runs some thousand small programs. A program still has a process, a session, an
environment and standard streams of its own, ends as it does otherwise and shows the same traceback. What differs:
modules that the judge has imported are there already. So a part of the bank is always run in processes of their own.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import faulthandler
import io
import os
import signal
import socket
import sys
import threading
import time
import traceback
import types
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, NoReturn

from autograder.boxes.channel import Channel, ChannelClosed, close_all
from autograder.judge.subjects.command_subject import CommandSubject
from autograder.process_trees import die_with_parent

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from autograder.judge.subjects.command_subject import Process

_libc = ctypes.CDLL(None)
_OWN = ("autograder", "tests")
"""Packages and modules that a program does not find imported."""


class WarmPython:
    """A process that forks whenever a program is to be run. To be made while this process has no other threads."""

    def __init__(self) -> None:
        own, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._channel = Channel(own)
        self.pid = os.fork()
        if self.pid == 0:
            _end_after(_serve, theirs)
        theirs.close()

    def run(self, arguments: Sequence[str], environment: Mapping[str, str], cwd: Path | None) -> Program:
        """Start a program; the first of the arguments is its file."""
        order = {
            "arguments": list(arguments),
            "environment": dict(environment),
            "cwd": str(cwd or Path.cwd()),
        }
        (out, its_out), (errors, its_errors) = os.pipe(), os.pipe()
        try:
            self._channel.send(order, [its_out, its_errors])
        finally:
            os.close(its_out)
            os.close(its_errors)
        answer, _ = self._channel.receive()
        return Program(answer["pid"], os.fdopen(out, "rb"), os.fdopen(errors, "rb"))


class Program:
    """A running program, as ``subprocess.Popen`` shows one. It is a child of this process."""

    def __init__(self, pid: int, stdout: IO[bytes], stderr: IO[bytes]) -> None:
        self.pid = pid
        self.stdout, self.stderr = stdout, stderr
        self._code: int | None = None
        self._lock = threading.Lock()

    def wait(self) -> int:
        """Wait until it has ended; its exit code, negative where a signal ended it."""
        with contextlib.suppress(ChildProcessError):  # where somebody else has waited for it
            os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOWAIT)
        code = self.poll()
        return 0 if code is None else code

    def poll(self) -> int | None:
        """Its exit code, or None while it runs."""
        with self._lock:
            if self._code is None:
                try:
                    pid, status = os.waitpid(self.pid, os.WNOHANG)
                except ChildProcessError:
                    self._code = -signal.SIGKILL  # somebody has killed it and waited for it
                else:
                    self._code = os.waitstatus_to_exitcode(status) if pid else None
            return self._code

    def send_signal(self, number: int) -> None:
        """Send a signal, if it still runs."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.pid, number)


class WarmScript(CommandSubject):
    """A Python program as a subject, run warm."""

    def __init__(self, warm: WarmPython, command: Sequence[str]) -> None:
        super().__init__(command)
        self._warm = warm

    def _spawn(self, command: Sequence[str], environment: Mapping[str, str]) -> Process:
        return self._warm.run(command[1:], environment, None)

    @property
    def _helpers(self) -> Sequence[int]:
        return (self._warm.pid,)


def _end_after(life: Callable[..., NoReturn], *arguments: Any) -> NoReturn:
    """Live a fork's life, and nothing beyond it.

    Interrupted at its very beginning or end, a program must not go on as the process that it is a fork of: that one
    would tidy up, and take away the file that its next run needs.
    """
    try:
        life(*arguments)
    finally:
        os._exit(1)


def _serve(connection: socket.socket) -> NoReturn:
    """The warm process: never returns, and ends with the process that made it."""
    die_with_parent()
    os.dup2(connection.detach(), 3)
    os.closerange(4, os.sysconf("SC_OPEN_MAX") if os.sysconf("SC_OPEN_MAX") < 65536 else 65536)
    orders = Channel(socket.socket(fileno=3))
    while True:
        try:
            order, streams = orders.receive()
        except ChannelClosed:
            os._exit(0)
        told, telling = os.pipe()
        middle = os.fork()
        if middle == 0:
            maker = os.getpid()
            program = os.fork()
            if program == 0:
                orders.close()
                os.close(told)
                os.close(telling)
                _end_after(_live, order, streams, maker)
            os.write(telling, str(program).encode())
            os._exit(0)
        os.waitpid(middle, 0)  # from here on the program is the judge's child
        orders.send({"pid": int(os.read(told, 100))})
        os.close(told)
        os.close(telling)
        close_all(streams)


def _live(order: Mapping[str, Any], streams: Sequence[int], maker: int) -> NoReturn:
    """The program's whole life, as ``python FILE ARGUMENTS`` lives it."""
    while os.getppid() == maker:  # until it is the judge's child
        time.sleep(0.0002)
    die_with_parent()
    os.setsid()
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    for number, stream in enumerate(streams, 1):
        os.dup2(stream, number)
        os.close(stream)
    os.chdir(order["cwd"])
    os.environ.clear()
    os.environ.update(order["environment"])
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.stdin = io.TextIOWrapper(io.FileIO(0, "r", closefd=False), encoding="utf-8")
    sys.stdout, sys.stderr = (
        io.TextIOWrapper(
            io.FileIO(fd, "w", closefd=False), encoding="utf-8", errors=errors, write_through=True
        )
        for fd, errors in ((1, "strict"), (2, "backslashreplace"))
    )
    sys.__stdout__, sys.__stderr__ = sys.stdout, sys.stderr  # type: ignore[misc]
    faulthandler.enable(2)
    threading.current_thread().name = "MainThread"
    code = _run(Path(order["arguments"][0]), order["arguments"])
    # What an interpreter does at its end, but for its own memory.
    with contextlib.suppress(BaseException):
        threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    for text in (sys.stdout, sys.stderr):
        with contextlib.suppress(BaseException):
            text.flush()
    _libc.fflush(None)  # ROS logs through C's own buffers
    # No destructor of a C++ library may meet the threads and nodes that an interpreter would have ended before it.
    os._exit(code)


def _run(file: Path, arguments: Sequence[str]) -> int:
    for name in [name for name in sys.modules if name.partition(".")[0] in _OWN]:
        del sys.modules[name]
    main = types.ModuleType("__main__")
    main.__dict__.update(__file__=str(file), __builtins__=__builtins__, __spec__=None, __loader__=None)
    sys.modules["__main__"] = main
    sys.argv = list(arguments)
    sys.path[0] = str(file.resolve().parent)
    atexit._clear()
    try:
        exec(compile(file.read_bytes(), str(file), "exec"), main.__dict__)
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return int(end.code or 0) & 0xFF
        print(end.code, file=sys.stderr)
        return 1
    except BaseException as error:
        own = error.__traceback__.tb_next if error.__traceback__ else None
        traceback.print_exception(type(error), error, own)
        return 1
    return 0
