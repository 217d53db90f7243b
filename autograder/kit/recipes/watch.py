"""A recipe for a node that reports each change of a state; the author writes how inputs and time decide the state.

Time alone may change the state. For example, the state becomes ``"lost"`` after a second without a message, and
``"back"`` with the next message.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, Any

from autograder.kit.evidence import Event, Part
from autograder.kit.in_words import counted
from autograder.kit.model import STEP, Finding
from autograder.kit.recipes.own_scenario import SILENCE, Declared, once_met, pick
from autograder.kit.rules import Given, in_words, reported_at, same, value

if TYPE_CHECKING:
    from autograder.kit.model import Exercise
    from autograder.kit.recipes.own_scenario import Met
    from autograder.kit.rules import State

__all__ = ["SILENCE", "Watch"]

EARLY = 0.15
"""The maximum number of seconds by which a report may come too early: three steps of the judge's clock."""
BUSY = 0.25
"""The maximum number of seconds by which a report in real time may come later than the task allows, because a busy
machine delays the node.
"""
GRAIN = 0.02
"""The time in seconds between two successive moments at which the right state is computed."""


@dataclass
class _Span:
    """An interval of time in which one state holds. The subject must report this state once.

    Attributes:
        state: The state.
        begin: The beginning of the interval, in seconds of the subject's time.
        end: The end of the interval.
        said: The time at which the subject reported the state; None if it did not.
    """

    state: Any
    begin: float
    end: float
    said: float | None = None


class Watch(Declared):
    """An exercise about a node that listens on one topic and reports each change of a state on another, in time.

    With ``words`` it logs or prints the state instead.

    Args:
        exercise_id: The exercise's id, such as ``"lab_8_1.watchdog"``.
        title: The title of the card: the lab and the subject.
        task: One sentence that states the task.
        state: Returns the state, given all messages that the node was sent so far, each with its ``age`` in seconds,
            ``value`` and ``name``. Given no messages, it returns the initial state. The node must report neither the
            initial state nor :data:`SILENCE`.
        gives: The messages, each with the seconds until the next message or the end. A dictionary is a whole message;
            anything else is the value of its field ``data``. Choose seconds that differ from each limit by at least a
            quarter of a second, because they get longer on a busy machine. Let the changes fall into different thirds
            of a second, so that a node that checks the time only once a second is late for one of them.
        within: The time limit in seconds for reporting a change, as in the task.
        waits: Seconds of wall time before the first message, in which the node must not report anything.
        field: The path of the message field that contains the state.
        words: The states, if the node logs or prints them instead of publishing.

    Example::

        def state(beats: Sequence[Given], limit: float = 1.0) -> object:
            return "lost" if beats and beats[-1].age >= limit else "back"

        beats = [({}, seconds) for seconds in (0.3, 0.75, 0.45, 1.65, 1.7, 0.57, 0.4, 2.95, 0.42, 0.25, 2.3)]
        task = Watch("lab_8_1.watchdog", "Lab 8.1 · Watchdog", "Report.", state=state, gives=beats, within=0.3)
        task.says("lost", "lost", 5, "Says lost after a second without a heartbeat")
        task.once("once", 5, "Says each change once")
        EXERCISE = task.exercise()
    """

    def __init__(
        self,
        exercise_id: str,
        title: str,
        task: str,
        *,
        state: State,
        gives: Sequence[tuple[Any, float]],
        within: float,
        waits: float = 0.0,
        field: str = "data",
        words: Sequence[str] = (),
    ) -> None:
        roles = ("subscription",) if words else ("subscription", "publisher")
        super().__init__(exercise_id, title, task, once_met(self._happens), *roles, given="sent", words=words)
        self._state, self._gives, self._within, self._waits = state, gives, within, waits
        self._field = field

    def says(self, name: str, state: Any, points: float, title: str, words: str = "") -> None:
        """Add the criterion that the node reports a state in time whenever that state begins.

        A state does not count as missed in two cases: it ended before the time limit, or the node did not report the
        previous state either.

        Args:
            name: A stable key for the criterion.
            title: The criterion in one line, as the card shows it.
            words: The sentence of the task that the criterion judges.
        """

        def judge(seen: Part, expected: Part) -> Finding:
            spans, _ = self._matched(seen, self._state)
            before = [None, *spans]
            due = [
                span
                for earlier, span in zip(before, spans, strict=False)
                if same(span.state, state) and (earlier is None or {earlier.said, span.said} != {None})
            ]
            missed = [span for span in due if not self._in_time(span, seen)]
            passed = self._got_through(seen, expected) and bool(due) and not missed
            if missed and missed[0].said is not None:
                made = f"{state}, {missed[0].said - missed[0].begin:.1f} s after it was so"
            else:
                made = f"{state}, {counted(sum(span.said is not None for span in due), 'time')}"
            # Count how often the state is due in the run of the reference solution, because a subject that ended early
            # got fewer inputs.
            usual = sum(same(span.state, state) for span in self._spans(expected, self._state))
            return Finding(passed, f"{state}, {counted(usual, 'time')}, at most {self._within} s late", made)

        self._draft.criterion(name, points, title)(judge)
        self._judges(name, words)

    def once(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add the criterion that each message reports a due state, and each state only once. See :meth:`asks`."""

        def judge(seen: Part, expected: Part) -> Finding:
            _, stray = self._matched(seen, self._state)
            whole, told = self._got_through(seen, expected), seen.of("message")
            made = counted(len(stray), "message") + (
                f", the first one {self._told(stray[0])}" if stray else ""
            )
            if not stray and not (whole and told):
                made = "no message at all" if not told else "the node ended before the last input"
            return Finding(whole and bool(told) and not stray, "these messages, and no others", made)

        self._draft.criterion(name, points, title)(judge)
        self._judges(name, words)

    def wrong(self, key: str, state: State | Mapping[str, Any], says: str, next_step: str) -> None:
        """Add a mistake: all messages report the states of a wrong ``state`` function. See :meth:`Relay.wrong`."""
        wrong = partial(self._state, **state) if isinstance(state, Mapping) else state

        def fits(seen: Part, rule: State) -> bool:
            spans, stray = self._matched(seen, rule)
            return not stray and all(self._in_time(span, seen) for span in spans)

        def found(seen: Part) -> bool:
            return bool(seen.of("message")) and not fits(seen, self._state) and fits(seen, wrong)

        self._knows(key, found, says, next_step, certain=False)

    def exercise(self) -> Exercise:
        """Return the finished exercise. The mistakes of this recipe follow those of the exercise.

        Raises:
            ValueError: A wrong node would pass by chance with these messages. The text says what to change.
        """
        self._check_what_is_given()
        for key, found, says, next_step, certain in self._ready_made():
            self._knows(key, found, says, next_step, certain=certain)
        return super().exercise()

    def _ready_made(self) -> Iterator[tuple[str, Callable[[Part], str], str, str, bool]]:
        """Yield this recipe's mistakes: key, function that finds the mistake, two texts, whether it is certain."""
        yield (
            "too_early",
            self._before_the_first,
            "Your node reports {} before it has received any message.",
            "Start to count the time at the first message: store None as the time of the last message until then.",
            True,
        )
        yield (
            "never_told",
            self._never_told,
            "Your node never reports {}.",
            "Report this state, with exactly this spelling, when it begins.",
            False,
        )
        yield (
            "told_too_often",
            self._repeated,
            "Your node reports {} twice in a row.",
            "Store the state that you reported last, and report a state only if it differs from that one.",
            False,  # A right node may do so in simulated time if it has a thread that does not follow the ROS clock.
        )
        yield (
            "only_in_answer",
            self._only_in_answer,
            "Your node reports {} only when the next message comes. If no more messages come, it reports nothing.",
            "Check the time in a timer, too, and not only in the callback of the subscription.",
            False,
        )
        yield (
            "told_untruly",
            self._untrue,
            "Your node reports {} while another state holds.",
            "Measure the time since the last message, and compare it with the limit in the task.",
            False,
        )
        yield (
            "told_too_late",
            self._too_late,
            "Your node reports {}.",
            "Measure the time since the last message, and check it often: with a timer that fires every 0.1 s, or "
            "with a timer that each message resets.",
            False,
        )

    def _check_what_is_given(self) -> None:
        """Raise an error if a node passes with these inputs although it skips a state or checks once a second only."""
        sent, at = [], 0.0
        for given, seconds in self._gives:
            fields = given if isinstance(given, Mapping) else {"data": given}
            sent.append(Event(at, "sent", "", {"fields": fields}, at))
            at += seconds
        late = self._within + BUSY
        spans = self._spans(Part("", {}, sent), self._state)
        for span in spans:
            if self._within < span.end - span.begin <= late:
                raise ValueError(
                    f"gives: the state {span.state} begins at {span.begin:.2f} s and lasts only "
                    f"{span.end - span.begin:.2f} s. On a busy machine, a right node may report it {late:g} s late. If "
                    f"the node has to report this state, let the state last longer than {late:g} s. If not, let it "
                    f"last at most {self._within} s."
                )
        inputs = [event.t for event in sent]
        # A node that reports from its subscription's callback is never late for a change that an input causes, so only
        # changes by time alone show how often it checks the time.
        by_time = [
            s.begin for s in spans if s.end - s.begin > late and min(abs(s.begin - t) for t in inputs) > GRAIN
        ]
        parts = sorted(begin % 1.0 for begin in by_time)
        gap = max((b - a for a, b in pairwise([*parts, parts[0] + 1.0])), default=0.0) if parts else 0.0
        # If all changes fall into a part of the second as short as the time limit, a check at the end of this part is
        # in time for each of them.
        if gap > 0 and 1.0 - gap <= late < 1.0:
            shown = in_words([round(part, 2) for part in parts])
            raise ValueError(
                "gives: a wrong node that checks the time only once a second would pass. Let time change the state at "
                "least three times, in different thirds of a second. So far the changes are at these fractions of a "
                f"second: {shown}"
            )

    def _happens(self, met: Met) -> bool:
        # Wait in real time. Then make one step of simulated time before the first input: otherwise the subject might
        # store a real time at the first input, and compare that with later simulated times.
        met.bench.wait_until(lambda evidence: bool(self._subject.seen(evidence).of("message")), self._waits)
        met.bench.run_time(STEP)
        for given, seconds in self._gives:
            met.speakers[0].send(**(given if isinstance(given, Mapping) else {"data": given}))
            met.bench.settle()
            met.bench.run_time(seconds)
        return bool(self._subject.view(met.bench.seen()).of("message"))

    def _spans(self, seen: Part, rule: State) -> list[_Span]:
        """Return each state that the subject must report, with the time from its begin to its end, in order of time."""
        sent = seen.of("sent")
        if not sent:
            return []
        begin, last = sent[0].moment, sent[-1].moment
        end = last + (self._gives[-1][1] if len(sent) == len(self._gives) else 0.0)
        steps = (begin + n * GRAIN for n in range(round((end - begin) / GRAIN)))

        def state(at: float) -> Any:
            return rule([Given(at - e.moment, value(e), e.name) for e in sent if e.moment <= at])

        begins = [(rule([]), begin)]
        for held, moments in groupby(sorted({*steps, *(e.moment for e in sent)}), state):
            if not same(held, begins[-1][0]):
                begins.append((held, next(moments)))
        ends = [*(at for _, at in begins[1:]), end]
        spans = [_Span(held, at, until) for (held, at), until in zip(begins, ends, strict=True)]
        return [span for span in spans[1:] if span.state is not SILENCE]

    def _matched(self, seen: Part, rule: State) -> tuple[list[_Span], list[Event]]:
        """Return each due state with the time at which it was reported, and the messages that report none of them."""
        spans, stray = self._spans(seen, rule), []
        for event in seen.of("message"):
            at, told = reported_at(event), self._told(event)
            for span in spans:
                near = span.begin - EARLY <= at <= max(span.end, span.begin + self._late(seen))
                if near and span.said is None and same(span.state, told):
                    span.said = at
                    break
            else:
                stray.append(event)
        return spans, stray

    def _late(self, seen: Part) -> float:
        return self._within + (BUSY if seen.of("sent")[-1].sim is None else 0.0)

    def _in_time(self, span: _Span, seen: Part) -> bool:
        return (span.end if span.said is None else span.said) - span.begin <= self._late(seen)

    def _told(self, event: Event) -> Any:
        return pick(event.data["fields"], self._field)

    def _before_the_first(self, seen: Part) -> str:
        """Return what the subject reported before the judge's first message; empty if nothing."""
        heard = [event for event in seen.events if event.kind in ("sent", "message")]
        return str(self._told(heard[0])) if heard and heard[0].kind == "message" else ""

    def _repeated(self, seen: Part) -> str:
        """Return a state that the subject reported twice in a row; empty if there is none."""
        told = map(self._told, seen.of("message"))
        return next((str(one) for one, other in pairwise(told) if same(one, other)), "")

    def _only_in_answer(self, seen: Part) -> str:
        """Return a state that begins without a message, if the subject reports only at messages; otherwise empty."""
        sent = [event.moment for event in seen.of("sent")]

        def by_itself(at: float) -> bool:
            return all(not 0 <= at - moment <= EARLY for moment in sent)

        told = seen.of("message")
        due = [span.state for span in self._spans(seen, self._state) if by_itself(span.begin)]
        answers = bool(told) and not any(by_itself(reported_at(event)) for event in told)
        return str(due[0]) if due and answers else ""

    def _never_told(self, seen: Part) -> str:
        """Return a state that was never reported, with the reports instead; empty if there is none, or no report."""
        told = [self._told(event) for event in seen.of("message")]
        due = [span.state for span in self._spans(seen, self._state)]
        never = next((one for one in due if not any(same(one, other) for other in told)), None)
        return f"{never}, but {in_words(told[:6])}" if told and never is not None else ""

    def _too_late(self, seen: Part) -> str:
        """Return a state that was reported late, with the delay, or missed; empty if there is none, or no report."""
        spans, _ = self._matched(seen, self._state)
        after = [(span.state, span.said - span.begin) for span in spans if span.said is not None]
        late = [f"{state} {seconds:.1f} s late" for state, seconds in after if seconds > self._late(seen)]
        missed = [f"{span.state} too late, or not at all" for span in spans if not self._in_time(span, seen)]
        return next(iter([*late, *missed] if after else []), "")

    def _untrue(self, seen: Part) -> str:
        """Return a state that the subject reported while another state held; empty if there is none."""
        spans, stray = self._matched(seen, self._state)
        states = [span.state for span in spans]
        told = map(self._told, stray)
        return next((str(one) for one in told if any(same(one, state) for state in states)), "")
