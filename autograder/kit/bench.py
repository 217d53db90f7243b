"""The interface with which an exercise's scenario is written.

A scenario uses the judge only through :class:`Bench` and never imports it. So an exercise reads like its specification,
and can be tested without ROS.
"""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Any, Protocol

from autograder.kit.counterparts import Qos

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Mapping
    from random import Random

    from autograder.kit.counterparts import ActionCaller, ActionCounterpart, Caller, Server, Speaker, Work
    from autograder.kit.evidence import Evidence, Part

STEP = 0.05
"""The default length of one step in simulated seconds, which is short compared with every period in the course."""


class Pace(StrEnum):
    """How fast a look goes: in simulated time if possible, or in real time."""

    FAST = "fast"
    """The judge steps simulated time if the subject follows it, and its counterparts answer as fast as they can."""
    REAL_TIME = "real time"
    """Everything happens in real time, with the delays that the task describes. The second look at a subject that
    failed at the fast pace is like this.
    """


class Bench(Protocol):
    """The methods with which a scenario is written. Each wait has a time limit, and returns whether it ended before."""

    pace: Pace
    before: Evidence | None
    """In the second look, the evidence of the first one; else None."""
    random: Random
    reference: Any
    in_a_cell: bool
    """True if the subject runs in a notebook's kernel, so that a student may be waiting for the check cell to finish.
    """
    is_waited_for: bool
    """True if a student waits for the card, which grows with each part: then the shortest part comes first. In a class,
    it may not, because a subject must not know what its first run is about.
    """

    def part(self, name: str, **inputs: Any) -> None:
        """Begin a part, which is a new run of the subject. ``inputs`` are stored in the part's record."""

    def again(self, name: str = "") -> None:
        """Begin a part again with a new run of the subject; the last part if no name is given.

        The record of the earlier run is discarded.
        """

    def leave_out(self, name: str) -> None:
        """Discard the record of a part, because a class's check would not have made it."""

    def keep(self, name: str) -> bool:
        """In the second look, reuse a part of the first look in which the subject ended by itself. Return True if so.

        Use this for parts whose result does not depend on the pace. But a part is always run again if the subject was
        told how long to wait, because then its result depends on the pace.
        """

    def start(self, *arguments: Any, **options: Any) -> None:
        """Start the subject. A class is instantiated but not yet spun; a command or function runs at once.

        ``options`` are keyword arguments for a notebook's function; a command ignores them. For a class, ``threads``
        is the number of threads that spin it.
        """

    def release(self) -> None:
        """Let the subject spin if it does not spin yet."""

    def await_endpoint(self, role: str, name: str) -> bool:
        """Wait until the subject's endpoint is on the ROS graph and matched with the judge's.

        The wait ends early once the subject has ended, or is known to have made all its endpoints. If a class of a
        notebook is not yet spun and may make the endpoint in a callback, it is spun from then on.

        Args:
            role: ``"publisher"``, ``"subscription"``, ``"client"``, ``"action_client"``, ``"service"`` or
                ``"action_server"``.
            name: The full name of the topic, service or action.
        """

    def await_node(self) -> bool:
        """Wait for a node of the subject. Return True if one is, or was, on the ROS graph."""

    def await_sign_of_life(self, within: float) -> bool:
        """Wait until the subject has printed something or has a node on the graph. This records nothing.

        Args:
            within: The limit in seconds of wall time. The wait ends earlier if the subject ends.
        """

    def listen(self, topic: str, type_name: str, *, qos: Qos = Qos.DEFAULT) -> None:
        """Subscribe to a topic, by default with reliable QoS like the course's listener.

        From a publisher whose QoS does not match, nothing is received, and the mismatch is recorded.

        Args:
            topic: The full name of the topic.
            type_name: The message type, such as ``"std_msgs/msg/String"``.
            qos: ``Qos.LATCHED`` requests earlier messages, too.
        """

    def speak(self, topic: str, type_name: str, *, qos: Qos = Qos.DEFAULT) -> Speaker:
        """Create a publisher. A subscription whose QoS does not match gets nothing, and the mismatch is recorded.

        For the arguments see :meth:`listen`.
        """

    def serve(
        self,
        service: str,
        type_name: str,
        answer: Callable[[Mapping[str, Any]], Mapping[str, Any]],
        *,
        hold: int = 0,
        late: Mapping[int, float] = ...,
        never: Container[int] = (),
    ) -> Server:
        """Serve a service, and record each request and response.

        Args:
            service: The full name of the service.
            type_name: The service type, such as ``"std_srvs/srv/Empty"``.
            answer: Returns the fields of the response, given the fields of the request.
            hold: The number of the request, counted from 1, that is not answered until :meth:`Server.release` is
                called; 0 for none.
            late: The requests that are answered late, with the delay in seconds of the subject's time. The answers are
                sent while :meth:`run_time` lets time pass.
            never: The requests that are never answered.
        """

    def call(self, service: str, type_name: str) -> Caller:
        """Make a client for the subject's service, and record each call and each answer."""

    def call_action(self, action: str, type_name: str) -> ActionCaller:
        """Make a client for the subject's action, and record each goal and everything that comes back."""

    def serve_action(
        self,
        action: str,
        type_name: str,
        *,
        accept_goal: bool = True,
        accept_cancel: bool = True,
        goal_answer_takes: float = 0.0,
        cancel_answer_takes: float = 0.0,
    ) -> ActionCounterpart:
        """Make an action server that does only what the scenario tells it to.

        ``goal_answer_takes`` and ``cancel_answer_takes`` are the delays of the answers, in seconds of wall time.
        """

    def serve_goals(self, action: str, type_name: str, work: Callable[[Mapping[str, Any]], Work]) -> None:
        """Serve an action for any number of goals, also at once. They go on while :meth:`run_time` lets time pass.

        Each is recorded as ``goal``, ``goal_answered``, ``feedback``, ``cancel`` and ``result``, with its number, which
        counts from 1.

        Args:
            action: The full name of the action.
            type_name: The action type, such as ``"my_robot_interfaces/action/Fibonacci"``.
            work: Returns what to do with a goal, given its fields.
        """

    def plant(
        self,
        name: str,
        *,
        publishes: Mapping[str, str],
        subscribes: Mapping[str, str],
        qos: Qos = Qos.DEFAULT,
    ) -> None:
        """Put a decoy node on the ROS graph for the subject to find.

        Args:
            name: The name of the node.
            publishes: The topics of its publishers, with their types, and the actions of its servers, with theirs.
            subscribes: The topics of its subscriptions, with their types, and the actions of its clients.
            qos: The QoS of all its endpoints.
        """

    def compare_type(self, service: str, like: str) -> None:
        """Record whether the type of the subject's service has the same fields as the type ``like``."""

    def note_its_log(self) -> None:
        """Record, for the reference output, each text that the subject logs, but only once."""

    def note(self, name: str, **data: Any) -> None:
        """Record an event of the kind ``noted``: a fact that the scenario derives from what it has seen so far.

        Use this for facts that are the same in each run, although the events behind them are not.
        """

    def seen(self) -> Part:
        """Return the events of this part that were recorded so far."""

    def heard(self, topic: str) -> int:
        """Return the number of messages that arrived on a topic so far in this part."""

    def confirm(self) -> None:
        """End the look in real time: it goes as the first one went, whose evidence decides."""

    def doubt(self) -> None:
        """Require a second look in real time to confirm this look.

        Before :meth:`confirm`, it says that a busy machine may be why the look went as the first one.
        """

    def settle(self) -> None:
        """Wait until the subject's executors, if they still spin, have processed everything that was sent to them.

        Without this, a fast subject would look slow on a busy machine.
        """

    def take_in(self) -> None:
        """Wait until the judge has recorded everything that the subject has sent so far."""

    @property
    def moment(self) -> float:
        """The subject's time now, in seconds: simulated time, or the time since the part began."""

    def await_attention(self) -> None:
        """Wait until the subscribing nodes are spun and have discovered the judge's publishers.

        A best-effort subscription loses messages until it has itself discovered the publisher. This may happen long
        after the publisher has discovered the subscription.

        A fast look ends here if no node is spun: the look in real time follows.
        """

    def note_whether_it_spins(self) -> None:
        """Send the subject's nodes a request that every spun node answers, and record whether a node does not answer.

        If a node does not answer, also record the stacks of the subject's threads. If the subject is a command,
        recording its stacks ends it.
        """

    def note_where_it_hangs(self) -> None:
        """Record the stacks of the subject's threads. Call this last, because it ends a subject that is a command."""

    def run_time(
        self,
        seconds: float,
        *,
        until: Callable[[], bool] | None = None,
        quiet: float | None = None,
        step: float = STEP,
    ) -> bool:
        """Let ``seconds`` pass for the subject: in simulated time if the subject follows it, else in real time.

        Args:
            seconds: The maximum number of seconds to pass.
            until: Time stops passing when this function returns True.
            quiet: In real time, stop if no event was recorded for this many seconds.
            step: The length of one step in simulated seconds. A timer with a shorter period fires only once in each
                step. Shorter steps are more precise, but each step costs the judge and the subject a few milliseconds.

        Returns:
            False if simulated time could not go on because the subject's executor no longer spins.
        """

    def pass_time(self, seconds: float, role: str, name: str) -> None:
        """Let ``seconds`` pass quickly for a subject in real time, so that its timers fire now instead of later.

        During this time the subject's clock is simulated; afterwards it is real again. If the subject does not follow
        simulated time, the seconds pass in real time.

        Args:
            seconds: Seconds of the subject's time.
            role: The role of an endpoint of the node whose time passes.
            name: The full name of that endpoint's topic, service or action.
        """

    def wait_until(
        self,
        condition: Callable[[Evidence], bool],
        within: float,
        *,
        quiet: float | None = None,
        paced: bool = False,
    ) -> bool:
        """Wait until a condition on the evidence of this part holds, or until the subject has ended.

        Args:
            condition: Returns True when the wait is over.
            within: The limit in seconds of wall time.
            quiet: If given, give up earlier if no event was recorded for this many seconds.
            paced: True to let the subject's simulated time pass meanwhile, no faster than wall time.
        """

    def let_wait(self, seconds: float) -> None:
        """Let the subject wait ``seconds`` of wall time for a late server, or less if the subject ends earlier."""

    def watch_graph(self, condition: Callable[[Evidence], bool], within: float) -> bool:
        """Poll the ROS graph until a condition on endpoints or their nodes holds. Return True if it held."""

    def press_ctrl_c(self, within: float) -> bool:
        """Press Ctrl-C, as in the subject's terminal, and wait until the subject has ended.

        Args:
            within: The limit in seconds of wall time.

        Returns:
            True if Ctrl-C ended the subject. False if it did not, or if the subject had ended before; then Ctrl-C is
                not pressed.
        """

    def await_end(self, within: float) -> bool:
        """Wait until the subject has ended by itself, at most ``within`` seconds of wall time."""

    def stop(self) -> None:
        """End the subject, and remove everything that the judge made for this part."""
