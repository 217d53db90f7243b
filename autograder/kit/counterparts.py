"""The judge's publishers, servers and clients, as a scenario sees them: whom the subject meets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping


class Speaker(Protocol):
    """A publisher of the judge's."""

    def send(self, **fields: Any) -> None:
        """Publish one message with these fields."""


class Server(Protocol):
    """A service server of the judge's."""

    def release(self) -> None:
        """Give the answer that was held back."""

    def close(self) -> None:
        """Take the service away."""


class ActionCounterpart(Protocol):
    """An action server of the judge's that does only what the scenario tells it to."""

    def await_goal(self, within: float) -> bool:
        """Wait until a goal arrived and was answered; False where none came in ``within`` seconds."""

    def send_feedback(self, **fields: Any) -> None:
        """Send one feedback message for the current goal."""

    def say_status(self) -> None:
        """Say the current goal's status on the action's topic, as a server does when it begins to execute a goal."""

    def await_cancel(self, within: float) -> bool:
        """Wait until somebody asked to cancel the current goal; False where nobody did in ``within`` seconds."""

    def await_result_request(self, within: float) -> bool:
        """Wait until somebody asked for the result."""

    def finish(self, status: str, **fields: Any) -> None:
        """End the goal with ``"succeeded"``, ``"canceled"`` or ``"aborted"`` and this result."""


class Caller(Protocol):
    """A client of the judge's for one service. Its calls are numbered from 0.

    It writes the events ``servers`` (how many serve the name), ``asked`` and ``answered``.
    """

    def await_server(self, within: float) -> bool:
        """Wait until it may call; False where nobody serves name and type in ``within`` seconds."""

    def ask(self, *requests: Mapping[str, Any]) -> None:
        """Send requests, one right after the other, without waiting for an answer."""

    def await_answers(self, quiet: float) -> bool:
        """Wait until every call is answered; False where nothing at all happened for ``quiet`` seconds."""


class ActionCaller(Protocol):
    """A client of the judge's for one action. Its goals are numbered from 0.

    It writes the events ``servers``, ``goal_sent``, ``goal_answer``, ``feedback_heard``, ``cancel_sent``,
    ``cancel_answer`` and ``result_heard``, each but the first with the number of its goal.
    """

    def await_server(self, within: float) -> bool:
        """Wait until it may send goals; False where nobody serves name and type in ``within`` seconds."""

    def send_goal(self, **fields: Any) -> int:
        """Send a goal, and ask for its result once it is accepted; its number."""

    def cancel(self, goal: int) -> None:
        """Ask to cancel a goal."""
