"""The interface of a subject for the judge: it starts, communicates over ROS, and may end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from autograder.judge.bench.graph import Endpoint
    from autograder.judge.bench.recorder import Recorder


class Subject(Protocol):
    """A subject: a node class or a function in a notebook, or a command.

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
        """Prepare for the first run, on the ROS domain of this check; called once."""

    def tell_so_far(self, words: str) -> None:
        """Tell the waiting student in one sentence what the judge knows so far. Only a notebook shows it."""

    @property
    def is_building(self) -> bool:
        """True until the packages of a workspace are built for the first time; False if nothing has to be built."""

    def renew(self) -> None:
        """Use a new participant for the next run, because an old one would discover the judge's new one only slowly."""

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Wait until the participant of the next run sees the judge's new endpoints and no longer the removed ones.

        Each participant discovers endpoints by itself. Without this wait, a subject could still see a service of an
        earlier run and call it.

        Returns:
            False if the participant did not see this within a generous time limit, or if the notebook does not
            answer.
        """

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Start a run."""

    def release(self) -> None:
        """Let a held run spin its node."""

    def interrupt(self) -> None:
        """Send Ctrl-C, as a terminal does. A run that ends after that counts as ended by itself."""

    @property
    def ended(self) -> bool:
        """True if this run has ended by itself."""

    @property
    def marker(self) -> str | None:
        """A topic that appears on the graph after everything that the subject creates, or None."""

    @property
    def may_make_more(self) -> bool:
        """True if a run is held whose timer or thread may make more endpoints once it is released."""

    def processes(self) -> frozenset[int]:
        """Return the ids of the running processes that the subject has started; none if they are not known."""

    def stack(self) -> str:
        """Return the stack of each thread, innermost call first, as faulthandler prints it; empty if unknown.

        This may end the run, which then does not count as ended by itself.
        """

    def stop(self) -> None:
        """End the run by any means. Afterwards none of its processes, threads and nodes is left."""


class InOwnProcesses:
    """The common part of subjects whose runs are separate processes, each with its own ROS participant."""

    shares_participant = False
    in_a_notebook = False
    is_building = False
    keeper = ""
    marker = None
    may_make_more = False

    def processes(self) -> frozenset[int]:
        """Return an empty set: the subject's processes are not children of this process."""
        return frozenset()

    def tell_so_far(self, words: str) -> None:
        """Do nothing: a command has no card."""

    def renew(self) -> None:
        """Do nothing: each run is a new process, which has a new participant anyway."""

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Return True: a new participant has discovered nothing yet, so it cannot see removed endpoints."""
        del there, gone
        return True


class CannotStart(RuntimeError):
    """The command does not exist or is not executable."""
