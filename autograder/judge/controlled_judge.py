"""A judge process that a grader controls: starts it, opens and closes checks, and reads the verdicts.

The judge's side (:func:`prepare` and :func:`run`) runs on inherited file descriptors, as the fork server in the judge's
sandbox starts it.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol, Self

import msgspec

from autograder import course, exercises
from autograder.command_name import COMMAND
from autograder.judge import evidence_files, ros_setup
from autograder.messages.json_lines import Hangup, Lines, Silent, listen
from autograder.messages.judge_messages import Close, Open, Report
from autograder.process_trees import signal_group
from course_runtime.python_child import python_child

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path
    from types import TracebackType


START_LIMIT = 60.0
"""Time limit in seconds of wall time for starting a judge, which takes well under one second on an idle machine."""
ANSWER_LIMIT = 30.0
"""Time limit in seconds of wall time for a judge's answer to an order."""
_REPORT_BYTES = 64_000_000
"""The maximum size of a judge's report in bytes. Every reference output and every verdict with its evidence is smaller.
"""


class JudgeDied(RuntimeError):
    """The judge process has ended or does not answer, so there is no verdict about the subject."""


class _StartedJudge(Protocol):
    """A running judge process, inside or outside a sandbox."""

    def end(self) -> None:
        """End the process and everything that it has forked. A second call does nothing."""
        ...


Start = Callable[[int, int], _StartedJudge]
"""A function that starts a judge. Its arguments are the descriptors of a listening socket for notebooks and of a
connected socket for the grader's orders; the caller closes both.
"""


class JudgeProcess:
    """A judge that the grader controls. Only verdicts in the reports of :meth:`close` become grades."""

    def __init__(self, socket_path: Path, *, seed: str, start: Start | None = None) -> None:
        """Prepare a judge. Entering the context starts it.

        Args:
            socket_path: The path of the Unix socket at which the student's kernel reaches the judge, at most 107 bytes
                (unix(7)).
            seed: The seed of all random inputs. The seed of each exercise is derived from it.
            start: Starts the judge; by default as a plain child process.
        """
        self.socket_path = socket_path
        self._seed = seed
        self.workspaces = ""
        """Path at which the judge reaches the grader's workspace service; empty if there is none."""
        self.keeps_evidence = False
        """True if reports contain the evidence of their verdicts."""
        self.is_boxed = False
        """True if the judge runs in a sandbox next to the sandbox of the submission."""
        self._start = start or _Child
        self._process: _StartedJudge | None = None
        self._orders: Lines | None = None

    def __enter__(self) -> Self:
        """Start the judge's process and wait until it listens.

        Raises:
            JudgeDied: The judge did not start, or not in time.
        """
        own, its_own = socket.socketpair()
        self._orders = Lines(own, _REPORT_BYTES)
        try:
            with its_own, listen(self.socket_path) as listener:
                self._process = self._start(listener.fileno(), its_own.fileno())
            if self._answer(self._orders, START_LIMIT) != b"ready":
                raise JudgeDied("the judge's first message was not 'ready'")
        except (JudgeDied, OSError) as error:
            self.stop()
            raise JudgeDied(f"the judge did not start; `{COMMAND} doctor` says what is missing") from error
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def open(self, exercise_id: str, *, record: bool = False, drawing: str = "") -> None:
        """Allow the notebook to request a single check of this exercise.

        Args:
            record: True to record the subject instead of judging it.
            drawing: As in :class:`autograder.messages.judge_messages.Open`.

        Raises:
            JudgeDied: The judge does not run any more.
        """
        seed = f"{self._seed}:{exercise_id}"
        self._order(
            Open(exercise_id, seed, record, self.workspaces, self.keeps_evidence, self.is_boxed, drawing)
        )

    def close(self) -> Report:
        """End the opened check, and return its report.

        Raises:
            JudgeDied: The judge does not run any more, or its answer is not a report.
        """
        try:
            return msgspec.json.decode(self._order(Close()), type=Report)
        except msgspec.MsgspecError as error:
            raise JudgeDied("the judge's answer is not a report") from error

    def stop(self) -> None:
        """End the judge and everything that it has forked."""
        process, self._process = self._process, None
        orders, self._orders = self._orders, None
        if orders is not None:
            orders.close()
        if process is not None:
            process.end()
        self.socket_path.unlink(missing_ok=True)

    def _order(self, order: Open | Close) -> bytes:
        if self._orders is None:
            raise JudgeDied("the judge was never started, or was stopped")
        try:
            self._orders.say_json(msgspec.json.encode(order))
        except Hangup as error:
            raise JudgeDied("the judge is gone") from error
        return self._answer(self._orders, ANSWER_LIMIT)

    @staticmethod
    def _answer(orders: Lines, limit: float) -> bytes:
        try:
            return orders.hear_json(limit)
        except Silent as error:
            raise JudgeDied("the judge does not answer") from error
        except Hangup as error:
            raise JudgeDied("the judge is gone") from error


class _Child:
    """A judge that runs as a child of this process, without a sandbox."""

    def __init__(self, listener: int, orders: int) -> None:
        words = ("-m", "autograder.judge", "--attached", str(listener), str(orders))
        judge = python_child(*words, environment={**os.environ, **course.variables()})
        self._process = judge.start(
            stdin=subprocess.DEVNULL,
            pass_fds=(listener, orders),
            start_new_session=True,
        )

    def end(self) -> None:
        # The judge exits by itself when its socket for orders is closed.
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=2.0)
        signal_group(self._process.pid, signal.SIGKILL)
        self._process.wait()


def prepare() -> None:
    """Set up ROS for a judge in this process and import everything that a check needs."""
    ros_setup.prepare_judge()
    import_judge()


def run(call: Mapping[str, Any], descriptors: Sequence[int]) -> None:
    """Serve one notebook until the grader disconnects.

    Args:
        call: Empty; the fork server passes this argument to every service.
        descriptors: The listening socket for the notebook, and the socket for the grader's orders.
    """
    from autograder.judge.check_server import JudgeServer

    del call
    os.environ.pop("RMW_IMPLEMENTATION", None)
    sys.stdout = sys.stderr
    listener, control = (socket.socket(fileno=descriptor) for descriptor in descriptors)
    with control.makefile("rb") as orders, control.makefile("wb") as answers:
        JudgeServer(listener, controlled=True).serve(orders, answers)


def environment(*, boxed: bool) -> dict[str, str]:
    """Return the environment variables of a new judge: ROS settings and the folder of the course.

    :func:`autograder.judge.ros_setup.prepare_judge` sets the same ROS variables in a process that already runs.

    ``ROS_LOG_DIR`` is not among them, because the folder for logs is inside the sandbox.
    """
    return {
        **course.variables(),
        **(ros_setup.boxed_ros_environment() if boxed else ros_setup.ros_environment()),
        **ros_setup.OF_THE_JUDGE,
    }


def readable() -> list[Path]:
    """Return the files outside the package that a judge reads: the reference outputs, and what mutants do."""
    paths = (exercises.reference_path, exercises.mutants_path)
    files = [path(exercise_id) for exercise_id in exercises.all_ids() for path in paths]
    return [file for file in files if file.is_file()]


_INTERFACES = (
    "rcl_interfaces/msg",
    "rcl_interfaces/srv",
    "rosgraph_msgs/msg",
    "action_msgs/msg",
    "action_msgs/srv",
    # Every node offers a service from this package. Loading its type costs 5 ms of processor time, so do it in advance.
    "type_description_interfaces/msg",
    "type_description_interfaces/srv",
)
"""The interfaces of the judge's own endpoints."""


def import_judge() -> None:
    """Import the judge, every exercise, and the interfaces of their endpoints with their compiled type supports.

    A check that is forked later then needs no imports. Forking stays safe, because no node and no thread is created
    here.
    """
    importlib.import_module("autograder.judge.check_server")
    # Skip broken exercises: an unfinished exercise must not prevent checks of other exercises.
    types = {name for exercise in exercises.unbroken() for name in _types_of_endpoints(exercise.id)}
    for folder in {*_INTERFACES, *(name.rpartition("/")[0] for name in types)}:
        with contextlib.suppress(ImportError):
            module = importlib.import_module(folder.replace("/", "."))
            for kind in vars(module).values():
                load = getattr(type(kind), "__import_type_support__", None)
                if load is not None:
                    load()


def _types_of_endpoints(exercise_id: str) -> list[str]:
    """Return the types of the endpoints of a reference solution; none if it is not recorded yet."""
    try:
        interface = evidence_files.load_reference(exercise_id, mutants=False).interface
    except evidence_files.NoReference:
        return []
    return [name for endpoints in interface.values() for name in endpoints.values()]
