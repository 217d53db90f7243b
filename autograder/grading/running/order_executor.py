"""Executes orders on this machine, each in a thread. Both the executor process of a batch and a Dask worker use it.

A thread starts the processes of a notebook, and reads and checks their messages, but runs no student's code itself. The
kernel, the kernel's desk and the judge are forked from fork servers, which serve all orders. Run as a program, this
module is the executor process, which exchanges lines of JSON with the dispatcher over the socket on its standard input.
"""

from __future__ import annotations

import contextlib
import importlib
import sys
import threading
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder import course
from autograder.boxes.fork_server import ForkServers
from autograder.grading.grading_task import Task
from autograder.grading.running.task_execution import JudgeKind, execute, runners_of
from autograder.grading.running.worker_messages import (
    ADDRESS,
    LARGEST_ANSWER,
    Answered,
    Command,
    Failed,
    Give,
    Joined,
    News,
    Offer,
    Order,
)
from autograder.judge import controlled_judge
from autograder.judge.machine_fitness import Patience
from autograder.judge.ros_setup import boxed_ros_environment, lease_domain, ros_environment
from autograder.messages.json_lines import Hangup, Lines
from autograder.process_trees import adopt_orphans, end_descendants

if TYPE_CHECKING:
    from collections.abc import Mapping

    from autograder.boxes.fork_server import Addresses
    from autograder.boxes.run_limits import Left
    from autograder.execution.notebook_processes import BoxedProcesses, UnboxedProcesses


LAST_SECONDS = 10.0
"""Time limit in seconds for the clean-up of the executor process. It matters only if the grader has ended, because a
grader that still runs kills the process earlier.
"""


def judge_kind(name: str, *, boxed: bool) -> JudgeKind:
    """Return the judge for tasks that run in boxes, or without.

    Args:
        name: The Python class of the judge, as ``module:class``.
        boxed: True if judge and subject run in boxes.
    """
    module, _, attribute = name.partition(":")
    return JudgeKind(
        make=getattr(importlib.import_module(module), attribute),
        variables=controlled_judge.environment(boxed=boxed),
        readable=controlled_judge.readable(),
        ros_variables=_ros_variables(boxed=boxed),
        # A box has a network of its own, without other nodes, so any domain is free there.
        lease_domain=(lambda: contextlib.nullcontext(0)) if boxed else lease_domain,
        patient=_patiently,
    )


def _ros_variables(*, boxed: bool) -> Mapping[str, str]:
    return boxed_ros_environment() if boxed else ros_environment()


def _patiently(seconds: float) -> Left:
    """Return a function that returns the seconds left of a limit, which gets longer on an overloaded machine."""
    patience = Patience(seconds)
    return lambda: patience.left


class Executor:
    """Executes orders. Several threads may use it at the same time, each for one order.

    Args:
        scratch: The folder in which each submission gets its own folder.
    """

    def __init__(self, scratch: Path) -> None:
        self._scratch = scratch
        self._changing = threading.Condition()
        self._running: dict[str, _Running] = {}
        self._fork_servers: dict[bool, ForkServers] = {}
        self._stopped = False

    def execute(self, key: str, data: bytes) -> bytes:
        """Execute an order, and return the execution as JSON.

        Args:
            key: A unique name for the order, with which :meth:`cancel` finds it.
            data: An :class:`autograder.grading.running.worker_messages.Order` as JSON.
        """
        order = msgspec.json.decode(data, type=Order)
        task = msgspec.json.decode(bytes(order.task), type=Task)
        running = _Running()
        with self._changing:
            self._running[key] = running
            # `stop` ended the orders that it knew; this one came while it did so.
            if self._stopped:
                running.end()
        try:
            judge = judge_kind(order.judge, boxed=task.boxed)
            addresses = self.fork_servers(boxed=task.boxed, programs=bool(runners_of(task)))
            execution = execute(task, self._scratch, judge, addresses, running.began)
            answer = msgspec.json.encode(execution)
        # Whatever failed concerns this order alone: the dispatcher decides whether it runs again.
        except Exception as error:
            answer = msgspec.json.encode(task.in_trouble(f"{type(error).__name__}: {error}"))
        finally:
            with self._changing:
                self._running.pop(key, None)
                self._changing.notify_all()
        if len(answer) > LARGEST_ANSWER:
            return msgspec.json.encode(task.in_trouble(f"its result has {len(answer)} bytes"))
        return answer

    def cancel(self, key: str) -> None:
        """End the processes of an order whose answer is no longer needed."""
        with self._changing:
            running = self._running.get(key)
        if running is not None:
            running.end()

    def stop(self) -> None:
        """End the processes of all orders, and the fork servers. An order that comes later fails at once."""
        with self._changing:
            self._stopped = True
            for running in self._running.values():
                running.end()
            self._changing.wait_for(lambda: not self._running, LAST_SECONDS)
            for servers in self._fork_servers.values():
                servers.stop()

    def fork_servers(self, *, boxed: bool, programs: bool = False) -> Addresses:
        """Start the fork servers if they do not run, and return their addresses. Do not wait for their imports.

        Args:
            boxed: True to include the fork server for the supervisors of boxes.
            programs: True to include the fork server for programs, which only some notebooks need.
        """
        with self._changing:
            servers = self._fork_servers.get(boxed)
            if servers is None or not servers.alive:
                if servers is not None:
                    servers.stop()
                servers = self._fork_servers[boxed] = ForkServers(
                    controlled_judge.__name__,
                    boxed=boxed,
                    environment=_ros_variables(boxed=boxed),
                    of_judges=course.variables(),
                    interfaces=course.interface_modules(),
                )
            return servers.with_programs() if programs else servers.addresses


class _Running:
    """An order that is being executed. Any thread may end it."""

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._processes: BoxedProcesses | UnboxedProcesses | None = None
        self._ended = False

    def began(self, processes: BoxedProcesses | UnboxedProcesses) -> None:
        """Remember the boxes of the order, so that :meth:`end` can end them."""
        with self._changing:
            self._processes = processes
            if self._ended:
                processes.abandon()

    def end(self) -> None:
        """End every process in the boxes, so that the execution of the order fails."""
        with self._changing:
            self._ended = True
            if self._processes is not None:
                self._processes.abandon()


def main(arguments: list[str]) -> None:
    """Execute orders until the grader closes the connection.

    Args:
        arguments: The scratch folder, the number of notebooks to execute at the same time, and "boxed" if they will
            be executed in boxes.
    """
    adopt_orphans()
    # A setup.py of a student may cause thousands of these warnings when it is parsed.
    warnings.simplefilter("ignore", SyntaxWarning)
    executor, grader = Executor(Path(arguments[0])), Lines.with_parent()
    # Start the fork servers now: they import their modules while the grader prepares the first order.
    executor.fork_servers(boxed="boxed" in arguments[2:])
    offer = msgspec.json.encode(Offer("", int(arguments[1]), ""))
    with contextlib.suppress(Hangup):
        grader.say_json(msgspec.json.encode(Joined(ADDRESS, ADDRESS, offer)))
        while True:
            command = msgspec.json.decode(grader.hear_json(), type=Command)
            if isinstance(command, Give):
                threading.Thread(target=_answer, args=(executor, grader, command), daemon=True).start()
            else:
                executor.cancel(str(command.number))
    executor.stop()
    end_descendants()


def _answer(executor: Executor, grader: Lines, give: Give) -> None:
    news: News
    try:
        news = Answered(give.number, executor.execute(str(give.number), give.order))
    except BaseException as error:  # answer with the error, because the dispatcher waits for an answer
        news = Failed(give.number, f"{type(error).__name__}: {error}")
    with contextlib.suppress(Hangup):
        grader.say_json(msgspec.json.encode(news))


if __name__ == "__main__":
    main(sys.argv[1:])
