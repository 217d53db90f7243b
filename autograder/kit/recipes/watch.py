"""A recipe for a node that reports each change of a state. The author writes how inputs and time decide the state.

Time alone may change the state: ``"lost"`` after a second without a message, ``"back"`` with the next one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, Any

from autograder.kit.in_words import counted
from autograder.kit.model import STEP, Finding
from autograder.kit.recipes.declared import SILENCE, Declared, pick, variant
from autograder.kit.recipes.own_scenario import once_met
from autograder.kit.rules import Given, in_words, reported_at, same, value

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Part
    from autograder.kit.model import Exercise
    from autograder.kit.recipes.own_scenario import Met
    from autograder.kit.rules import State

__all__ = ["SILENCE", "Watch"]

EARLY = 0.15
"""The maximum number of seconds by which a message may report a state too early: three steps of the judge's clock."""
BUSY = 0.25
"""The maximum number of seconds by which a message in real time may come later than the task allows, because a busy
machine delays a node.
"""
GRAIN = 0.02
"""Seconds between two moments for which the state is computed."""


@dataclass
class Span:
    """An interval in which one state holds, which the subject has to report once.

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
    """The recipe for a node that listens on one topic and reports a state on another, once at each change and in time.

    Args:
        exercise_id: The exercise's id, such as ``"lab_8_1.watchdog"``.
        title: The title of the card: the lab and the subject.
        task: One sentence that states the task.
        state: Returns the state, given all messages that the node was sent so far, each with its ``age`` in seconds,
            ``value`` and ``name``. For no messages it returns the initial state. The node must report neither the
            initial state nor :data:`SILENCE`.
        gives: The messages, each with the seconds until the next one or the end. A dictionary is a whole message,
            anything else its field ``data``. In real time these seconds get longer on a busy machine, so let them
            differ from every limit by at least a quarter of a second. Let changes be due in different thirds of a
            second: then a node that looks only once a second is late at one of them.
        within: Time limit in seconds for reporting a change, as stated in the task.
        waits: Seconds of wall time before the first message, in which the node must not report anything.
        field: The path of the message field that contains the state.
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
    ) -> None:
        scenario = once_met(self._happens)
        super().__init__(exercise_id, title, task, scenario, "subscription", "publisher", given="sent")
        self._state, self._gives, self._within, self._waits = state, gives, within, waits
        self._field = field

    def says(self, name: str, state: Any, points: float, title: str, words: str = "") -> None:
        """Add a criterion: whenever a state begins, the node reports it in time.

        A state does not count as missed if it ends before the time limit, or if the node did not report the state
        before it either.

        Args:
            name: A stable key.
            state: The state to report.
            points: The points for it.
            title: One line for people.
            words: The words of the task that the criterion judges.
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
            usual = sum(same(span.state, state) for span in spans)
            return Finding(passed, f"{state}, {counted(usual, 'time')}, at most {self._within} s late", made)

        self._draft.criterion(name, points, title)(judge)
        self._judges(name, words)

    def once(self, name: str, points: float, title: str, words: str = "") -> None:
        """Add a criterion: every message reports a state that is due, and only once; arguments as in :meth:`asks`."""

        def judge(seen: Part, expected: Part) -> Finding:
            _, stray = self._matched(seen, self._state)
            made = counted(len(stray), "message") + (
                f", the first one {self._told(stray[0])}" if stray else ""
            )
            passed = self._got_through(seen, expected) and bool(seen.of("message")) and not stray
            return Finding(passed, "no message besides these", made)

        self._draft.criterion(name, points, title)(judge)
        self._judges(name, words)

    def wrong(self, key: str, state: State | Mapping[str, Any], says: str, next_step: str) -> None:
        """Add a mistake: all messages fit a wrong variant of the state; arguments as in :meth:`Relay.wrong`."""
        wrong = variant(self._state, state)

        def fits(seen: Part, rule: State) -> bool:
            spans, stray = self._matched(seen, rule)
            return not stray and all(self._in_time(span, seen) for span in spans)

        def found(seen: Part) -> bool:
            return bool(seen.of("message")) and not fits(seen, self._state) and fits(seen, wrong)

        self._knows(key, found, says, next_step, certain=False)

    def exercise(self) -> Exercise:
        """Return the exercise, with the ready-made mistakes after its own."""
        for key, found, says, next_step, certain in self._ready_made():
            self._knows(key, found, says, next_step, certain=certain)
        return super().exercise()

    def _ready_made(self) -> Iterator[tuple[str, Callable[[Part], str], str, str, bool]]:
        """Yield each mistake that any such node may show: its key, the function that finds it, two texts, certainty."""
        yield (
            "too_early",
            self._before_the_first,
            "Your node says {} before it has heard anything.",
            "Begin to watch with the first message: keep None as the time of the last one until then.",
            True,
        )
        yield (
            "never_told",
            self._never_told,
            "Your node never says {}.",
            "Say it, spelled like this, when it becomes true.",
            False,
        )
        yield (
            "told_too_often",
            self._repeated,
            "Your node says {} twice in a row.",
            "Remember what you have said, and say only what differs from it.",
            True,
        )
        yield (
            "only_in_answer",
            self._only_in_answer,
            "Your node says {} only when the next message comes. If none comes any more, it says nothing.",
            "Look at the time in a timer, too, and not only in the callback of the subscription.",
            False,
        )
        yield (
            "told_untruly",
            self._untrue,
            "Your node says {} while it is not so.",
            "Count the time from the last message on, and compare it with the limit of the task.",
            False,
        )
        yield (
            "told_too_late",
            self._too_late,
            "Your node says {}.",
            "Count the time from the last message on, and look often: let a timer call every 0.1 s, or reset it with "
            "each message.",
            False,
        )

    def _happens(self, met: Met) -> bool:
        # Wait in real time, because a time that the subject reads before its clock is simulated means nothing later.
        met.bench.wait_until(lambda evidence: bool(evidence.main.of("message")), self._waits)
        met.bench.run_time(STEP)
        for given, seconds in self._gives:
            met.speakers[0].send(**(given if isinstance(given, Mapping) else {"data": given}))
            met.bench.settle()
            met.bench.run_time(seconds)
        return met.heard > 0

    def _spans(self, seen: Part, rule: State) -> list[Span]:
        """Return the interval of each state that has to be reported by a rule, in order."""
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
        spans = [Span(held, at, until) for (held, at), until in zip(begins, ends, strict=True)]
        return [span for span in spans[1:] if span.state is not SILENCE]

    def _matched(self, seen: Part, rule: State) -> tuple[list[Span], list[Event]]:
        """Return the states to report, each with the time of its report, and the messages that report no such state."""
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

    def _in_time(self, span: Span, seen: Part) -> bool:
        return (span.end if span.said is None else span.said) - span.begin <= self._late(seen)

    def _told(self, event: Event) -> Any:
        return pick(event.data["fields"], self._field)

    def _before_the_first(self, seen: Part) -> str:
        """Return what the subject reported before the judge's first message."""
        heard = [event for event in seen.events if event.kind in ("sent", "message")]
        return str(self._told(heard[0])) if heard and heard[0].kind == "message" else ""

    def _repeated(self, seen: Part) -> str:
        """Return a state that the subject reported twice in a row."""
        told = map(self._told, seen.of("message"))
        return next((str(one) for one, other in pairwise(told) if same(one, other)), "")

    def _only_in_answer(self, seen: Part) -> str:
        """Return a state that begins without a message, if the subject reports only when the judge sends one."""
        sent = [event.moment for event in seen.of("sent")]

        def by_itself(at: float) -> bool:
            return all(not 0 <= at - moment <= EARLY for moment in sent)

        told = seen.of("message")
        due = [span.state for span in self._spans(seen, self._state) if by_itself(span.begin)]
        answers = bool(told) and not any(by_itself(reported_at(event)) for event in told)
        return str(due[0]) if due and answers else ""

    def _never_told(self, seen: Part) -> str:
        """Return a due state that was never reported, and what was reported; empty if nothing was reported at all."""
        told = [self._told(event) for event in seen.of("message")]
        due = [span.state for span in self._spans(seen, self._state)]
        never = next((one for one in due if not any(same(one, other) for other in told)), None)
        return f"{never}, but {in_words(told[:6])}" if told and never is not None else ""

    def _too_late(self, seen: Part) -> str:
        """Return a state that was reported too late, with the delay, or missed; empty if nothing was reported."""
        spans, _ = self._matched(seen, self._state)
        after = [(span.state, span.said - span.begin) for span in spans if span.said is not None]
        late = [f"{state} {seconds:.1f} s late" for state, seconds in after if seconds > self._late(seen)]
        missed = [f"{span.state} too late, or not at all" for span in spans if not self._in_time(span, seen)]
        return next(iter([*late, *missed] if after else []), "")

    def _untrue(self, seen: Part) -> str:
        """Return a state that the subject reported while another one held."""
        spans, stray = self._matched(seen, self._state)
        states = [span.state for span in spans]
        told = map(self._told, stray)
        return next((str(one) for one in told if any(same(one, state) for state in states)), "")
