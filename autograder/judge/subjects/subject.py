"""The interface through which the judge starts, observes and ends a subject."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from autograder.judge.bench.graph import Endpoint
    from autograder.judge.bench.recorder import Recorder


class Subject(Protocol):
    """A class or function in a notebook, a command, a workspace, or a launch file, which the judge observes.

    Implementations write into the recorder: an ``output`` event for each line of output, and ``subject`` events named
    ``constructed``, ``returned``, ``raised`` or ``exited``.
    """

    shares_participant: bool
    """True if all runs share one ROS participant."""
    in_a_notebook: bool
    """True if a check cell, and perhaps a student, waits for the verdict."""
    keeper: str
    """The name of the node that keeps the participant alive and has no endpoints of its own; empty if there is none."""

    def begin(self, domain_id: int) -> None:
        """Prepare for the first run, on the ROS domain of this check. The judge calls this once."""

    def tell_so_far(self, words: str) -> None:
        """Tell the waiting student in one sentence what the judge knows so far. Only a notebook shows this sentence."""

    @property
    def is_building(self) -> bool:
        """True until the packages of a workspace are built for the first time; False if nothing has to be built."""

    def renew(self) -> None:
        """Use a new participant for the next run. An old one discovers the judge's new participant only slowly."""

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Wait until the next run's participant has discovered the judge's new endpoints, and lost the removed ones.

        Without this wait, a subject could still see a service of an earlier run and call it.

        Args:
            there: The new endpoints.
            gone: The removed endpoints.

        Returns:
            False if this did not happen within a generous time limit, or if the notebook does not answer.
        """

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Start a run."""

    def release(self) -> None:
        """Spin the node of this run. Before this call, only the node's constructor has run."""

    def interrupt(self) -> None:
        """Send Ctrl-C, as a terminal does. If the run ends after that, it counts as ended by itself."""

    @property
    def ended(self) -> bool:
        """True if this run has ended by itself."""

    @property
    def marker(self) -> str | None:
        """The name of a topic that is on the graph only after all of the subject's endpoints; None if there is none."""

    @property
    def may_make_more(self) -> bool:
        """True if the node is not spun yet, and its timer or thread may make more endpoints after :meth:`release`."""

    def processes(self) -> frozenset[int]:
        """Return the ids of the running processes that the subject has started; none if they are not known."""

    def stack(self) -> str:
        """Return the stack of each thread, innermost call first, as faulthandler prints it; empty if unknown.

        This may end the run, which then does not count as ended by itself.
        """

    def stop(self) -> None:
        """End the run by any means. Afterwards no process, thread or node of the run is left."""


class InOwnProcesses:
    """Base class of subjects whose runs are separate processes, each with its own DDS participant."""

    shares_participant = False
    in_a_notebook = False
    is_building = False
    keeper = ""
    marker = None
    may_make_more = False

    def processes(self) -> frozenset[int]:
        """Return an empty set: the subject's processes are not children of the judge, so their ids are unknown."""
        return frozenset()

    def tell_so_far(self, words: str) -> None:
        """Do nothing, because a command shows no card while it is checked."""

    def renew(self) -> None:
        """Do nothing, because each run is a new process, which has a new participant anyway."""

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Return True: a new participant has discovered nothing yet, so it cannot see removed endpoints."""
        del there, gone
        return True


class CannotStart(RuntimeError):
    """The command does not exist or is not executable."""
