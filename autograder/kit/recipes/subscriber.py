"""A subscriber that reports each text that it hears. The judge sends texts that cannot be guessed, in two ways."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import unfinished
from autograder.kit.model import Advice, Bench, Finding, Mistake, Pace
from autograder.kit.reading.texts_said import changed, invented, is_said, repeated, retold
from autograder.kit.recipes.sent_texts import AT_PACE, SINGLY, TRIES, random_texts

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.kit.counterparts import Speaker
    from autograder.kit.evidence import Event, Evidence, Part

STEPS = 2
"""The number of steps of simulated time from one text to the next. In each step a listener takes what it was sent."""
SIMULATED = 20
"""The number of texts for a listener that follows simulated time, all of them sent at the given pace."""
PATIENCE = {Pace.FAST: 1.0, Pace.REAL_TIME: 3.0}
"""Time limit in seconds of wall time for a listener to report a text."""
BEFORE = 1.0
"""Seconds to wait before the first text, to see whether the listener reports one that was not sent. They are simulated
for a listener that follows simulated time.
"""
REPLACED = 2
"""A listener that replaces its subscription at least this many times makes a new subscription for each text."""
AFTERMATH = 2.5
"""Seconds to wait after the last text, to see whether the listener repeats a text or reports one that was not sent.
They are simulated for a listener that follows simulated time.
"""


class Speaks:
    """The recipe for a subscriber that reports each text that it hears, with any words around it.

    Args:
        pace: Seconds between two successive texts, as another node would send them.
        paced_by: The name of the node with this pace, in words for a student.
    """

    roles = ("subscription",)

    def __init__(self, *, pace: float, paced_by: str) -> None:
        self._pace, self._paced_by = pace, paced_by
        self._step = pace / STEPS

    def scenario(self, bench: Bench) -> None:
        """Send texts that no program can guess: first some at the pace, then some one by one, each after a report."""
        topic, type_name = bench.reference.only("subscription")
        texts = random_texts(bench.random)
        bench.part("listening", texts=texts)
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
            # This pause has the same length as all others, so that the time of the next text does not depend on how
            # soon the listener reports this one.
            bench.run_time(self._pace, step=self._step)
        if not self._are_said(bench, texts[:1]):
            self._ask_once_more(bench, speaker, texts[1])
            return False
        if simulated:
            return self._are_said_at_pace(bench, speaker, texts[1:SIMULATED])
        kept = any(self._are_said_at_pace(bench, speaker, row) for row in _rows(texts))
        # If it missed some at that pace, two more texts show whether it reports texts for which it gets enough time.
        return all(self._is_answered(bench, speaker, text) for text in texts[-SINGLY:][: None if kept else 2])

    def _ask_once_more(self, bench: Bench, speaker: Speaker, text: str) -> None:
        """Send one more text to a listener that has reported nothing, because it may report the text before."""
        first = bench.seen().first("sent")
        if not bench.seen().said(after=first):
            speaker.send(data=text)
            bench.wait_until(lambda evidence: bool(evidence.main.said(after=first)), PATIENCE[Pace.FAST])

    def _are_said_at_pace(self, bench: Bench, speaker: Speaker, texts: Sequence[str]) -> bool:
        for text in texts:
            speaker.send(data=text)
            if not bench.run_time(self._pace, step=self._step):
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
        # A listener may use its own timer to report what it has heard.
        bench.run_time(PATIENCE[bench.pace], until=lambda: bench.wait_until(said, 0.0), step=self._step)
        return bench.wait_until(said, PATIENCE[bench.pace])

    def seen(self, evidence: Evidence) -> Part:
        """Return the record of the subject."""
        return evidence.main

    def expected(self, evidence: Evidence) -> Part:
        """Return the record of the subject, too: it contains the expected texts, which are drawn for each check."""
        return evidence.main

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, the most informative first."""
        return (
            unfinished.NEVER_CONSTRUCTED,
            *common.connecting("subscription"),
            OWN,
            Mistake("ended_too_early", unfinished.ended_too_early),
            Mistake("not_logged", _subscribes_again, certain=True),
            *common.spinning("subscription"),
            OWN_LATE,
            Mistake("wrong_text", _changed_text),
            Mistake("invented_text", _invented_text, certain=True),
            Mistake("callback_too_slow", self._too_slow),
            Mistake("not_logged", _not_logged),
            Mistake("everything_twice", _said_again, certain=True),
            *unfinished.NOTHING_THERE,
        )

    def _too_slow(self, evidence: Evidence) -> Advice | None:
        """The listener reports a text if it gets enough time, but misses texts that come at the pace."""
        texts, missing = list(evidence.main.inputs.get("texts", ())), _missing(evidence)
        singly = [event for event in _sent(evidence) if _text(event) in texts[-SINGLY:]]
        if _is_simulated(evidence) or not singly or not missing or any(event in singly for event in missing):
            return None
        if all(is_said(_text(event), evidence.main) for event in missing):
            return None  # only texts that came once more are missing
        return Advice(
            f"At the pace of {self._paced_by}, a string every {self._pace:g} s, your listener misses some, such as "
            f"“{_text(missing[0])}”; of strings that come one at a time it misses none.",
            "While a callback runs, new messages wait, and no more of them than the depth of the queue. Let the "
            "callback only log and return, without time.sleep, and give the subscription the depth 10.",
        )


# --- the scenario ------------------------------------------------------------------------------------------


def _rows(texts: Sequence[str]) -> list[Sequence[str]]:
    """Return the texts that are sent at the lab's pace in real time, as one group for each try."""
    return [texts[1 + AT_PACE * i : 1 + AT_PACE * (i + 1)] for i in range(TRIES)]


def _is_simulated(evidence: Evidence) -> bool:
    """Return True if the subject followed the judge's clock when the last text was sent."""
    sent = evidence.main.of("sent")
    return bool(sent) and sent[-1].sim is not None


def _says(texts: Sequence[str], evidence: Evidence) -> bool:
    """Return True if each of these texts was reported after it was sent, and again if it was sent again."""
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
    nothing = "it ended too soon to tell" if evidence.main.ending else "no subscription"
    seen = ", ".join(f"{name} ({kind})" for name, kind in sorted(made.items())) or nothing
    return Finding(made.get(topic) == type_name, f"{topic} ({type_name})", seen)


def _subscriptions(part: Part, topic: str) -> dict[str, str]:
    """Return the topics of subscriptions with their types; none for a program that ended before it was sent anything.

    For such a program, chance decides whether the graph showed its subscriptions before they were gone. A notebook's
    class is not spun until its subscriptions are known.
    """
    ending, sent = part.ending, part.first("sent", topic)
    met = ending is None or part.first("subject", "constructed") or (sent and _is_before(part, sent, ending))
    return part.endpoints("subscription") if met else {}


def _is_before(part: Part, event: Event, other: Event) -> bool:
    return part.events.index(event) < part.events.index(other)


def _missing(evidence: Evidence) -> list[Event]:
    """Return the texts that were not reported, except those sent at a pace that the listener kept in another try."""
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


def _replaced(evidence: Evidence) -> int:
    """Return how many subscriptions of the listener were replaced by another one after the first text was sent."""
    sent, part = _sent(evidence), evidence.main
    if not sent:
        return 0
    met = [event.data for event in part.of("matched", sent[0].name) if _is_before(part, sent[0], event)]
    gone = [data["count"] - data.get("now", data["count"]) for data in met]
    # A subscription that disappeared at the end of the program has no successor.
    return max((gone[i] for i in range(len(met) - 1) if met[-1]["count"] > met[i]["count"]), default=0)


def _expected_texts(evidence: Evidence) -> int:
    """Return the number of texts that are sent to a listener that says all of them."""
    return SIMULATED if _is_simulated(evidence) else 1 + AT_PACE + SINGLY


def says_every_text(evidence: Evidence) -> Finding:
    """Decide whether each text that was sent is reported afterwards."""
    sent, missing = _sent(evidence), _missing(evidence)
    topic, _ = evidence.reference.only("subscription")
    no_subscriber = f"no node subscribed to {topic}, so nothing was sent"
    seen = f"{len(sent) - len(missing)} of {len(sent)} said" if sent else no_subscriber
    if missing:
        seen += f"; not “{_text(missing[0])}”"
    complete = len(sent) >= _expected_texts(evidence) and not missing
    if complete and (replaced := _replaced(evidence)) >= REPLACED:
        return Finding(
            False, "one subscription, which hears every string", f"{replaced + 1} one after another"
        )
    if sent and not missing and not complete:
        seen += ", and then it no longer answered the judge"
    return Finding(complete, "every string in its log", seen)


def says_nothing_else(evidence: Evidence) -> Finding:
    """Decide whether the listener reports no text that was never sent, and none repeatedly."""
    sent = _sent_texts(evidence)
    heard_any = any(is_said(text, evidence.main) for text in sent)
    made_up, again = invented(evidence.main, sent), repeated(evidence.main, sent)
    anew = retold(evidence.main, sent)
    if made_up:
        seen = f"“{made_up[0]}”"
    elif again:
        seen = "“{}” {} times".format(*_most_often(again))
    elif anew:
        seen = f"with each string all before it once more: “{anew}”"
    else:
        seen = "only what was sent" if heard_any else "it said none of the strings"
    return Finding(
        heard_any and not (made_up or again or anew), "only what was sent, and each string only once", seen
    )


def _most_often(again: Mapping[str, int]) -> tuple[str, int]:
    return max(again.items(), key=lambda item: item[1])


def _said_again(evidence: Evidence) -> Advice | None:
    """The listener reports texts more often than they were sent."""
    sent = _sent_texts(evidence)
    again = repeated(evidence.main, sent)
    if not again and retold(evidence.main, sent):
        return Advice(
            "With each string that arrives, your program says all that came before once more.",
            "Log the string of the message that the callback was just given, its field data, and not the list or text "
            "in which you keep them all.",
        )
    if not again:
        return None
    text, times = _most_often(again)
    return Advice(
        f"Your program says “{text}” {times} times for one message.",
        "Call create_subscription once, in __init__, and log in its callback, once for each message: a timer cannot "
        "know whether a message came. In a notebook, an earlier run of the cell may have left a node of its own.",
    )


def _changed_text(evidence: Evidence) -> Advice | None:
    """The listener reports some texts with changes."""
    part, sent = evidence.main, _sent(evidence)
    for event in _missing(evidence):
        later = sent[sent.index(event) + 1 :][:1]
        then = part.said(after=event)
        lines = then[: len(then) - len(part.said(after=later[0]))] if later else then
        made_up = [line for line in changed(part, _sent_texts(evidence), _text(event)) if line in lines]
        if made_up:
            return Advice(
                f"When “{_text(event)}” was sent, your node said “{made_up[0]}”: that is not the string as it came.",
                "Log the field data of the message as it is, without strip, replace, slices or other changes.",
            )
    return None


def _subscribes_again(evidence: Evidence) -> Advice | None:
    """The listener makes a new subscription for each text: messages sent in between are lost."""
    if not _replaced(evidence):
        return None
    return Advice(
        "Your program takes its subscription away and makes a new one after a string has come. A string that is sent "
        "in between is lost, so how many it logs is chance.",
        "Call create_subscription once, before you spin, and log in its callback. wait_for_message makes a "
        "subscription of its own each time that you call it.",
    )


def _not_logged(evidence: Evidence) -> Advice | None:
    """The listener is subscribed and was sent texts, but reports none of them."""
    topic, _ = evidence.reference.only("subscription")
    part, sent = evidence.main, _sent(evidence)
    silent = next(iter(_missing(evidence)), None)
    if silent is None or not subscribes(evidence).passed:
        return None
    words = list(filter(str.strip, part.said(after=silent)))
    bytes_said = next((line for line in words if _text(silent) in line), None)
    if bytes_said is not None:
        return Advice(
            f"Your node said “{bytes_said}”: these are the bytes of the message as they travel, not its string.",
            "Leave raw=True out of create_subscription: the callback then gets a message with a string in it.",
        )
    if any(is_said(_text(event), part) for event in sent):
        return Advice(
            f"Your node said some of the strings, but not “{_text(silent)}” when that was sent.",
            "Log the string of every message that the callback is given: without `once`, throttling or a condition, "
            "and not one that you kept before.",
        )
    if not words:
        return Advice(
            f"Your node is subscribed to {topic}, but when a string arrives it says nothing.",
            "In the callback, log the field data of the message that it is given, as in "
            "self.get_logger().info(f'I heard: \"{message.data}\"'). If you print it, leave out end=...: a line counts "
            "when it has ended.",
        )
    return Advice(
        f"When “{_text(silent)}” was sent, your node said “{words[0]}”: the string that arrived is not in it.",
        "Put the field data of the message into the line that you log, in braces, with an f before the string.",
    )


def _invented_text(evidence: Evidence) -> Advice | None:
    """The listener reports texts that were never sent."""
    made_up = invented(evidence.main, _sent_texts(evidence))
    if not made_up:
        return None
    return Advice(
        f"Your node said “{made_up[0]}”, but no node sent that.",
        "Log only in the subscription's callback: the field data of the message that it was given, unchanged.",
    )
