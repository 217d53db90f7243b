"""A recipe for a publisher, to which the judge listens in simulated time if possible."""

from __future__ import annotations

from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING

from autograder.kit.bench import STEP, Bench, Pace
from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.in_words import counted
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.role_mistakes import ladder
from autograder.kit.mistakes.silence import GO_ON, NO_MESSAGE, NO_MORE, PUBLISH
from autograder.kit.model import Advice, Finding, Mistake, mistake
from autograder.kit.recipes import published_texts
from autograder.kit.recipes.published_texts import Counting, PublisherSeen
from autograder.kit.rules import ROW, Rate, burst_at_the_start, confirmed, rate_of, simulated_times

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.draft import Judge
    from autograder.kit.evidence import Event, Evidence, Reference

USUAL_PERIOD = 0.5
"""The period in seconds that the judge assumes while it records the reference."""
LONG_STEP = 2 * STEP
"""The length of a step, in simulated seconds, while the judge listens for more messages than at first.

A timer with a shorter period than a step fires once in each step. The judge uses steps of two lengths, so the messages
of such a timer seem uneven, and are checked again in real time.
"""
SILENCE = {Pace.FAST: 3.0, Pace.REAL_TIME: 4.5}
"""The seconds without any event after which the judge stops listening, for each pace.

In Fast DDS, a message that was lost during discovery delays all later messages until the publisher's next heartbeat, 3
s later (``heartbeatPeriod``).
"""
PERSISTENT = 13
"""The number of messages in real time after which the judge assumes that a publisher goes on. It is greater than ten,
because many loops end after ten messages.
"""
LOST = 1
"""The maximum number of messages that a right program may send, on an idle machine, before the judge can receive them.
"""
PERSISTS = 1.0
"""The number of seconds for which a program must still run after the judge has its messages. Simulated time may have
passed within a moment, so this shows whether the program ends.
"""


class Publisher:
    """The recipe for a publisher. Its criteria and mistakes get objects of the type :class:`PublisherSeen`.

    The recipe recognizes the mistakes ``topic_name``, ``message_type``, ``qos_mismatch``,
    ``published_before_discovery``, ``never_published``, ``wrong_rate``, ``stopped_publishing``; with
    :meth:`says_text` also ``field_typo``, ``wrong_text``; with :meth:`counts` also ``counter_stuck``,
    ``counter_start``, ``counter_step``.

    Args:
        messages: The number of messages to wait for at first, in simulated time.
        long_run: The number of messages to wait for in simulated time if they take little time, or if something looks
            wrong. It is larger, because some faults show only late.

    Example::

        heard = Publisher()
        talker = Draft("lab_8_1.talker", "Lab 8.1 · The talker", "Publish a counted greeting every 0.5 s.", heard)
        talker.asks("topic", "Publishes on the right topic", heard.on_topic, points=2)
        talker.asks("text", "Says the right string", heard.says_text(), points=3)
        talker.asks("counter", "Counts up from the start", heard.counts("self.count"), points=2)
        talker.asks("rate", "Keeps the rate", heard.keeps_rate, points=3)
    """

    roles = ("publisher",)

    def __init__(self, messages: int = 8, long_run: int = 20) -> None:
        self._messages = messages
        self._long_run = long_run
        self._text: Judge[PublisherSeen] | None = None  # while it fails, a wrong rate is not diagnosed
        self._course: Judge[PublisherSeen] | None = None  # while it fails, the judge waits for more messages
        self._variable = "self.count"

    # --- the bench -------------------------------------------------------------------------------------------

    def scenario(self, bench: Bench) -> None:
        """Listen until enough messages have arrived, or until twice the time that they need has passed."""
        topic, type_name = bench.reference.only("publisher")
        bench.part("talking")
        bench.listen(topic, type_name)
        bench.start()
        if bench.await_endpoint("publisher", topic):
            bench.release()
            self._hear(bench, topic, _reference_period(bench.reference))
        bench.stop()

    def _hear(self, bench: Bench, topic: str, period: float) -> None:
        enough = self._enough(bench.before) if bench.pace is Pace.REAL_TIME else self._messages
        _listen(bench, topic, enough, period)
        if bench.wait_until(lambda evidence: _lost(evidence, topic) > LOST, 0.0):
            # The judge missed many messages at the start. Either the publisher sent them in a burst, or discovery was
            # slow. Times in real time show which.
            bench.doubt()
        if bench.pace is Pace.FAST and bench.wait_until(self._is_simulated, 0.0):
            enough = self._long_run
            _listen(bench, topic, enough, period, LONG_STEP)
            if not bench.in_a_cell:
                bench.await_end(PERSISTS)
        elif bench.pace is Pace.REAL_TIME and bench.heard(topic) >= enough:
            # One of these messages may be late. So wait for as many further messages, but only until the rate is right.
            bench.wait_until(
                lambda evidence: self.keeps_rate(evidence).passed, self._row(bench.before) * period
            )
        if bench.heard(topic) < enough:
            bench.note_whether_it_spins()

    def _is_simulated(self, evidence: Evidence) -> bool:
        """Return True if at least half as many messages as the judge first waits for follow the simulated clock.

        Half is enough, because the first messages may come before the judge begins to simulate time.
        """
        topic, _ = evidence.reference.only("publisher")
        return len(simulated_times(evidence.main.of("message", topic))) >= self._messages // 2

    def _enough(self, before: Evidence | None) -> int:
        """Return how many messages to wait for in real time.

        If the first look received enough messages in simulated time, wait only for as many as show the rate. Otherwise
        wait for as many as show that the publisher goes on.
        """
        return self._row(before) if before is not None and self._is_simulated(before) else PERSISTENT

    def _row(self, before: Evidence | None) -> int:
        """Return how many successive messages must come at the right rate in real time.

        The number is larger if the first look, in simulated time, showed a fault.
        """
        if before is None or not self._is_simulated(before):
            return ROW
        rate = self._simulated_rate(before)
        stumbled = (rate is not None and not rate.even) or not self._holds(self._course, before)
        return self._long_run if stumbled else ROW

    def _holds(self, judge: Judge[PublisherSeen] | None, evidence: Evidence) -> bool:
        return judge is None or judge(self.seen(evidence), self.expected(evidence)).passed

    # --- views -----------------------------------------------------------------------------------------------

    def seen(self, evidence: Evidence) -> PublisherSeen:
        """Return the subject as a :class:`PublisherSeen`, from which criteria and mistakes decide."""
        topic, _ = evidence.reference.only("publisher")
        if evidence.real_time:
            enough = self._enough(evidence.before)
        else:
            enough = self._long_run if self._is_simulated(evidence) else self._messages
        heard = evidence.main.of("message", topic)
        # The task asks for a publisher that never ends. So if the program ended by itself, no number of messages is
        # enough: set the required number higher than the number that came.
        return PublisherSeen(
            topic, evidence.main, max(enough, len(heard) + 1) if evidence.main.ending else enough
        )

    def expected(self, evidence: Evidence) -> PublisherSeen:
        """Return the recorded reference solution as a :class:`PublisherSeen`."""
        topic, _ = evidence.reference.only("publisher")
        return PublisherSeen(topic, evidence.reference.part("talking"))

    # --- criteria --------------------------------------------------------------------------------------------

    def says_text(self) -> Callable[[Evidence], Finding]:
        """Return the criterion that each text, apart from the number, is the reference's. Also add its mistakes."""
        self._text = published_texts.says_text
        return self._criterion(published_texts.says_text)

    def counts(self, variable: str = "self.count") -> Callable[[Evidence], Finding]:
        """Return the criterion that the numbers are those of the reference. Also add mistakes about numbers.

        The number of a message is the last whole number in its text, or its field if that is a number. The first number
        and the step are those of the reference solution, which may count down.

        Args:
            variable: The name that the advice uses for the counter.
        """
        self._course, self._variable = published_texts.counts, variable
        return self._criterion(published_texts.counts)

    def _criterion(self, judge: Judge[PublisherSeen]) -> Callable[[Evidence], Finding]:
        return lambda evidence: judge(self.seen(evidence), self.expected(evidence))

    def on_topic(self, evidence: Evidence) -> Finding:
        """Decide whether the subject has a publisher on the topic."""
        topic, _ = evidence.reference.only("publisher")
        heard = self.seen(evidence)
        published = heard.endpoints
        nothing = "the program ended too soon to tell" if heard.part.ending else "no publisher"
        seen = f"publishes on {', '.join(sorted(published))}" if published else nothing
        return Finding(topic in published, f"a publisher on {topic}", seen)

    def has_type(self, evidence: Evidence) -> Finding:
        """Decide whether the publisher has the reference's message type."""
        topic, type_name = evidence.reference.only("publisher")
        heard = self.seen(evidence)
        seen = heard.endpoints.get(heard.part.real_name(topic))
        nothing = "the program ended too soon to tell" if heard.part.ending else f"nothing on {topic}"
        return Finding(seen == type_name, type_name, seen or nothing)

    def keeps_rate(self, evidence: Evidence) -> Finding:
        """Decide whether the intervals between messages equal the reference's."""
        topic, _ = evidence.reference.only("publisher")
        wanted = _reference_period(evidence.reference)
        messages = evidence.main.of("message", topic)
        before = self._simulated_rate(evidence.before)
        # Use the rate in simulated time, because real time is not exact on a busy machine. But use real time if the
        # program ends by itself, because chance decides how many messages the judge then received in simulated time.
        exact = (
            evidence.before
            and before
            and before.kept
            and evidence.main.ending is None
            and _was_faster(evidence.before.main.of("message", topic), wanted)
        )
        rate = before if exact else rate_of(messages, wanted, self._row(evidence.before))
        expected = f"one every {wanted:g} s"
        if replaced := self.seen(evidence).replaced:
            return Finding(False, expected, replaced)
        if rate is None:
            return Finding(False, expected, f"{counted(len(messages), 'message')} in all")
        seen = f"one every {rate.period:.2g} s"
        if burst := self._burst(evidence):
            return Finding(False, expected, f"{seen}, but unevenly: {burst}")
        if not rate.even:
            gaps = ", ".join(f"{gap:.2g}" if gap >= 0.01 else "0" for gap in rate.intervals[:4])
            seen += f", but unevenly: {gaps} s apart"
        if before and confirmed(rate, before, wanted):
            return Finding(False, expected, seen)
        return Finding(rate.kept, expected, seen)

    def _burst(self, evidence: Evidence) -> str:
        """Describe the burst of messages with which the publisher began; empty if there was none.

        The number in the first message shows a burst that the judge missed.
        """
        seen, expected = self.seen(evidence), self.expected(evidence)
        if not seen.counters or not expected.counters:
            return ""
        unheard = min(seen.number_of_first - 1, expected.place(seen.counters[0]))
        return burst_at_the_start(
            seen.messages[seen.greetings :], unheard, _reference_period(evidence.reference)
        )

    def _simulated_rate(self, evidence: Evidence | None) -> Rate | None:
        """Return the rate in simulated time; None if too few messages follow the simulated clock."""
        if evidence is None or not self._is_simulated(evidence):
            return None
        topic, _ = evidence.reference.only("publisher")
        return rate_of(evidence.main.of("message", topic), _reference_period(evidence.reference))

    # --- mistakes --------------------------------------------------------------------------------------------

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        of = Counting(self._variable)
        # The mistakes below fit only an exercise that judges texts or numbers with the kit's own criteria.
        texts, numbers = self._text is published_texts.says_text, self._course is published_texts.counts
        early = [("field_typo", published_texts.field_typo)] * texts + [("counter_stuck", of.stuck)] * numbers
        early += [("wrong_text", of.wrong_text)] * texts
        late = [("counter_start", of.start), ("counter_step", of.step)] * numbers
        replaced = mistake(
            "published_before_discovery",
            lambda evidence: self.seen(evidence).replaced,
            "Your node made {}. Each must be discovered before a subscriber receives its messages, so chance "
            "decides which messages arrive.",
            "Call create_publisher only once, in __init__, and keep the publisher in self. Let the timer's method "
            "publish with it.",
            certain=True,
            uses=("create_publisher",),
        )
        return ladder(
            self.roles,
            named=(),
            working=(
                replaced,
                Mistake("published_before_discovery", self._published_before_discovery),
                OWN,
                *(self._mistake(*one, certain=True) for one in early),
                Mistake("never_published", self._never_published),
            ),
            late=(
                OWN_LATE,
                *(self._mistake(*one) for one in late),
                Mistake("ended_too_early", unfinished.ended_too_early),
                Mistake("wrong_rate", self._wrong_rate),
                Mistake("stopped_publishing", self._stopped_publishing),
            ),
        )

    def _mistake(
        self,
        key: str,
        told: Callable[[PublisherSeen, PublisherSeen], Advice | None],
        *,
        certain: bool = False,
    ) -> Mistake:
        return Mistake(key, lambda evidence: told(self.seen(evidence), self.expected(evidence)), certain)

    def _published_before_discovery(self, evidence: Evidence) -> Advice | None:
        """Return advice if the program says that it published, but ended before the judge could receive anything."""
        seen = self.seen(evidence)
        ended = seen.part.ending is not None and not seen.part.traceback
        if not ended or not seen.claims(self.expected(evidence)):
            return None
        if not seen.at_once(self.expected(evidence)):
            return None
        return Advice(
            "Your program published everything at its start, and ended before any subscriber was connected.",
            "Publish from a timer and keep the program spinning, because a publisher and a subscriber need a moment "
            "to discover each other.",
        )

    def _never_published(self, evidence: Evidence) -> Advice | None:
        """Return advice if the node is spun, or prints its texts in a loop, but publishes nothing."""
        seen = self.seen(evidence)
        part = seen.part
        if seen.topic not in part.endpoints("publisher") or seen.messages or part.ending is not None:
            return None
        if len(seen.claims(self.expected(evidence))) < 4 and part.of("unanswered"):
            return None
        twin, period = common.twin(part), _reference_period(evidence.reference)
        return Advice(
            NO_MESSAGE.format(seen.topic)
            + (f" Two nodes are called {twin}, and only one of them is spun." if twin else ""),
            "If your class makes another Node(...), delete that call: self is the node, so write "
            "self.create_publisher and self.create_timer."
            if twin
            else f"{PUBLISH} Give the timer its period in seconds, {period:g}: with a longer one, such as "
            f"{10 * period:g} or {1000 * period:g}, nothing comes in the time that the judge listens.",
            uses=("create_timer", "publish"),
        )

    def _wrong_rate(self, evidence: Evidence) -> Advice | None:
        """Return advice if each message is right, but the rate is wrong."""
        finding = self.keeps_rate(evidence)
        if finding.passed or not self._holds(self._text, evidence) or "every" not in finding.seen:
            return None
        period = _reference_period(evidence.reference)
        return Advice(
            f"Your node publishes at a wrong rate: {finding.seen}. The task asks for {finding.expected}.",
            f"Use one create_timer({period:g}, your_method), and publish one message in that method, without a loop, "
            "a sleep or an `if`."
            if "unevenly" in finding.seen
            else f"The first argument of create_timer is the time between two messages in seconds ({period:g}), not a "
            "frequency. In a loop, this is the argument of sleep. Do not sleep in callbacks.",
            uses=("create_timer",),
        )

    def _stopped_publishing(self, evidence: Evidence) -> Advice | None:
        """Return advice if the node is still spun, but no longer publishes."""
        seen = self.seen(evidence)
        came, part = len(seen.messages), seen.part
        if not 0 < came < seen.enough or part.ending is not None or part.of("unanswered"):
            return None
        return Advice(NO_MORE.format(counted(came, "message")), GO_ON, uses=("create_timer", "publish"))


def _reference_period(reference: Reference) -> float:
    """Return the time between two messages of the reference solution, in seconds."""
    if not reference.parts:
        return USUAL_PERIOD
    topic, _ = reference.only("publisher")
    times = simulated_times(reference.part("talking").of("message", topic))
    return (times[-1] - times[0]) / (len(times) - 1)


def _was_faster(messages: Sequence[Event], wanted: float) -> bool:
    """Return True if simulated time passed faster than real time, so no callback can have slept for a period.

    This is checked because, on a busy machine, the judge waits for a callback that sleeps, and would then measure an
    exact rate although time did not pass faster.
    """
    times = [message.t for message in messages]
    return median(after - before for before, after in pairwise(times)) < wanted


def _listen(bench: Bench, topic: str, enough: int, period: float, step: float = STEP) -> None:
    missing = enough - bench.heard(topic)
    bench.run_time(
        2 * missing * period,
        until=lambda: bench.heard(topic) >= enough,
        quiet=SILENCE[bench.pace],
        step=step,
    )


def _lost(evidence: Evidence, topic: str) -> int:
    """Return the number of messages that the publisher sent before the first one that the judge received."""
    first = evidence.main.first("message", topic)
    return int(first.data.get("number", 1)) - 1 if first is not None else 0


Hears = Publisher
"""The name of :class:`Publisher` up to version 0.1: after what the judge does."""
