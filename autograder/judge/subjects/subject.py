"""The thing under test, seen from the judge: something that starts, speaks on the wire and perhaps ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from autograder.judge.bench.graph import Endpoint
    from autograder.judge.bench.recorder import Recorder


class Subject(Protocol):
    """A node class or a function in a notebook, or a command.

    Implementations write into the recorder: ``output`` events for each line it prints and ``subject`` events named
    ``constructed``, ``returned``, ``raised`` or ``exited``.
    """

    shares_participant: bool
    """True if one run after the other lives in the same ROS participant."""
    keeper: str
    """The name of a node that keeps this participant and has no endpoint of its own; empty where there is none."""

    def begin(self, domain_id: int) -> None:
        """Called once, before the first run, with the domain of this check."""

    def tell_so_far(self, words: str) -> None:
        """Tell the waiting student, in a sentence, what the judge knows so far. Only a notebook can show it."""

    def renew(self) -> None:
        """Begin the next run with a fresh participant: an old one would meet the judge's new one only slowly."""

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """Wait until the participant of the next run sees what the judge has put up, and nothing of what is gone.

        Each participant learns that by itself and in its own time. A subject must not be told, by what it still sees
        of an earlier run, that a service is there.

        Returns:
            False where that did not come within a generous limit, or nobody says so.
        """

    def start(self, recorder: Recorder, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
        """Start a run."""

    def release(self) -> None:
        """Let a held run spin."""

    def interrupt(self) -> None:
        """Ctrl-C, as a terminal sends it. What ends by that has ended by itself."""

    @property
    def ended(self) -> bool:
        """True if this run has ended by itself."""

    @property
    def marker(self) -> str | None:
        """A topic that appears on the graph after everything the subject made; None where nobody can know."""

    @property
    def may_make_more(self) -> bool:
        """True if it is held and has a timer or a thread, which may make more once it is released."""

    def processes(self) -> frozenset[int]:
        """The ids of the processes that it has started and that live; none where nobody can tell."""

    def stack(self) -> str:
        """The stack of each of its threads, innermost call first, as faulthandler says it; empty where unknown.

        This may end the run, which does not count as ending by itself.
        """

    def stop(self) -> None:
        """End the run, whatever it takes. Afterwards nothing of it lives."""


class InOwnProcesses:
    """The common part of subjects whose runs are processes, each with a ROS participant of its own."""

    shares_participant = False
    keeper = ""
    marker = None
    may_make_more = False

    def processes(self) -> frozenset[int]:
        """Nobody can tell, where they are not this process's children."""
        return frozenset()

    def tell_so_far(self, words: str) -> None:
        """A command has no card."""

    def renew(self) -> None:
        """The next run has a participant of its own in any case."""

    def knows(self, *, there: set[Endpoint], gone: set[Endpoint]) -> bool:
        """A participant of its own has met nobody: it cannot know what is gone."""
        del there, gone
        return True


class CannotStart(RuntimeError):
    """The command does not exist or may not be executed."""
