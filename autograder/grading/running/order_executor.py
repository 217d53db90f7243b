"""Executes orders on this machine, each in a thread. Both the executor process of a batch and a Dask worker use it.

A thread starts the processes of a notebook, and reads and checks their messages, but runs no student's code itself. The
kernel, the kernel's desk and the judge are forked from fork servers, which serve all orders. Run as a program, this
module is the executor process, which exchanges lines of JSON with the dispatcher over the socket on its standard input.
"""

from __future__ import annotations

import contextlib
import functools
import os
import sys
import threading
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder import course
from autograder.boxes.fork_server import ForkServers
from autograder.boxes.visible_host import OVERLAYS
from autograder.grading.grading_task import Task
from autograder.grading.running.task_execution import execute, ros_variables, runners_of
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
from autograder.messages.json_lines import Hangup, Lines
from autograder.process_trees import adopt_orphans, end_descendants
from autograder.workspaces.builds.install_folder import with_prefixes

if TYPE_CHECKING:
    from autograder.boxes.fork_server import Addresses
    from autograder.execution.notebook_processes import BoxedProcesses, UnboxedProcesses


LAST_SECONDS = 10.0
"""Time limit in seconds for the clean-up of the executor process. It matters only if the grader has ended, because a
grader that still runs kills the process earlier.
"""


class Executor:
    """Executes orders. Several threads may use it at the same time, each for one order.

    Args:
        scratch: The folder in which each submission gets its own folder.
    """

    def __init__(self, scratch: Path) -> None:
        self._scratch = scratch
        self._changing = threading.Condition()
        self._running: dict[str, BoxedProcesses | UnboxedProcesses | None] = {}
        """The processes of each order, which an order does not have at first."""
        self._ended: set[str] = set()
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
        with self._changing:
            self._running[key] = None
        try:
            addresses = self.fork_servers(boxed=task.boxed, programs=bool(runners_of(task)))
            execution = execute(
                task, order.judge, self._scratch, addresses, functools.partial(self._began, key)
            )
            answer = msgspec.json.encode(execution)
        # Whatever failed concerns this order alone: the dispatcher decides whether it runs again.
        except Exception as error:
            answer = msgspec.json.encode(task.in_trouble(f"{type(error).__name__}: {error}"))
        finally:
            with self._changing:
                self._running.pop(key, None)
                self._ended.discard(key)
                self._changing.notify_all()
        if len(answer) > LARGEST_ANSWER:
            return msgspec.json.encode(task.in_trouble(f"its result has {len(answer)} bytes"))
        return answer

    def cancel(self, key: str) -> None:
        """End the processes of an order whose answer is no longer needed."""
        with self._changing:
            if key in self._running:
                self._end(key)

    def stop(self) -> None:
        """End the processes of all orders, and the fork servers. An order that comes later fails at once."""
        with self._changing:
            self._stopped = True
            for key in self._running:
                self._end(key)
            self._changing.wait_for(lambda: not self._running, LAST_SECONDS)
            for servers in self._fork_servers.values():
                servers.stop()

    def _began(self, key: str, processes: BoxedProcesses | UnboxedProcesses) -> None:
        """Remember the boxes of an order, so that the order can be ended."""
        with self._changing:
            self._running[key] = processes
            # The order may have been canceled before it had boxes, or may have come after `stop`.
            if self._stopped or key in self._ended:
                processes.abandon()

    def _end(self, key: str) -> None:
        """End every process in the boxes of an order, so that the execution of the order fails."""
        self._ended.add(key)
        if (processes := self._running[key]) is not None:
            processes.abandon()

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
                    environment=ros_variables(boxed=boxed),
                    of_judges=course.variables(),
                    interfaces=course.interface_modules(),
                )
            return servers.with_programs() if programs else servers.addresses


def main(arguments: list[str]) -> None:
    """Execute orders until the grader closes the connection.

    Args:
        arguments: The scratch folder, the number of notebooks to execute at the same time, and "boxed" if they will
            be executed in boxes.
    """
    adopt_orphans()
    # The processes that it starts get these variables, as far as they lead to what a box sees.
    overlays = [Path(entry) for entry in os.environ.get(OVERLAYS, "").split(os.pathsep) if entry]
    os.environ.update(with_prefixes(os.environ, overlays))
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
