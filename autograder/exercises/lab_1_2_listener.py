"""Lab 1.2, the listener: says what it hears, and nothing else."""

from __future__ import annotations

import re
from functools import partial
from typing import TYPE_CHECKING

from autograder.exercises import common_mistakes as common
from autograder.exercises.hangs import HANGS
from autograder.exercises.model import Advice, Bench, Criterion, Exercise, Finding, Look, Mistake

if TYPE_CHECKING:
    from collections.abc import Sequence
    from random import Random

    from autograder.exercises.evidence import Event, Evidence, Part

TEXTS = 6
"""Texts that are sent, each once the one before was said."""
PATIENCE = {Look.FAST: 1.0, Look.REAL_TIME: 3.0}
"""Seconds of wall time in which a text that was sent must have been said."""
AFTERMATH = 1.5
"""Seconds (simulated where it follows the clock) after the last text, in which nothing may be made up."""

_WORDS = (
    "amber", "birch", "cedar", "delta", "ember", "fjord", "grove", "harbour", "islet", "juniper", "kelp", "lagoon",
    "meadow", "north", "orchard", "pebble", "quarry", "river", "summit", "tundra",
)  # fmt: skip


def scenario(bench: Bench) -> None:
    """Send texts that nobody can guess, one after the other, and wait until each is said."""
    topic, type_name = bench.reference.only("subscription")
    texts = random_texts(bench.random)
    bench.part("listening", texts=texts)
    speaker = bench.speak(topic, type_name)
    bench.start()
    if bench.await_endpoint("subscription", topic):
        bench.release()
        for text in texts:
            speaker.send(data=text)
            if not bench.wait_until(partial(_says, text), PATIENCE[bench.look]):
                bench.note_whether_it_spins()
                break
        else:
            bench.run_time(AFTERMATH)
    bench.stop()


def random_texts(random: Random) -> list[str]:
    """Texts of two words and a number; none is part of another."""
    numbers = random.sample(range(1000, 10000), TEXTS)
    return [f"{random.choice(_WORDS)} {random.choice(_WORDS)} {number}" for number in numbers]


def _is_said(text: str, part: Part) -> bool:
    return any(text in line for line in part.said())


def _says(text: str, evidence: Evidence) -> bool:
    return _is_said(text, evidence.main)


def _sent(part: Part, topic: str) -> list[Event]:
    return part.of("sent", topic)


def _said_after_sent(part: Part, event: Event) -> bool:
    text = str(event.data["fields"]["data"])
    return any(text in line for line in part.said(after=event))


def invented(part: Part, sent: Sequence[str]) -> list[str]:
    """What it claims to have heard although nobody sent it.

    Its own way of saying is learnt from the lines that carry a sent text: what stands before and after the
    text. A
    line with the same frame and another text in it was invented. Where it said none of the texts, a line with
    a
    quoted text is taken for such a claim.
    """
    spoken = part.said()
    lines = [line for line in spoken if not any(text in line for text in sent)]
    frames = {_frame(line, text) for line in spoken for text in sent if text in line}
    if not frames:
        return [] if part.traceback else [line for line in lines if re.search(r"[\"“«].*\w.*[\"”»]", line)]
    return [
        line
        for line in lines
        for before, after in frames
        if len(before.strip()) > 3 and line.startswith(before) and line.endswith(after)
    ]


def _frame(line: str, text: str) -> tuple[str, str]:
    before, _, after = line.partition(text)
    return before, after


def subscribes(evidence: Evidence) -> Finding:
    """A subscription of the subject's is on the topic with the right type."""
    topic, type_name = evidence.reference.only("subscription")
    made = evidence.main.endpoints("subscription")
    seen = ", ".join(f"{name} ({kind})" for name, kind in sorted(made.items())) or "no subscription"
    return Finding(made.get(topic) == type_name, f"{topic} ({type_name})", seen)


def says_every_text(evidence: Evidence) -> Finding:
    """Each text that was sent is said afterwards."""
    topic, _ = evidence.reference.only("subscription")
    part = evidence.main
    sent = _sent(part, topic)
    said = [event for event in sent if _said_after_sent(part, event)]
    missing = next((e for e in sent if e not in said), None)
    seen = f"{len(said)} of {TEXTS} said"
    if missing is not None:
        seen += f"; not “{missing.data['fields']['data']}”"
    return Finding(len(said) == TEXTS, f"all {TEXTS} texts in its log", seen)


def says_nothing_else(evidence: Evidence) -> Finding:
    """It claims no text that was never sent."""
    topic, _ = evidence.reference.only("subscription")
    sent = [str(event.data["fields"]["data"]) for event in _sent(evidence.main, topic)]
    heard_any = any(_is_said(text, evidence.main) for text in sent)
    made_up = invented(evidence.main, sent)
    seen = (
        f"“{made_up[0]}”" if made_up else "only what was sent" if heard_any else "it said none of the texts"
    )
    return Finding(heard_any and not made_up, "only what was sent", seen)


def not_logged(evidence: Evidence) -> Advice | None:
    """It is subscribed, was sent texts and says none of them."""
    topic, _ = evidence.reference.only("subscription")
    part = evidence.main
    sent = _sent(part, topic)
    silent = next((event for event in sent if not _said_after_sent(part, event)), None)
    if silent is None or not subscribes(evidence).passed:
        return None
    if silent is not sent[0]:
        return Advice(
            f"Your node said the first texts, but not “{silent.data['fields']['data']}”.",
            "Log every message that the callback is given, without `once`, throttling or a condition.",
        )
    if len(part.said(after=sent[0])) == 0:
        return Advice(
            f"Your node is subscribed to {topic}, but when a text arrives it says nothing.",
            "In the callback, log the text: self.get_logger().info(f'I heard: \"{msg.data}\"'). Is the node "
            "spun?",
        )
    return Advice(
        f"When “{sent[0].data['fields']['data']}” was sent, your node said “{part.said(after=sent[0])[0]}”: "
        f"the text "
        "that arrived is not in it.",
        "Put msg.data into the line that you log.",
    )


def invented_text(evidence: Evidence) -> Advice | None:
    """It says what nobody sent."""
    topic, _ = evidence.reference.only("subscription")
    sent = [str(event.data["fields"]["data"]) for event in _sent(evidence.main, topic)]
    made_up = invented(evidence.main, sent)
    if not made_up:
        return None
    return Advice(
        f"Your node said “{made_up[0]}”, but nobody sent that.",
        "Log only in the subscription's callback, and only the text of the message that it was given.",
    )


EXERCISE = Exercise(
    id="lab_1_2.listener",
    title="Lab 1.2 · The listener",
    task="Say every text that arrives on the topic.",
    scenario=scenario,
    criteria=(
        Criterion("topic", "Subscribes to the right topic and type", 3, subscribes),
        Criterion("says", "Says every text it hears", 5, says_every_text),
        Criterion("honest", "Says only what it heard", 2, says_nothing_else),
    ),
    mistakes=(
        *common.CRASHES,
        common.NEVER_CONSTRUCTED,
        common.endpoint_name("subscription"),
        common.message_type("subscription"),
        common.qos_mismatch("subscription"),
        *common.OTHER_CRASHES,
        Mistake("ended_too_early", common.ended_too_early),
        *HANGS,
        common.never_spun("subscription"),
        common.went_deaf("subscription"),
        Mistake("invented_text", invented_text, certain=True),
        Mistake("not_logged", not_logged),
        *common.NOTHING_THERE,
    ),
    roles=("subscription",),
)
