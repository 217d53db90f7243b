"""A recipe for a subscriber that must report each text it receives. No program can guess the texts: they are random."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from autograder.kit.bench import Bench, Pace
from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.role_mistakes import ladder
from autograder.kit.model import Advice, Finding, Mistake, card_words, filled_in
from autograder.kit.reported_texts import (
    AT_PACE,
    SINGLY,
    TRIES,
    changed,
    drawn_pairs,
    invented,
    is_said,
    random_texts,
    repeated,
    retold,
)
from autograder.kit.rules import successive

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.kit.counterparts import Speaker
    from autograder.kit.evidence import Event, Evidence, Part

_WORDS = card_words(__file__)

AT_ONCE = 2
"""The maximum number of subscriptions at once of a program that replaces one: the new one may be made first."""
STEPS = 2
"""The number of steps of simulated time from one text to the next. After each step, the judge waits until the listener
has processed what was sent to it.
"""
SIMULATED = 20
"""The number of texts that are sent to a listener that follows simulated time, at the given pace and in pairs."""
PATIENCE = {Pace.FAST: 1.0, Pace.REAL_TIME: 3.0}
"""Time limit in seconds of wall time for a listener to report a text."""
MOMENT = 0.02
"""The most seconds of wall time between the two texts of a pair, for a listener that has not reported the first one.

A listener that reports each text from its callback has reported the first text by then. A listener whose timer reports
only the newest text has not, unless its timer happens to fire between the two texts.
"""
BEFORE = 1.0
"""Seconds to wait before the first text, to see whether the listener invents a text. For a listener that follows
simulated time, these are simulated seconds.
"""
AFTERMATH = 2.5
"""Seconds to wait after the last text, to see whether the listener repeats or invents a text. For a listener that
follows simulated time, these are simulated seconds.
"""


class Subscriber:
    """The recipe for a subscriber that must report each text that it receives, with any words around it.

    The recipe recognizes the mistakes ``topic_name``, ``message_type``, ``qos_mismatch``, ``wrong_text``,
    ``invented_text``, ``callback_too_slow``, ``not_logged``, ``everything_twice``, ``never_ended``.

    Args:
        pace: The time in seconds between two successive texts.
        paced_by: The node that sends at this pace, in words for the student.

    Example::

        recipe = Subscriber(pace=0.5, paced_by="the lab's talker")
        listener = Draft("lab_8_1.listener", "Lab 8.1 · The listener", "Log every text that arrives.", recipe)
        listener.asks("topic", "Subscribes to the right topic and type", subscribes, points=3)
        listener.asks("says", "Logs every text that arrives", says_every_text, points=5)
        listener.asks("honest", "Logs only what arrived", says_nothing_else, points=2)
    """

    roles = ("subscription",)

    def __init__(self, *, pace: float, paced_by: str) -> None:
        self._pace, self._paced_by = pace, paced_by
        self._step = pace / STEPS

    def scenario(self, bench: Bench) -> None:
        """Send texts that no program can guess: first some at the recipe's pace, then some one by one.

        The pace is an average, because some texts follow the text before them at once: two in a row are a pair.
        """
        topic, type_name = bench.reference.only("subscription")
        texts = random_texts(bench.random)
        bench.part("listening", texts=texts, pairs=drawn_pairs(bench.random, texts))
        speaker = bench.speak(topic, type_name)
        bench.start()
        if bench.await_endpoint("subscription", topic):
            bench.release()
            bench.await_attention()
            bench.run_time(BEFORE, step=self._step)
            if self._all_are_said(bench, speaker, texts):
                bench.run_time(AFTERMATH, step=self._step)
            else:
                bench.note_whether_it_spins()
        bench.stop()

    def _all_are_said(self, bench: Bench, speaker: Speaker, texts: Sequence[str]) -> bool:
        speaker.send(data=texts[0])
        simulated = bench.wait_until(_is_simulated, 0.0)
        if simulated:
            # The pause does not depend on how soon the listener reports this text, because all pauses must have the
            # same length.
            bench.run_time(self._pace, step=self._step)
        if not self._are_said(bench, texts[:1]):
            self._ask_once_more(bench, speaker, texts[1])
            return False
        if simulated:
            return self._are_said_at_pace(bench, speaker, texts[1:SIMULATED])
        bench.settle()  # A late copy of the first text must not count as said after a row.
        for row in _rows(texts):
            last = bench.seen().events[-1]
            if self._are_said_at_pace(bench, speaker, row):
                break
            if not bench.seen().said(after=last):
                return False  # it hangs
        # If the listener missed texts at the pace, texts of each kind show whether time was what it lacked.
        return all(self._is_answered(bench, speaker, text) for text in texts[-SINGLY:])

    def _ask_once_more(self, bench: Bench, speaker: Speaker, text: str) -> None:
        """Send one more text to a listener that has reported nothing, because it may report each text late."""
        first = bench.seen().first("sent")
        if not bench.seen().said(after=first):
            speaker.send(data=text)
            bench.wait_until(lambda evidence: bool(evidence.main.said(after=first)), PATIENCE[Pace.FAST])

    def _are_said_at_pace(self, bench: Bench, speaker: Speaker, texts: Sequence[str]) -> bool:
        for text in texts:
            speaker.send(data=text)
            if text in bench.seen().inputs["pairs"]:
                # The listener handles this text before the next one comes, so any queue depth is enough.
                bench.settle()
                bench.wait_until(partial(_says, [text]), MOMENT)
            elif not bench.run_time(self._pace, step=self._step):
                break
        return self._are_said(bench, texts)

    def _is_answered(self, bench: Bench, speaker: Speaker, text: str) -> bool:
        speaker.send(data=text)
        return self._are_said(bench, [text])

    def _are_said(self, bench: Bench, texts: Sequence[str]) -> bool:
        said = partial(_says, texts)
        if bench.wait_until(said, PATIENCE[bench.pace]):
            return True
        if not bench.wait_until(_is_simulated, 0.0):
            return False
        # A listener may report texts from a timer.
        bench.run_time(PATIENCE[bench.pace], until=lambda: bench.wait_until(said, 0.0), step=self._step)
        return bench.wait_until(said, PATIENCE[bench.pace])

    def seen(self, evidence: Evidence) -> Part:
        """Return the record of the subject."""
        return evidence.main

    def expected(self, evidence: Evidence) -> Part:
        """Return the record of the subject, because it also contains the texts, which are drawn for each check."""
        return evidence.main

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        return ladder(
            self.roles,
            named=(),
            working=(
                OWN,
                Mistake("ended_too_early", unfinished.ended_too_early),
                Mistake("not_logged", _subscribes_again, certain=True),
                # Before what hangs or is too slow: with more and more subscriptions or timers, a busy machine is both.
                Mistake("everything_twice", _said_again, certain=True),
            ),
            late=(
                OWN_LATE,
                Mistake("wrong_text", _changed_text),
                Mistake("invented_text", _invented_text, certain=True),
                Mistake("callback_too_slow", self._too_slow),
                Mistake("not_logged", _not_logged),
            ),
        )

    def _too_slow(self, evidence: Evidence) -> Advice | None:
        """Return advice if the listener misses texts that come at the pace, but reports texts that come one by one."""
        texts, missing = list(evidence.main.inputs.get("texts", ())), _missing(evidence)
        singly = [event for event in _sent(evidence) if _text(event) in texts[-SINGLY:]]
        if _is_simulated(evidence) or not singly or not missing or any(event in singly for event in missing):
            return None
        if all(is_said(_text(event), evidence.main) for event in missing):
            return None  # Each text was reported at least once, so the listener is not too slow.
        if all(_text(event) in evidence.main.inputs["pairs"] for event in missing):
            return None  # Only texts that the next one followed at once are missing: it keeps only the newest text.
        return filled_in(
            _WORDS["callback_too_slow"], paced_by=self._paced_by, pace=self._pace, missing=_text(missing[0])
        )


# --- the scenario ------------------------------------------------------------------------------------------


def _rows(texts: Sequence[str]) -> list[Sequence[str]]:
    """Return the series of texts that are sent at the pace in real time, one for each try."""
    return [texts[1 + AT_PACE * i : 1 + AT_PACE * (i + 1)] for i in range(TRIES)]


def _is_simulated(evidence: Evidence) -> bool:
    """Return True if the subject followed simulated time when the last text was sent."""
    sent = evidence.main.of("sent")
    return bool(sent) and sent[-1].sim is not None


def _says(texts: Sequence[str], evidence: Evidence) -> bool:
    """Return True if each of the texts was reported after it was sent; a text that was sent twice, twice."""
    awaited = [event for event in _sent(evidence) if _text(event) in texts]
    return all(is_said(_text(event), evidence.main, after=event) for event in awaited)


def _sent(evidence: Evidence) -> list[Event]:
    topic, _ = evidence.reference.only("subscription")
    return evidence.main.of("sent", topic)


def _sent_texts(evidence: Evidence) -> list[str]:
    return [_text(event) for event in _sent(evidence)]


def _text(event: Event) -> str:
    return str(event.data["fields"]["data"])


def subscribes(evidence: Evidence) -> Finding:
    """Decide whether the subject subscribes to the topic with the right type."""
    topic, type_name = evidence.reference.only("subscription")
    made = _subscriptions(evidence.main, topic)
    nothing = "the program ended too soon to tell" if evidence.main.ending else "no subscription"
    seen = ", ".join(f"{name} ({kind})" for name, kind in sorted(made.items())) or nothing
    return Finding(made.get(topic) == type_name, f"{topic} ({type_name})", seen)


def _subscriptions(part: Part, topic: str) -> dict[str, str]:
    """Return the types of the subscriptions by topic; none for a program that ended before the judge sent a text.

    The subscriptions of such a program are left out, because chance decides whether the graph shows them. A notebook's
    class is not spun until its subscriptions are known, so they always count.
    """
    ending, sent = part.ending, part.first("sent", topic)
    met = ending is None or part.first("subject", "constructed") or (sent and _is_before(part, sent, ending))
    return part.endpoints("subscription") if met else {}


def _is_before(part: Part, event: Event, other: Event) -> bool:
    return part.events.index(event) < part.events.index(other)


def _missing(evidence: Evidence) -> list[Event]:
    """Return the texts that were not reported.

    Several series of texts are sent at the talker's pace. If the listener reported all texts of one of them, texts of
    the others do not count as missing.
    """
    part, sent = evidence.main, _sent(evidence)
    silent = [event for event in sent if not is_said(_text(event), part, after=event)]
    if _is_simulated(evidence):
        return silent
    rows = [
        [event for event in sent if _text(event) in row] for row in _rows(list(part.inputs.get("texts", ())))
    ]
    tried = [row for row in rows if row]
    kept = any(len(row) == AT_PACE and not any(event in silent for event in row) for row in tried)
    at_pace = [event for row in tried for event in row] if kept else []
    return [event for event in silent if event not in at_pace]


def says_every_text(evidence: Evidence) -> Finding:
    """Decide whether the listener reports each text after it was sent."""
    sent, missing = _sent(evidence), _missing(evidence)
    topic, _ = evidence.reference.only("subscription")
    no_subscriber = f"no node subscribed to {topic}, so nothing was sent"
    seen = f"{len(sent) - len(missing)} of {len(sent)} said" if sent else no_subscriber
    if missing:
        seen += f"; not “{_text(missing[0])}”"
    all_sent = SIMULATED if _is_simulated(evidence) else 1 + AT_PACE + SINGLY
    complete = len(sent) >= all_sent and not missing
    if complete and (many := successive(evidence.main, topic)):
        return Finding(False, "one subscription that receives every string", f"{many} one after another")
    if sent and not missing and not complete:
        seen += ", and then it no longer answered the judge"
    return Finding(complete, "every string in its log", seen)


def says_nothing_else(evidence: Evidence) -> Finding:
    """Decide whether the listener reports only texts that were sent, and none of them repeatedly."""
    sent = _sent_texts(evidence)
    heard_any = any(is_said(text, evidence.main) for text in sent)
    made_up, again = invented(evidence.main, sent), repeated(evidence.main, sent)
    older = retold(evidence.main, sent)
    if made_up:
        seen = f"“{made_up[0]}”"
    elif again:
        seen = "“{}” {} times".format(*_most_often(again))
    elif older:
        seen = f"each string together with all earlier strings: “{older}”"
    else:
        seen = "only what was sent" if heard_any else "none of the strings"
    return Finding(
        heard_any and not (made_up or again or older), "only what was sent, and each string only once", seen
    )


def _most_often(again: Mapping[str, int]) -> tuple[str, int]:
    return max(again.items(), key=lambda item: item[1])


def _said_again(evidence: Evidence) -> Advice | None:
    """Return advice if the listener reports texts more often than they were sent."""
    sent = _sent_texts(evidence)
    again = repeated(evidence.main, sent)
    if not again and retold(evidence.main, sent):
        return filled_in(_WORDS["retold"])
    if not again:
        return None
    text, times = _most_often(again)
    return filled_in(_WORDS["everything_twice"], text=text, times=times)


def _changed_text(evidence: Evidence) -> Advice | None:
    """Return advice if the listener reports a text with changes."""
    part, sent = evidence.main, _sent(evidence)
    for event in _missing(evidence):
        later = sent[sent.index(event) + 1 :][:1]
        then = part.said(after=event)
        lines = then[: len(then) - len(part.said(after=later[0]))] if later else then
        made_up = [line for line in changed(part, _sent_texts(evidence), _text(event)) if line in lines]
        if made_up:
            return filled_in(_WORDS["wrong_text"], sent=_text(event), made_up=made_up)
    return None


def _subscribes_again(evidence: Evidence) -> Advice | None:
    """Return advice if the listener makes a new subscription for each text, so that texts in between are lost."""
    topic, _ = evidence.reference.only("subscription")
    # A program that only adds subscriptions keeps the old ones: it loses nothing, and says everything again.
    adds = any(event.data["now"] > AT_ONCE for event in evidence.main.of("matched", topic))
    if adds or not successive(evidence.main, topic):
        return None
    return filled_in(_WORDS["subscribes_again"])


def _not_logged(evidence: Evidence) -> Advice | None:
    """Return advice if the listener has a right subscription, but does not report all texts."""
    topic, _ = evidence.reference.only("subscription")
    part, sent = evidence.main, _sent(evidence)
    silent = next(iter(_missing(evidence)), None)
    if silent is None or not subscribes(evidence).passed:
        return None
    words = list(filter(str.strip, part.said(after=silent)))
    bytes_said = next((line for line in words if _text(silent) in line), None)
    if bytes_said is not None:
        return filled_in(_WORDS["bytes_said"], bytes_said=bytes_said)
    if any(is_said(_text(event), part) for event in sent):
        return filled_in(_WORDS["some_not_logged"], silent=_text(silent))
    if not words:
        return filled_in(_WORDS["not_logged"], topic=topic)
    return filled_in(_WORDS["other_words"], silent=_text(silent), words=words)


def _invented_text(evidence: Evidence) -> Advice | None:
    """Return advice if the listener reports texts that were never sent."""
    made_up = invented(evidence.main, _sent_texts(evidence))
    if not made_up:
        return None
    return filled_in(_WORDS["invented_text"], made_up=made_up)


Speaks = Subscriber
"""The name of :class:`Subscriber` up to version 0.1: after what the judge does."""
