"""Executes tasks on the workers of a Dask cluster: which worker may execute any, and when it gets no more.

A worker of another course could give other grades, and one that a submission has taken over could invent some. So a
worker is asked what it offers before it gets a task; and it gets no more after an answer that no unmodified worker
sends, if it is silent for too long, and if it fails on several notebooks in a row.
"""

from __future__ import annotations

import contextlib
import importlib.util
import re  # noqa: TID251  (the text comes from the instructor)
from collections import Counter
from typing import TYPE_CHECKING

from autograder.boxes.admission import NotAdmitted
from autograder.cards.readable_text import paragraph
from autograder.command_name import COMMAND
from autograder.grading.course_version import course_version
from autograder.grading.grading_errors import GradingError
from autograder.grading.running.process_link import ProcessLink
from autograder.grading.running.task_dispatcher import Dispatcher
from autograder.grading.running.worker_messages import (
    JUDGE,
    LONGEST_WORDS,
    Asked,
    Broken,
    Failed,
    Joined,
    Left,
    News,
    Unfit,
    admitted_offer,
)
from course_runtime.installation import installing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from autograder.execution.executed_cells import Execution
    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.running.dispatched_tasks import Flight
    from autograder.grading.running.execution_backends import Execute


_MOST_TROUBLES = 3
_ADDRESS = re.compile(r"(tcp|tls)://[^\s/]+:\d{1,5}")


def check_dask() -> None:
    """Check that Dask is installed.

    Raises:
        GradingError: Dask is not installed.
    """
    if importlib.util.find_spec("distributed") is None:
        raise GradingError(
            "Grading on a cluster needs Dask, which is not installed here. "
            f"Type: {installing('cluster', clone='--with cluster')}"
        )


def check_address(address: str) -> None:
    """Check that ``address`` has the form of a Dask scheduler's address, such as ``tcp://host:8786``.

    Raises:
        GradingError: The address has another form.
    """
    if not _ADDRESS.fullmatch(address):
        raise GradingError(
            f"{address!r:.200} is not an address of a Dask scheduler. An address looks like tcp://host:8786, "
            "or tls://host:8786 if Dask is set up for TLS."
        )


@contextlib.contextmanager
def on_cluster(
    directory: ClassDirectory, scheduler: str, judge: str, tell: Callable[[str], None]
) -> Iterator[Execute]:
    """Yield a function that executes tasks on the workers of a Dask cluster.

    At the end of the ``with`` block, the tasks that are not finished are canceled within seconds.

    Args:
        scheduler: The scheduler's address, such as ``tcp://host:8786`` or ``tls://host:8786``.
        judge: The Python class that makes a judge, as ``module:class``; empty for the real judge.
        tell: Called with a sentence for the instructor.

    Raises:
        GradingError: No scheduler answers at this address, no worker can execute tasks, or the class names overlays,
            which workers do not have.
    """
    if directory.overlays:
        raise GradingError(
            f"{directory.path / 'class.toml'} names overlays, which the workers of a cluster do not have: grade "
            "without --scheduler."
        )
    with ProcessLink("autograder.grading.cluster.dask_client", scheduler, scratch=None) as link:
        boxed = not directory.is_sandbox_off
        dispatcher = ClusterDispatcher(link, judge or JUDGE, scheduler, boxed=boxed, tell=tell)
        dispatcher.await_workers()
        yield dispatcher.execute_all


class ClusterDispatcher(Dispatcher):
    """Gives the tasks of one batch to the workers of a cluster.

    Args:
        link: The connection to the workers.
        judge: The Python class of the judge, as ``module:class``.
        address: The address of the cluster's scheduler, for messages.
        boxed: True if tasks run in sandboxes. Workers that cannot make sandboxes are then rejected.
        tell: Called with sentences for the instructor, for example that a worker was rejected and why.
    """

    def __init__(
        self, link: ProcessLink, judge: str, address: str, *, boxed: bool, tell: Callable[[str], None]
    ) -> None:
        super().__init__(link, judge)
        self._address, self._boxed, self._tell = address, boxed, tell
        self._names: dict[str, str] = {}
        """The name of each worker in messages, by its address."""
        self._refused: dict[str, str] = {}
        self._troubles: Counter[str] = Counter()
        """The number of consecutive notebooks that a worker could not execute because the grader itself failed."""

    def await_workers(self) -> None:
        """Wait until one worker has been accepted.

        Raises:
            GradingError: The scheduler cannot be reached, no worker exists, or all workers were asked for their
                offers and rejected.
        """
        while not self._workers:
            news = self._link.hear(None)
            if isinstance(news, Asked):
                raise GradingError(self._why_no_worker())
            self._take_in(news)

    def _take_in(self, news: News | None) -> None:
        match news:
            case Joined(address, name, data):
                self._names[address] = _called(address, name)
                if why := self._reason_against(data):
                    self._refuse(address, why)
                    return
            case Unfit(address, name, reason):
                self._names[address] = _called(address, name)
                why = f"the worker could not be asked for its offer ({reason})"
                if "No module named" in reason:
                    why = (
                        f"the worker does not have the autograder ({reason}). Start it with `{COMMAND} worker`, "
                        "or with the Python of the course's .venv"
                    )
                self._refuse(address, why)
            case Left(address) if address in self._workers and self._workers[address].flights:
                called = self._names[address]
                self._tell(f"The worker {called} has ended: the notebooks that it was executing run again.")
            case Failed(number, reason, True) if number in self._flights:
                self._impossible(number, reason)
                return
            case Broken(reason):
                raise GradingError(
                    f"The Dask scheduler at {self._address} cannot be reached ({reason}). Check that it "
                    "runs, and that its address and its TLS settings are right. What was graded so far "
                    "is kept."
                )
        super()._take_in(news)

    def _reason_against(self, data: bytes) -> str:
        """Return why a worker with this offer gets no work; empty if it gets some."""
        try:
            offer = admitted_offer(data)
        except NotAdmitted as error:
            return f"the worker sent an impossible offer: {error}. Check that machine"
        if offer.version != course_version():
            return (
                f"the worker's version of the course is {offer.version:.16}, and here it is {course_version()}. "
                "Bring both machines to the same commit and start the worker again"
            )
        return f"the worker has no sandbox: {offer.obstacle[:500]}" if self._boxed and offer.obstacle else ""

    def _refuse(self, address: str, reason: str) -> None:
        reason = paragraph(reason, LONGEST_WORDS)
        self._refused[address] = f"{self._names[address]}: {reason}"
        self._tell(f"The worker {self._names[address]} gets no work: {reason}.")

    def _exclude(self, address: str, reason: str) -> None:
        """Give no more tasks to an accepted worker, and give the tasks that it was running to other workers."""
        self._forget(address, f"the worker was given no more work: {reason}")
        self._refuse(address, reason)

    def _forget(self, address: str, reason: str) -> None:
        self._refused.pop(address, None)
        self._troubles.pop(address, None)
        super()._forget(address, reason)

    def _take_result(self, flight: Flight, execution: Execution) -> None:
        # Do not count a failure of a task that ran alone: the notebook may be the cause. Several such notebooks run one
        # after the other, so a worker without a fault would seem to fail again and again.
        if not flight.job.alone:
            self._troubles[flight.worker] = self._troubles[flight.worker] + 1 if execution.trouble else 0
        super()._take_result(flight, execution)
        troubles = self._troubles[flight.worker]
        if troubles >= _MOST_TROUBLES and len(self._workers) > 1:
            # For example, a worker with a full disk would fail on each notebook at once, and then get the next one.
            why = f"the worker failed on {troubles} notebooks in a row: {execution.trouble}"
            self._exclude(flight.worker, why)

    def _impossible(self, number: int, reason: str) -> None:
        address = self._flights[number].worker
        for held in self._workers[address].flights:
            self._flights[held].job.attempts -= 1  # does not count: the worker is at fault, not the notebook
        self._exclude(address, f"the worker sent an impossible answer: {reason}. Check that machine")

    def _silent(self, number: int) -> None:
        self._exclude(self._flights[number].worker, "the worker has not answered in time. Start it again")

    def _why_no_worker(self) -> str:
        if not self._refused:
            return (
                f"The Dask scheduler at {self._address} has no workers. "
                f"Start some: {COMMAND} worker {self._address}"
            )
        reasons = "\n".join(f"  {reason}" for reason in self._refused.values())
        return f"No worker of the Dask scheduler at {self._address} can be given work:\n{reasons}"


def _called(address: str, name: str) -> str:
    """Return the name and the address of a worker for a message."""
    return paragraph(address if name == address else f"{name[:100]} ({address})", LONGEST_WORDS)
