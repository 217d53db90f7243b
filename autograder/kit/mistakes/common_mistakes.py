"""Mistakes that can occur in several exercises, recognized from what the judge saw on the ROS graph."""

from __future__ import annotations

import difflib
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.counterparts import Qos
from autograder.kit.mistakes.hangs import UNSPUN, answered, something_spins
from autograder.kit.model import Advice, Mistake, card_words, mistake
from autograder.kit.output.launched_processes import processes
from autograder.kit.reported_texts import said_first_after

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from autograder.kit.evidence import Event, Evidence, Part

_WORDS = card_words(__file__)

WORDS = {
    "publisher": ("publishes on", "topic", "create_publisher"),
    "subscription": ("subscribes to", "topic", "create_subscription"),
    "client": ("asks for the service", "service", "create_client"),
    "service": ("serves", "service", "create_service"),
    "action_client": ("asks for the action", "action", "ActionClient"),
    "action_server": ("serves the action", "action", "ActionServer"),
}
"""For each role of an endpoint: a verb, a noun, and what makes such an endpoint."""
_MATCHING_QOS = {
    Qos.DEFAULT: (
        "Write the queue depth 10 instead of a QoS profile. The QoS is then reliable and volatile, like that of the "
        "other node."
    ),
    Qos.SENSOR: (
        "The other node is best effort, as sensors are. Write a QoSProfile with ReliabilityPolicy.BEST_EFFORT, or "
        "qos_profile_sensor_data, both from rclpy.qos, instead of the queue depth."
    ),
    Qos.LATCHED: (
        "The other node is transient local, as for a message that late subscribers get, too. Write "
        "QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL), from rclpy.qos, instead of the queue depth."
    ),
}
_VOLATILE = (
    "The other node is volatile: it stores no message. Leave DurabilityPolicy.TRANSIENT_LOCAL out of yours."
)
_ALL_STARTED = "Does your launch file start every program of the task? One of them may use the missing name."
_KEY = {"topic": "topic_name", "service": "service_name", "action": "action_name"}


def _wanted(evidence: Evidence, role: str) -> Mapping[str, str]:
    """Return the types of the reference solution's endpoints of a role, by name. At least one must exist."""
    evidence.reference.only(role)
    return evidence.reference.interface[role]


def endpoint_name(role: str) -> Mistake:
    """Return the mistake of an endpoint with a wrong name: the expected name is missing, and another one exists."""
    verb, noun, maker = WORDS[role]

    def strange_and_missing(evidence: Evidence) -> tuple[str, str] | None:
        wanted = _wanted(evidence, role)
        made: set[str] = set().union(*(part.endpoints(role) for part in evidence))
        missing, strange = sorted(wanted.keys() - made), made - wanted.keys()
        if not missing or not strange:
            return None
        closest = difflib.get_close_matches(missing[0], strange, n=1, cutoff=0.0) or sorted(strange)
        return closest[0], missing[0]

    usual = mistake(
        _KEY[noun],
        strange_and_missing,
        f"Your node {verb} {{0[0]}}, but the task asks for the {noun} {{0[1]}}.",
        f"Compare the names in `ros2 {noun} list` letter by letter: two nodes are connected only if the names are "
        "equal. If `~/` or a namespace stands before the name, your code or your launch file adds it: remove it "
        "there.",
        certain=True,
        uses=(maker,),
    )

    def recognize(evidence: Evidence) -> Advice | None:
        advice, names = usual.recognize(evidence), strange_and_missing(evidence)
        if advice is None or names is None or not processes(evidence.main):
            return advice
        text = f"No program of yours {verb} {names[1]}, as the task asks; one {verb} {names[0]}."
        return replace(advice, text=text, next_step=f"{_ALL_STARTED} {advice.next_step}")

    return replace(usual, recognize=recognize)


def message_type(role: str) -> Mistake:
    """Return the mistake "wrong type": an endpoint has the right name and the wrong type."""

    def mixed_up(evidence: Evidence) -> tuple[str, ...] | None:
        wanted, made = _wanted(evidence, role), evidence.main.endpoints(role)
        name = next((name for name in sorted(wanted) if made.get(name, wanted[name]) != wanted[name]), None)
        return (name, made[name], wanted[name], *wanted[name].split("/")) if name else None

    return mistake("message_type", mixed_up, *_WORDS["message_type"], certain=True, uses=WORDS[role][2:])


def qos_mismatch(role: str) -> Mistake:
    """Return the mistake "QoS mismatch": the QoS settings of the subject and of the judge are not compatible."""

    def mismatch(evidence: Evidence) -> Event | None:
        misfits = (e for name in sorted(_wanted(evidence, role)) for e in evidence.main.of("mismatch", name))
        return next((event for event in misfits if not evidence.main.of("message", event.name)), None)

    def recognize(evidence: Evidence) -> Advice | None:
        if (event := mismatch(evidence)) is None:
            return None
        qos = event.data.get("qos", Qos.DEFAULT)
        return Advice(
            f"Your node and the other node both use {event.name}, but their QoS settings for {event.data['policy']} "
            "are not compatible, so no message arrives.",
            _MATCHING_QOS[qos] if event.data["policy"] != "durability" or qos == Qos.LATCHED else _VOLATILE,
        )

    return Mistake("qos_mismatch", recognize, certain=True)


KEEP_THE_PERIOD = (
    "Give create_timer the period in seconds, publish once in its callback, and leave time.sleep out of it."
)
"""The next step for a node that publishes at a wrong rate."""
NOT_LATCHED = _WORDS["not_latched"]
"""The two texts about a publisher for which :func:`is_not_latched` is true."""


def is_not_latched(seen: Part, _: Part | None = None) -> bool:
    """Return True if the judge asked for the last message of a publisher that does not store it."""
    return any(event.data["policy"] == "durability" for event in seen.of("mismatch"))


def servers(part: Part) -> int:
    """Return the largest number of servers of the subject that existed at the same time."""
    return max((int(event.data["count"]) for event in part.of("servers")), default=0)


def misfit(evidence: Evidence, role: str) -> str:
    """Return in words what is wrong with the subject's server: its name, its type, or how many there are.

    Return an empty text if the subject has exactly the server of this role that the reference has.
    """
    name, type_name = evidence.reference.only(role)
    made, noun = evidence.main.endpoints(role), role.replace("_", " ")
    if name not in made:
        return f"the {noun} {', '.join(sorted(made))}" if made else f"no {noun}"
    if made[name] != type_name:
        return f"{name} is a {made[name]}"
    count = servers(evidence.main)
    return f"{count} servers of {name}" if count > 1 else ""


def two_servers(role: str, comes_of_it: str, next_step: str) -> Mistake:
    """Return the mistake "two servers": the subject has two servers with the same name.

    Args:
        role: ``service`` or ``action_server``.
        comes_of_it: A sentence for the student that says what this means for a call or a goal.
        next_step: What the student should do now.
    """
    return mistake(
        "two_servers",
        lambda evidence: (count := servers(evidence.main)) > 1 and (count, evidence.reference.only(role)[0]),
        f"{{0[0]}} servers of {{0[1]}} are on the graph. {comes_of_it}",
        next_step,
        certain=True,
    )


def _int_as_float(evidence: Evidence) -> tuple[str, str, float] | None:
    """Return the topic and path of a number that no calculation gives, and the number; None if there is none.

    rclpy does not check the types of fields. It reads the first bytes of an int as if they were a float's: these are
    the count of the int's digits (CPython's ``longintrepr.h``), and no float that a program means is so close to 0.
    """
    for part in evidence:
        for event in part.of("message"):
            for path, value in _floats(event.data["fields"]):
                if 0.0 < abs(value) < sys.float_info.min:
                    return event.name, path, value
    return None


def _floats(fields: Mapping[str, object], path: str = "") -> Iterator[tuple[str, float]]:
    for name, value in fields.items():
        if isinstance(value, dict):
            yield from _floats(value, f"{path}{name}.")
        elif isinstance(value, float):
            yield f"{path}{name}", value


INT_IN_A_FLOAT = mistake("field_type", _int_as_float, *_WORDS["field_type"], certain=True)
"""The mistake of a whole number in a field for numbers with a point, of which rclpy says nothing."""


def never_spun(role: str) -> Mistake:
    """Return the mistake "never spun": the endpoint exists, but its node never ran a callback and does not answer."""
    return mistake(
        UNSPUN,
        lambda evidence: _silent_node(evidence, role) and not _was_spun(evidence.main, role),
        *_WORDS["never_spun"],
    )


def went_deaf(role: str) -> Mistake:
    """Return the mistake of a node that ran callbacks at first, then none any more, although it still exists."""
    return mistake(
        "node_taken_from_executor",
        lambda evidence: _silent_node(evidence, role) and _was_spun(evidence.main, role),
        *_WORDS["node_taken_from_executor"],
    )


def _was_spun(part: Part, role: str) -> bool:
    # A thread that was spinning when the subject hung also shows that the node was spun, because the judge may have
    # missed what the node did before.
    return worked(part, role) or something_spins(part)


def _awaits_in_vain(evidence: Evidence) -> bool:
    """Return True if, in a run that did not end, the subject waits for an answer that has come.

    The subject still spins, but did nothing after its last answer.
    """
    return any(part.ending is None and something_spins(part) and _left_an_answer(part) for part in evidence)


def _left_an_answer(part: Part) -> bool:
    # The answer to a goal counts only if the node no longer responds, because a client that only sends a goal may keep
    # spinning after the answer.
    answers = part.of("response") + (part.of("goal_answered") if part.of("unanswered") else [])
    if not answers:
        return False
    last = max(answers, key=part.events.index)
    later = part.events[part.events.index(last) :]
    acts = {"request", "goal", "cancel", "result_request", "message"}
    return not said_first_after(last, part) and acts.isdisjoint(event.kind for event in later)


AWAITS_IN_VAIN = mistake("await_in_same_group", _awaits_in_vain, *_WORDS["await_in_same_group"])
"""The mistake of code that never goes on after its answer came, because the code itself blocks what it waits for.

Recipes list this mistake after :data:`HANGS`, and before the mistakes of a node that is not spun.
"""


def _silent_node(evidence: Evidence, role: str) -> bool:
    part = evidence.main
    there = _wanted(evidence, role).keys() & part.endpoints(role)
    return bool(there) and part.ending is None and bool(part.of("unanswered"))


def worked(part: Part, role: str) -> bool:
    """Return True if the subject did something that a node can do only if it is spun."""
    if part.of("message") or answered(part):
        return True
    sent = part.first("sent")
    return role == "subscription" and sent is not None and bool(part.said(after=sent))


_TWIN = re2.compile(
    r"\[rcl\.logging_rosout\]: Publisher already registered for (?:provided )?node name:? '([^']*)'"
)


def twin(part: Part) -> str:
    """Return the name that two of the subject's nodes share, as rcl or the notebook reports it; empty if none."""
    made = part.first("subject", "constructed")
    found = (_TWIN.search(str(event.data["text"])) for event in part.of("output"))
    told = next((str(match[1]) for match in found if match), "")
    return told or str(made.data.get("twin", "") if made else "")


def only_if_ended(mistake: Mistake) -> Mistake:
    """Return a mistake that is recognized only if the subject ended by itself in each run.

    The mistake counts as certain, because timing has no influence on runs that the judge did not stop.
    """

    def recognize(evidence: Evidence) -> Advice | None:
        return mistake.recognize(evidence) if all(part.ending for part in evidence) else None

    return Mistake(mistake.key, recognize, certain=True)
