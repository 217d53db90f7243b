"""Lab 1.2, the talker: a counted greeting on a topic, at a steady rate."""

from __future__ import annotations

import re
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING

from autograder.exercises import common_mistakes as common
from autograder.exercises.hangs import HANGS
from autograder.exercises.model import Advice, Bench, Criterion, Exercise, Finding, Look, Mistake

if TYPE_CHECKING:
    from autograder.exercises.evidence import Event, Evidence, Part, Reference

MESSAGES = {Look.FAST: 8, Look.REAL_TIME: 7}
"""Messages that are listened to; six intervals in real time, whose median one late message does not move."""
USUAL_PERIOD = 0.5
"""Seconds; stands in for the reference's period while that is being recorded."""
SILENCE = 6
"""Periods of silence after which nothing more is waited for."""
ONE_MOMENT = 0.1
"""Seconds within which messages count as published all at once."""
CREDIBLE = 0.4
"""The part of the time over which messages were sent, by their publisher's clock, over which they must arrive."""
RATE_TOLERANCE = 0.2
"""How far the median interval may be from the reference's, as a part of it."""


def scenario(bench: Bench) -> None:
    """Listen to what it publishes until enough was heard or it has had twice the time it needs."""
    topic, type_name = bench.reference.only("publisher")
    enough = MESSAGES[bench.look]
    bench.part("talking")
    bench.listen(topic, type_name)
    bench.start()
    if bench.await_endpoint("publisher", topic):
        bench.release()
        period = _reference_period(bench.reference)
        bench.run_time(
            2 * enough * period, until=lambda: bench.heard(topic) >= enough, quiet=SILENCE * period
        )
        if bench.heard(topic) < enough:
            bench.note_whether_it_spins()
    bench.stop()


def texts(part: Part, topic: str) -> list[str]:
    """The texts heard on a topic."""
    return [str(event.data["fields"].get("data")) for event in part.of("message", topic)]


def intervals(messages: list[Event]) -> list[float]:
    """Seconds between messages: simulated ones where there are any, else by the publisher's own clock.

    The first simulated interval is left out: the jump to simulated time distorts it.
    """
    simulated = [event.sim for event in messages if event.sim is not None]
    times = simulated[1:] or _sent_times(messages)
    return [later - earlier for earlier, later in pairwise(times)]


def _sent_times(messages: list[Event]) -> list[float]:
    """When each message was sent: as the publisher says, unless they came too close together for that to be true.

    A busy judge gets messages late and close together, but hardly all of them; a publisher whose clock was tampered
    with says what it likes.
    """
    arrived = [event.t for event in messages]
    sent = [float(event.data.get("sent", event.t)) for event in messages]
    credible = len(messages) < 2 or arrived[-1] - arrived[0] >= CREDIBLE * (sent[-1] - sent[0])
    return sent if credible else arrived


def _reference_period(reference: Reference) -> float:
    if not reference.parts:
        return USUAL_PERIOD
    topic, _ = reference.only("publisher")
    return median(intervals(reference.part("talking").of("message", topic)))


def _template(text: str) -> str:
    return re.sub(r"-?\d+", "#", text)


def _counters(heard: list[str]) -> list[int]:
    return [int(numbers[-1]) for text in heard if (numbers := re.findall(r"-?\d{1,18}", text))]


def _expected(evidence: Evidence) -> tuple[str, str, list[str]]:
    topic, type_name = evidence.reference.only("publisher")
    return topic, type_name, texts(evidence.reference.part("talking"), topic)


def publishes_on_the_topic(evidence: Evidence) -> Finding:
    """A publisher of the subject's is on the topic."""
    topic, _, _ = _expected(evidence)
    published = evidence.main.endpoints("publisher")
    seen = f"publishes on {', '.join(sorted(published))}" if published else "no publisher"
    return Finding(topic in published, f"a publisher on {topic}", seen)


def has_the_type(evidence: Evidence) -> Finding:
    """The publisher has the reference's message type."""
    topic, type_name, _ = _expected(evidence)
    seen = evidence.main.endpoints("publisher").get(topic)
    return Finding(seen == type_name, type_name, seen or f"nothing on {topic}")


def says_the_text(evidence: Evidence) -> Finding:
    """Every text is the reference's, the number aside."""
    topic, _, expected = _expected(evidence)
    heard = texts(evidence.main, topic)
    wanted = {_template(text) for text in expected}
    odd = [text for text in heard if _template(text) not in wanted]
    seen = f"“{(odd or heard)[0]}”" if heard else "no message arrived"
    return Finding(bool(heard) and not odd, f"“{expected[0]}”, “{expected[1]}”, …", seen)


def starts_right(evidence: Evidence) -> bool:
    """Whether the first number is the reference's, also where messages were sent before anybody could hear them.

    A loop may publish in the moment in which it makes its publisher, which no listener can be quick enough
    for. DDS
    numbers each publisher's messages from 1, so that what was lost is known.
    """
    topic, _, expected = _expected(evidence)
    wanted = _counters(expected)[0]
    for event in evidence.main.of("message", topic)[:1]:
        numbers = _counters([str(event.data["fields"].get("data"))])
        return bool(numbers) and numbers[0] - (int(event.data.get("number", 1)) - 1) == wanted
    return False


def counts_from_zero(evidence: Evidence) -> Finding:
    """The numbers are the reference's, from the first message on."""
    topic, _, expected = _expected(evidence)
    wanted = _counters(expected)
    heard = _counters(texts(evidence.main, topic))
    enough = MESSAGES[Look.REAL_TIME if evidence.real_time else Look.FAST]
    steady = len(heard) >= enough and heard == list(range(heard[0], heard[0] + len(heard)))
    fits = steady and starts_right(evidence)
    seen = ", ".join(map(str, heard)) if len(heard) < enough else _row(heard[:5])
    return Finding(fits, _row(wanted[:5]), seen or "no number arrived")


def keeps_the_rate(evidence: Evidence) -> Finding:
    """The median interval is near the reference's."""
    topic, _, _ = _expected(evidence)
    wanted = _reference_period(evidence.reference)
    gaps = intervals(evidence.main.of("message", topic))
    if not gaps:
        return Finding(
            False, f"one every {wanted:g} s", f"{len(evidence.main.of('message', topic))} messages in all"
        )
    seen = median(gaps)
    return Finding(
        abs(seen - wanted) <= RATE_TOLERANCE * wanted, f"one every {wanted:g} s", f"one every {seen:.2g} s"
    )


def _row(numbers: list[int]) -> str:
    return ", ".join(map(str, numbers)) + ", …"


def wrong_rate(evidence: Evidence) -> Advice | None:
    """Everything but the rate is right."""
    finding = keeps_the_rate(evidence)
    if finding.passed or not says_the_text(evidence).passed or "every" not in finding.seen:
        return None
    return Advice(
        f"Your talker publishes {finding.seen}; the task asks for {finding.expected}.",
        "Look at the first argument of create_timer: it is the period in seconds (0.5), not a frequency.",
    )


def counter_start(evidence: Evidence) -> Advice | None:
    """It counts by one, but from another number."""
    topic, _, expected = _expected(evidence)
    heard, wanted = _counters(texts(evidence.main, topic)), _counters(expected)
    steady = len(heard) > 1 and all(b - a == 1 for a, b in pairwise(heard))
    if not steady or starts_right(evidence):
        return None
    return Advice(
        f"The first message carries the number {heard[0]}; the counter must begin at {wanted[0]}.",
        f"Set self.i = {wanted[0]} in __init__ and add 1 only after the message was published.",
    )


def counter_stuck(evidence: Evidence) -> Advice | None:
    """The number never changes."""
    heard = _counters(texts(evidence.main, _expected(evidence)[0]))
    if len(heard) < 3 or len(set(heard)) > 1:
        return None
    return Advice(
        f"Every message carries the number {heard[0]}: the counter is never counted up.",
        "Add self.i += 1 at the end of the timer callback. A plain i = i + 1 counts a local variable.",
    )


def counter_step(evidence: Evidence) -> Advice | None:
    """The numbers do not go up by one."""
    heard = _counters(texts(evidence.main, _expected(evidence)[0]))
    if len(heard) < 3 or all(b - a == 1 for a, b in pairwise(heard)):
        return None
    if any(heard.count(number) > 1 for number in heard) and sorted(set(heard)) == list(
        range(min(heard), max(heard) + 1)
    ):
        return None  # everything comes twice, which has a diagnosis of its own
    return Advice(
        f"The numbers come as {_row(heard[:6])} They must go up by one with each message.",
        "Count once for each published message: one self.i += 1 at the end of the callback, and one timer.",
    )


def empty_text(evidence: Evidence) -> Advice | None:
    """Messages arrive, and every text is empty."""
    heard = texts(evidence.main, _expected(evidence)[0])
    if not heard or any(heard):
        return None
    return Advice(
        "Your messages arrive, but their text is empty: the field was never filled.",
        "A String has one field, data. Write msg.data = ...; a misspelt keyword in String(...) is ignored "
        "silently.",
    )


def never_published(evidence: Evidence) -> Advice | None:
    """The node works and talks about publishing, and nothing is published."""
    topic, _, _ = _expected(evidence)
    part = evidence.main
    idle = part.ending is None and not part.of("unanswered")
    if topic not in part.endpoints("publisher") or part.of("message", topic) or not idle:
        return None
    return Advice(
        "Your node is spun and has its publisher, but nothing is ever published on it.",
        "Does a timer call your callback, and does the callback call self.publisher_.publish(msg)?",
    )


def published_before_discovery(evidence: Evidence) -> Advice | None:
    """It says that it published, and ended before anybody could hear it."""
    topic, _, expected = _expected(evidence)
    part = evidence.main
    ended = part.ending is not None and not part.traceback
    claims = [line for line in part.said() if _template(expected[0]) in _template(line)]
    heard = part.of("message", topic)
    if not ended or not claims or (heard and heard[-1].t - heard[0].t > ONE_MOMENT):
        return None
    return Advice(
        "Your program published everything in its first moment and ended before anybody could be connected "
        "to it.",
        "Publish from a timer and keep the program spinning: it takes a moment until publisher and "
        "subscription have "
        "found each other.",
    )


def wrong_text(evidence: Evidence) -> Advice | None:
    """Messages arrive, but with another text."""
    topic, _, _ = _expected(evidence)
    finding = says_the_text(evidence)
    if finding.passed or not texts(evidence.main, topic):
        return None
    return Advice(
        f"Your talker says {finding.seen}; the task asks for {finding.expected}",
        "Compare the two letter by letter: capitals, the comma, the exclamation mark and the space before "
        "the "
        "number all count, because other nodes read this text.",
    )


EXERCISE = Exercise(
    id="lab_1_2.talker",
    title="Lab 1.2 · The talker",
    task="Publish a counted greeting on the topic every half second.",
    scenario=scenario,
    criteria=(
        Criterion("topic", "Publishes on the right topic", 2, publishes_on_the_topic),
        Criterion("type", "Publishes the right message type", 1, has_the_type),
        Criterion("text", "Says the right text", 2, says_the_text),
        Criterion("counter", "Counts up from the start", 2, counts_from_zero),
        Criterion("rate", "Keeps the rate", 3, keeps_the_rate),
    ),
    mistakes=(
        *common.CRASHES,
        common.NEVER_CONSTRUCTED,
        common.endpoint_name("publisher"),
        common.message_type("publisher"),
        common.qos_mismatch("publisher"),
        *common.OTHER_CRASHES,
        common.everything_twice("publisher"),
        Mistake("published_before_discovery", published_before_discovery),
        Mistake("field_typo", empty_text, certain=True),
        Mistake("counter_stuck", counter_stuck, certain=True),
        Mistake("wrong_text", wrong_text, certain=True),
        *HANGS,
        common.never_spun("publisher"),
        common.went_deaf("publisher"),
        Mistake("counter_start", counter_start),
        Mistake("counter_step", counter_step),
        Mistake("ended_too_early", common.ended_too_early),
        Mistake("wrong_rate", wrong_rate),
        Mistake("never_published", never_published),
        *common.NOTHING_THERE,
    ),
    roles=("publisher",),
)
