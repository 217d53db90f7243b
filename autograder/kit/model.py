"""The parts of an exercise: plain data, and the methods with which a scenario is written.

An exercise module defines what the judge does (a scenario), what must hold (criteria) and known mistakes (mistakes).
It drives the judge through the :class:`Bench` protocol and never imports it, so that an exercise reads like its
specification and can be tested without ROS.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from random import Random

    from autograder.kit.counterparts import ActionCaller, ActionCounterpart, Caller, Server, Speaker
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.runners import Runner


STEP = 0.05
"""Simulated seconds in one step if the scenario gives no other number: short compared with any period in the course."""


class Pace(StrEnum):
    """The kind of time in which the judge observes a subject."""

    FAST = "fast"
    """Simulated time is stepped if the subject follows it; counterparts answer as fast as they can."""
    REAL_TIME = "real time"
    """Everything happens at the task's pace. A subject that fails fast is observed again like this."""


@dataclass(frozen=True)
class Finding:
    """The decision on a criterion, with the two halves of the sentence on the card."""

    passed: bool
    expected: str
    seen: str


@dataclass(frozen=True)
class Criterion:
    """One requirement.

    Attributes:
        name: A stable key.
        title: A one-line name for people.
        points: The points for it.
        judge: Decides from the evidence; called once, after the scenario has ended.
    """

    name: str
    title: str
    points: float
    judge: Callable[[Evidence], Finding]


@dataclass(frozen=True)
class Advice:
    """The message to the student about a recognized mistake.

    Attributes:
        text: What happened and why.
        next_step: What to do now.
        traceback: The traceback that shows the mistake, for the card; empty if something else showed it.
    """

    text: str
    next_step: str
    traceback: str = ""


@dataclass(frozen=True)
class Mistake:
    """A known mistake, and how to recognize it.

    Attributes:
        key: A stable name, listed in ``docs/mistakes.md``.
        recognise: Returns the advice if the evidence shows this mistake, else None.
        certain: True if the evidence proves the failure whatever the machine's load was, so that a second look in
            real time would only cost time.
    """

    key: str
    recognise: Callable[[Evidence], Advice | None]
    certain: bool = False


def mistake(
    key: str, found: Callable[[Evidence], object], text: str, next_step: str, *, certain: bool = False
) -> Mistake:
    """Make a known mistake that is described in two sentences.

    Args:
        key: A stable name, listed in ``docs/mistakes.md``.
        found: Returns what shows the mistake; anything false if the evidence does not show it.
        text: What happened and why; ``{}`` stands for the value that was found, ``{0[1]}`` for a part of it.
        next_step: What to do now, with the same placeholders.
        certain: True if the evidence proves the failure whatever the machine's load was.
    """

    def recognise(evidence: Evidence) -> Advice | None:
        shown = found(evidence)
        return Advice(text.format(shown), next_step.format(shown)) if shown else None

    return Mistake(key, recognise, certain)


class Bench(Protocol):
    """The methods of a scenario. Every wait ends at an event or at its limit, and returns which."""

    pace: Pace
    before: Evidence | None
    """In a second look: the result of the first one."""
    random: Random
    reference: Any
    in_a_cell: bool
    """True if the subject runs in a notebook's kernel, so that a student may be waiting for the check cell."""

    def part(self, name: str, **inputs: Any) -> None:
        """Begin a part: a fresh run of the subject; ``inputs`` are written into the transcript."""

    def again(self) -> None:
        """Begin the last part again: a fresh run; the record of the first one does not count."""

    def keep(self, name: str) -> bool:
        """In a second look: reuse a part of the first look in which the subject ended by itself.

        For parts in which nothing depends on the pace. Return False if there is no such part, or if the subject was
        told how long to wait.
        """

    def start(self, *arguments: Any, **options: Any) -> None:
        """Start the subject; a class is made but not yet spun, a command or function runs at once.

        ``options`` are keyword arguments that only a notebook's function understands (a command ignores
        them); for a class, ``threads`` says how many threads spin it.
        """

    def release(self) -> None:
        """Let a held subject spin; does nothing if the subject runs already."""

    def await_endpoint(self, role: str, name: str) -> bool:
        """Wait until the subject's endpoint is on the graph and matched.

        Gives up at once when the subject has ended or is known to have made all its endpoints. If a held subject may
        make the endpoint in a callback, it is released.

        Args:
            role: ``"publisher"``, ``"subscription"``, ``"client"``, ``"action_client"``, ``"service"`` or
                ``"action_server"``.
            name: The full name of the topic, service or action.
        """

    def await_node(self) -> bool:
        """Wait for a node of the subject on the graph. Return True if there is one, or was in a subject that ended."""

    def await_sign_of_life(self, within: float) -> bool:
        """Wait until the subject has said something or has a node on the graph; nothing is recorded.

        Args:
            within: Seconds of wall time at most; gives up earlier when the subject has ended.
        """

    def listen(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        """Subscribe as the course's listener does: reliable, so that a best-effort talker is found out.

        Args:
            topic: The full name.
            type_name: Such as ``"std_msgs/msg/String"``.
            latched: True to request earlier messages, too (transient local). Then a publisher that keeps nothing for
                late subscribers is not heard at all, and the mismatch is recorded.
        """

    def speak(self, topic: str, type_name: str) -> Speaker:
        """Create a publisher with the default QoS of the course (reliable, depth 10)."""

    def serve(
        self,
        service: str,
        type_name: str,
        answer: Callable[[Mapping[str, Any]], Mapping[str, Any]],
        *,
        hold: int = 0,
    ) -> Server:
        """Serve; each request and response is recorded.

        Args:
            service: The full name.
            type_name: Such as ``"std_srvs/srv/Empty"``.
            answer: Returns the response's fields for the request's fields.
            hold: The number, from 1, of the request whose answer is held back until it is released; 0 for none.
        """

    def call(self, service: str, type_name: str) -> Caller:
        """Make a client for the subject's service; each call and answer is recorded."""

    def call_action(self, action: str, type_name: str) -> ActionCaller:
        """Make a client for the subject's action; each goal and everything that comes back is recorded."""

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
        """Serve an action whose every step the scenario decides.

        The answers to goals and cancel requests are sent this many seconds of wall time after the requests.
        """

    def plant(self, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str]) -> None:
        """Put a node of the judge on the graph for the subject to look at; ``{topic: type}`` for each side."""

    def compare_type(self, service: str, like: str) -> None:
        """Record whether the subject's service type has the fields of the type ``like``."""

    def note_its_log(self) -> None:
        """Record each different text of its log once, for the reference output."""

    def seen(self) -> Part:
        """Return the events of this part so far."""

    def heard(self, topic: str) -> int:
        """Return the number of messages that arrived on a topic so far in this part."""

    def doubt(self) -> None:
        """Require that this look is confirmed in real time."""

    def settle(self) -> None:
        """Wait until the subject's executors have taken what was sent to them, if they still spin.

        Without it a busy machine would make a quick subject look slow.
        """

    def await_attention(self) -> None:
        """Wait until the nodes that the judge publishes to are spun and have discovered the judge.

        A best-effort subscription loses messages until its own side has discovered the publisher, however long the
        publisher has known the subscription.
        """

    def note_whether_it_spins(self) -> None:
        """Send the subject's nodes a request that any spun node answers; record if one does not answer.

        In that case the subject is asked for its stacks, which ends a command.
        """

    def note_where_it_hangs(self) -> None:
        """Record the stacks of the subject's threads. This ends a command, so do it last in a part."""

    def run_time(
        self,
        seconds: float,
        *,
        until: Callable[[], bool] | None = None,
        quiet: float | None = None,
        step: float = STEP,
    ) -> bool:
        """Let ``seconds`` of the subject's time pass: simulated time if it follows, else real time.

        Args:
            seconds: The most seconds to pass.
            until: Stop when this returns True.
            quiet: In real time, stop when nothing at all happened for this many seconds.
            step: Simulated seconds in one step. A timer with a shorter period is called once a step, so times have
                this precision; each step costs a few milliseconds on both sides.

        Returns:
            False if simulated time could not go on, because the subject's executor no longer spins.
        """

    def pass_time(self, seconds: float, role: str, name: str) -> None:
        """Let ``seconds`` pass for a subject in real time, so that its timers do now what they would do later.

        Its clock is simulated meanwhile, and real again afterwards; if it does not follow, the time is real.

        Args:
            seconds: Seconds of the subject's time.
            role: With ``name``: the endpoint whose node is meant.
            name: The full name of a topic, service or action.
        """

    def wait_until(
        self, condition: Callable[[Evidence], bool], within: float, *, quiet: float | None = None
    ) -> bool:
        """Wait for something in the evidence of this part; gives up when the subject has ended.

        Args:
            condition: Returns True when the wait is over.
            within: The limit in seconds of wall time.
            quiet: Give up earlier when nothing at all happened for this many seconds.
        """

    def let_wait(self, seconds: float) -> None:
        """Let the subject wait ``seconds`` of wall time for a late server, or until the subject ends."""

    def watch_graph(self, condition: Callable[[Evidence], bool], within: float) -> bool:
        """Wait likewise for something on the graph, which is polled: endpoints, and the nodes that own them."""

    def press_ctrl_c(self, within: float) -> bool:
        """Press Ctrl-C, as in the subject's terminal, and wait until the subject has ended.

        Args:
            within: The limit in seconds of wall time.

        Returns:
            True if Ctrl-C ended it; False also if it had ended before, in which case nothing is pressed.
        """

    def await_end(self, within: float) -> bool:
        """Wait until the subject has ended by itself, at most ``within`` seconds of wall time."""

    def stop(self) -> None:
        """End the subject and remove what the judge made for this part."""


@dataclass(frozen=True)
class Exercise:
    """One graded behavior.

    Attributes:
        id: Such as ``"lab_1_2.talker"``.
        title: The name for people.
        task: One sentence that states the task.
        scenario: Drives the bench through all parts.
        criteria: The requirements, in the order of the card.
        mistakes: Known mistakes, most telling first.
        text: The sentences of the task's text -> the names of the criteria that judge them, separated by blanks. A
            requirement that no criterion judges is listed as not graded below the task.
        remarks: Functions for remarks on the card that cost no points; each returns a sentence, or an empty text.
        roles: The roles of the subject's endpoints, such as ``("publisher",)``; `record` waits for one of them.
        limit: Seconds of wall time after which the judge gives up on a check, all looks together. A command, which
            may build first, has more (`autograder/judge/subjects/command.py`).
        arguments: A command's arguments, in words; empty if it takes none.
        sample_arguments: Arguments with which ``record`` starts the reference solution to see its interface.
        second_look: True if a subject that fails fast is observed again in real time.
        runner: What `autograder.workspaces` does with a path given instead of a command; None if a path cannot be a
            subject.
        wraps_commands: True if commands are run by that runner, too.
        recorded: The kinds of events that a reference output keeps; None for the kinds that every exercise keeps.
    """

    id: str
    title: str
    task: str
    scenario: Callable[[Bench], None]
    criteria: Sequence[Criterion]
    mistakes: Sequence[Mistake]
    roles: tuple[str, ...]
    limit: float = 60.0
    arguments: str = ""
    sample_arguments: tuple[Any, ...] = field(default=())
    second_look: bool = True
    runner: Runner | None = None
    wraps_commands: bool = False
    recorded: tuple[str, ...] | None = None
    remarks: Sequence[Callable[[Evidence], str]] = ()
    text: Mapping[str, str] = field(default_factory=dict)

    @property
    def points(self) -> float:
        """The points of all criteria together."""
        return sum(criterion.points for criterion in self.criteria)

    def judge_as_one(self, evidence: Evidence, right: str) -> Finding:
        """The first criterion that does not hold; where all hold, that.

        Args:
            evidence: All that was seen.
            right: What was seen where all hold, in a few words.
        """
        findings = [criterion.judge(evidence) for criterion in self.criteria]
        holds = Finding(True, findings[0].expected, right)
        return next((finding for finding in findings if not finding.passed), holds)
