"""The judge's clients, as a scenario sees them: what calls a service or an action of the subject's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping


class Caller(Protocol):
    """A client of the judge's for one service. Its calls are numbered from 0.

    It writes the events ``servers`` (how many serve the name), ``asked`` and ``answered``.
    """

    def await_server(self, within: float) -> bool:
        """Wait until it may call; False where nobody serves name and type in ``within`` seconds."""
        ...

    def ask(self, *requests: Mapping[str, Any]) -> None:
        """Send requests, one right after the other, without waiting for an answer."""
        ...

    def await_answers(self, quiet: float) -> bool:
        """Wait until every call is answered; False where nothing at all happened for ``quiet`` seconds."""
        ...


class ActionCaller(Protocol):
    """A client of the judge's for one action. Its goals are numbered from 0.

    It writes the events ``servers``, ``goal_sent``, ``goal_answer``, ``feedback_heard``, ``cancel_sent``,
    ``cancel_answer`` and ``result_heard``, each but the first with the number of its goal.
    """

    def await_server(self, within: float) -> bool:
        """Wait until it may send goals; False where nobody serves name and type in ``within`` seconds."""
        ...

    def send_goal(self, **fields: Any) -> int:
        """Send a goal, and ask for its result once it is accepted; its number."""
        ...

    def cancel(self, goal: int) -> None:
        """Ask to cancel a goal."""
        ...
