"""The parts of an exercise: plain data, and the words in which a scenario is written.

An exercise module says what to stimulate (a scenario), what must hold (criteria) and which mistakes are known
(mistakes). It drives the judge through the :class:`Bench` protocol and never imports it, so that an exercise
reads like its specification and can be tested without ROS.
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
"""Simulated seconds that pass at once where a scenario does not say more: small beside any period of the course."""


class Pace(StrEnum):
    """The kind of time in which the judge looks at a subject."""

    FAST = "fast"
    """Simulated time is stepped where the subject follows it; counterparts answer as fast as they can."""
    REAL_TIME = "real time"
    """Everything at the pace that the task names. What fails fast is looked at again so."""


@dataclass(frozen=True)
class Finding:
    """The decision on a criterion, with the two halves of the sentence on the card."""

    passed: bool
    expected: str
    seen: str


@dataclass(frozen=True)
class Criterion:
    """One thing that is asked for.

    Attributes:
        name: A stable key.
        title: One line for a person.
        points: Points it carries.
        judge: Decides from the evidence; called once, after the scenario has ended.
    """

    name: str
    title: str
    points: float
    judge: Callable[[Evidence], Finding]


@dataclass(frozen=True)
class Advice:
    """The words of a recognised mistake to the student.

    Attributes:
        text: What happened and why.
        next_step: What to do now.
        traceback: The one that it was told from, which the card shows; empty where it was told from anything else.
    """

    text: str
    next_step: str
    traceback: str = ""


@dataclass(frozen=True)
class Mistake:
    """A known mistake and how to recognise it.

    Attributes:
        key: A stable name, listed in ``docs/mistakes.md``.
        recognise: Gives the advice where the evidence shows this mistake, else None.
        certain: The evidence proves the failure whatever the machine's load was, so a second look in real
            time would only cost the student time.
    """

    key: str
    recognise: Callable[[Evidence], Advice | None]
    certain: bool = False


def mistake(
    key: str, found: Callable[[Evidence], object], text: str, next_step: str, *, certain: bool = False
) -> Mistake:
    """A known mistake that is told in two sentences.

    Args:
        key: A stable name, listed in ``docs/mistakes.md``.
        found: Gives what shows the mistake; anything that is false where the evidence does not show it.
        text: What happened and why; ``{}`` stands for what was found, ``{0[1]}`` for a part of it.
        next_step: What to do now, with the same places.
        certain: The evidence proves the failure whatever the machine's load was.
    """

    def recognise(evidence: Evidence) -> Advice | None:
        shown = found(evidence)
        return Advice(text.format(shown), next_step.format(shown)) if shown else None

    return Mistake(key, recognise, certain)


class Bench(Protocol):
    """The words of a scenario. Every wait ends at an event or at its limit, and says which."""

    pace: Pace
    before: Evidence | None
    """In a second look: what the first one brought."""
    random: Random
    reference: Any
    in_a_cell: bool
    """True if the subject runs in a notebook's kernel, so that somebody may be waiting beside the check cell."""

    def part(self, name: str, **inputs: Any) -> None:
        """Begin a part: a fresh run of the subject; ``inputs`` are written into the transcript."""

    def again(self) -> None:
        """Begin the last part anew: a fresh run, and what was seen of the first one does not count."""

    def keep(self, name: str) -> bool:
        """In a second look: take over a part of the first one in which the subject came to its own end.

        For parts in which nothing depends on the pace. False where there is nothing to take over, where the subject was
        told how long to wait.
        """

    def start(self, *arguments: Any, **options: Any) -> None:
        """Start the subject; a class is made but not yet spun, a command or function runs at once.

        ``options`` are keyword arguments that only a notebook's function understands (a command ignores
        them); for a class, ``threads`` says how many threads spin it.
        """

    def release(self) -> None:
        """Let a held subject spin. Does nothing for a subject that runs already."""

    def await_endpoint(self, role: str, name: str) -> bool:
        """Wait until the subject's endpoint is on the graph and matched.

        Gives up at once when the subject has ended or is known to have made all it makes. A held subject that may make
        it in a callback is released for that.

        Args:
            role: ``"publisher"``, ``"subscription"``, ``"client"``, ``"action_client"``, ``"service"`` or
                ``"action_server"``.
            name: The full name of the topic, service or action.
        """

    def await_node(self) -> bool:
        """Wait until a node of the subject's is on the graph; whether there is one, or was in a subject that ended."""

    def await_sign_of_life(self, within: float) -> bool:
        """Wait until the subject has said something or has a node on the graph; nothing is written down.

        Args:
            within: Seconds of wall time at most; gives up earlier when the subject has ended.
        """

    def listen(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        """Subscribe as the course's listener does: reliable, so that a best-effort talker is found out.

        Args:
            topic: The full name.
            type_name: Such as ``"std_msgs/msg/String"``.
            latched: Ask for what was published before, too (transient local). A publisher that keeps nothing for late
                listeners is not heard at all then, and the mismatch is written down.
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
        """Serve; each request and response goes into the transcript.

        Args:
            service: The full name.
            type_name: Such as ``"std_srvs/srv/Empty"``.
            answer: From the request's fields to the response's.
            hold: Which request's answer is held back until it is released, from 1 on; 0 for none.
        """

    def call(self, service: str, type_name: str) -> Caller:
        """Be a client of the subject's service; each call and answer goes into the transcript."""

    def call_action(self, action: str, type_name: str) -> ActionCaller:
        """Be a client of the subject's action; each goal and what comes back goes into the transcript."""

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

        The answers to goals and cancel requests are sent so many seconds of wall time after the requests.
        """

    def plant(self, name: str, *, publishes: Mapping[str, str], subscribes: Mapping[str, str]) -> None:
        """Put a node of the judge's on the graph for the subject to look at; ``{topic: type}`` for each side."""

    def compare_type(self, service: str, like: str) -> None:
        """Write down whether the type of a service of the subject's has the fields of the type ``like``."""

    def note_its_log(self) -> None:
        """Write down each text of its log once, for the reference output."""

    def seen(self) -> Part:
        """The events of this part so far."""

    def heard(self, topic: str) -> int:
        """The number of messages that arrived on a topic so far in this part."""

    def doubt(self) -> None:
        """Have this look confirmed in real time."""

    def settle(self) -> None:
        """Wait until the subject's executors have taken what was sent to them, as far as they turn at all.

        Without it a busy machine would make a quick subject look slow.
        """

    def await_attention(self) -> None:
        """Wait until the nodes that the judge speaks to are spun and know that it does.

        A best-effort subscription loses what is sent before its own side knows the publisher, however long the
        publisher's side has known it.
        """

    def note_whether_it_spins(self) -> None:
        """Ask the subject's nodes something that any spun node answers; write down when one does not.

        Where one does not, the subject is asked where it hangs, which ends a command.
        """

    def note_where_it_hangs(self) -> None:
        """Write down where the subject's threads are. This ends a command; to be asked last in a part."""

    def run_time(
        self,
        seconds: float,
        *,
        until: Callable[[], bool] | None = None,
        quiet: float | None = None,
        step: float = STEP,
    ) -> bool:
        """Let ``seconds`` of the subject's time pass: simulated ones where it follows, else real ones.

        Args:
            seconds: At most so long.
            until: Stop when this holds.
            quiet: In real time, stop when nothing at all happened for so many seconds.
            step: Simulated seconds that pass at once. A timer with a shorter period is called once a step, so times
                are seen to this precision; each step costs a few milliseconds of the subject's and of the judge's.

        Returns:
            False where simulated time could not go on, because the subject's executor does not turn any more.
        """

    def pass_time(self, seconds: float, role: str, name: str) -> None:
        """Let ``seconds`` pass for a subject that lives in real time, so that its timers do what they would do later.

        Its clock is simulated meanwhile, and its own again afterwards; where it does not follow, the time is real.

        Args:
            seconds: Of the subject's time.
            role: With ``name``: the endpoint whose node is meant.
            name: The full name of a topic, service or action.
        """

    def wait_until(
        self, condition: Callable[[Evidence], bool], within: float, *, quiet: float | None = None
    ) -> bool:
        """Wait for something in the evidence of this part; gives up when the subject has ended.

        Args:
            condition: What to wait for.
            within: Seconds of wall time at most.
            quiet: Give up earlier when nothing at all happened for so many seconds.
        """

    def let_wait(self, seconds: float) -> None:
        """Let the subject wait ``seconds`` of wall time for a server that comes late, or until the subject ends."""

    def watch_graph(self, condition: Callable[[Evidence], bool], within: float) -> bool:
        """The same for what the graph tells of, which is asked again and again: endpoints, and whose they are."""

    def press_ctrl_c(self, within: float) -> bool:
        """Press Ctrl-C, as in the subject's terminal, and wait until it has ended.

        Args:
            within: Seconds of wall time at most.

        Returns:
            Whether it ended by that; False also where it had ended before, and then nothing is pressed.
        """

    def await_end(self, within: float) -> bool:
        """Wait until the subject has ended by itself, at most ``within`` seconds of wall time."""

    def stop(self) -> None:
        """End the subject and take away what the judge put up for this part."""


@dataclass(frozen=True)
class Exercise:
    """One graded behaviour.

    Attributes:
        id: Such as ``"lab_1_2.talker"``.
        title: Its name for a person.
        task: One sentence: what is asked for.
        scenario: Drives the bench through all parts.
        criteria: What must hold, in the order of the card.
        mistakes: Known mistakes, most telling first.
        text: What the text of the task says, sentence by sentence -> the names of the criteria that judge it, with
            blanks between them. A demand that no criterion judges is called not graded in the list below the task.
        remarks: What is worth a word on the card and costs no points; each gives a sentence, or an empty text.
        roles: The endpoints that make up the subject's public face, such as ``("publisher",)``; `record` waits for one.
        limit: Seconds of wall time after which the judge gives up on a check, all looks together. A command, which may
            build first, has more (`autograder/judge/subjects/command.py`).
        arguments: What a command is called with, in words; empty where it takes none.
        sample_arguments: Arguments with which ``record`` looks at the reference solution's interface.
        second_look: Whether what fails fast is looked at again in real time.
        runner: What `autograder.workspaces` does with a path that is given in place of a command; None where a path
            is no subject.
        wraps_commands: Whether commands are run by that runner too.
        recorded: The kinds of events that a reference output keeps; None for all that it keeps of any exercise.
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
