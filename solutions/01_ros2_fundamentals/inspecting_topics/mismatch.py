"""Inspecting topics: find out on the graph why two nodes do not hear each other.

The judge plants a talker and a listener that do not meet, under random names, and asks for the name and the type that
each of them uses. No code that the student can read contains them: they must be looked up.
"""

from __future__ import annotations

import ast
import json
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit.draft import OWN, Draft
from autograder.kit.evidence import Evidence
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES
from autograder.kit.model import Advice, Bench, Finding, Pace
from autograder.kit.recipes.own_scenario import OwnLadder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from random import Random

    from autograder.kit.evidence import Part

KEYS = ("topic_published", "topic_subscribed", "type_published", "type_subscribed")
"""The keys of the dictionary that is asked for."""
CASES = ("the name differs", "the type differs", "both differ")
MAX_QUOTED = 200
"""Characters of a line that a card quotes."""
ANSWERING = {Pace.FAST: 8.0, Pace.REAL_TIME: 15.0}
"""Seconds of wall time for an answer; discovery takes up to three in a process that has just started."""

_EVERYWHERE = ("/rosout", "/parameter_events", "/clock")
_GAVE_UP = re2.compile(r"(?m)^TimeoutError(?:: .*)?$")
_EARLY = ("battery", "beacon", "camera", "compass", "gripper", "lamp", "lidar")
_LATE = ("servo", "sonar", "tracker", "valve", "wheel")
"""In the sorted list of a node's topics, the former come before /parameter_events and /rosout, and the latter after
them. One case has a topic of the former kind and one has topics of the latter, so a subject that looks only at the
first topic of a node, or only at the last, is wrong in each run.
"""
_BYSTANDERS = ("actuator", "adapter", "aerial", "airbag")
_OTHERS = ("zapper", "zester", "zipper", "zither")
"""The former come first in every list of names and the latter last, so that who takes the first one that there is, or
the last, takes the same in each run."""
_QUALITIES = ("state", "status", "level", "position", "speed", "report", "alarm", "mode")
_TYPES = tuple(
    f"std_msgs/msg/{name}"
    for name in (
        "String", "Bool", "Char", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "Float32", "Float64",
    )
)  # fmt: skip
"""Three of twelve in the right order: one guess in 1,320 is right."""
_OTHER_TYPES = tuple(
    f"geometry_msgs/msg/{name}"
    for name in ("Accel", "Point", "Pose", "Pose2D", "Quaternion", "Transform", "Twist", "Vector3", "Wrench")
)
"""Types of another package. If the two sides differ, one of them has one of these."""


def scenario(bench: Bench) -> None:
    """Plant three pairs, one after the other, and ask about each."""
    for case, planted in mismatches(bench.random):
        bench.part(case, **planted)
        # Made first, it comes first among the endpoints of a topic: a subject that checks one only is wrong.
        bench.plant(planted["bystander"], **bystander(planted))
        bench.plant(
            planted["talker"],
            publishes={planted["topic_published"]: planted["type_published"]},
            subscribes={},
        )
        bench.plant(
            planted["listener"],
            publishes={},
            subscribes={planted["topic_subscribed"]: planted["type_subscribed"]},
        )
        bench.start(f"/{planted['talker']}", f"/{planted['listener']}")
        answered = bench.wait_until(_is_answered, ANSWERING[bench.pace])
        bench.stop()
        if not answered:
            return


def _is_answered(evidence: Evidence) -> bool:
    """An answer came, or the subject has ended, or a program that stays has printed all that is asked for."""
    given = answer(evidence.main)
    return evidence.main.ending is not None or (given is not None and set(KEYS) <= set(given))


def bystander(planted: Mapping[str, Any]) -> dict[str, Any]:
    """The topics of a third node by role: topics of its own, and each side's beside the node in question.

    In one participant a topic has one type, so if the two sides share the name it is on the listener's only.
    """
    published, subscribed = planted["topic_published"], planted["topic_subscribed"]
    talks = {published: planted["type_published"]} if published != subscribed else {}
    return {
        "publishes": {**planted["beside"], **talks},
        "subscribes": {**planted["beside"], subscribed: planted["type_subscribed"]},
    }


def mismatches(random: Random) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield each case with the names and types of two nodes that do not meet, and of a third that is beside the point.

    No two cases share a name or a type: an answer that is made up fits one case at most. A list of all topics with
    their types does not say which of them are whose.
    """
    (early, *others), (late, *more) = (random.sample(words, len(words)) for words in (_EARLY, _LATE))
    anywhere, *things = random.sample([*others, *more], 2 * len(CASES) + 1)
    qualities = random.sample(_QUALITIES, 2 * len(CASES))
    kinds = zip(random.sample(_TYPES, len(CASES)), random.sample(_OTHER_TYPES, len(CASES)), strict=True)
    for case, thing, types in zip(CASES, (early, late, anywhere), kinds, strict=True):
        other, its_own, quality, second = things.pop(), things.pop(), qualities.pop(), qualities.pop()
        kind, another = random.sample(types, 2)
        third = random.choice(_BYSTANDERS)
        topic = f"/{thing}/{quality}"
        # The wrong names are of the kind that happens: an ending, a namespace, another word.
        wrong = random.choice(
            (f"{topic}s", f"/{other}{topic}", f"/{thing}/{second}", f"/{quality}", f"/{thing}_{quality}")
        )
        published, subscribed = (topic, topic) if case == CASES[1] else random.sample((topic, wrong), 2)
        numbers = random.sample(range(100, 1000), 3)
        planted = {
            # The subject is told these names: no word of a topic may be among theirs.
            "talker": f"driver_{numbers[0]}",
            "listener": f"monitor_{numbers[1]}",
            "bystander": f"{third}_{numbers[2]}",
            "beside": {
                f"/{word}/{random.choice(_QUALITIES)}": random.choice(types)
                for word in (third, its_own, random.choice(_OTHERS))
            },
            "topic_published": published,
            "topic_subscribed": subscribed,
            "type_published": kind,
            "type_subscribed": kind if case == CASES[0] else another,
        }
        yield case, planted


def answer(part: Part) -> Mapping[str, Any] | None:
    """Return the last dictionary that the subject returned or printed; None if there is none."""
    said = part.said()
    text = "\n".join(said)
    # Printed by pprint or with an indent, it stands in several lines.
    candidates = (*reversed(said), text[max(0, text.rfind("{")) :])
    return next((found for line in candidates if (found := _dictionary(line)) is not None), None)


def _dictionary(text: str) -> dict[str, Any] | None:
    for begins, ends, read in _FORMS:
        start, end = text.find(begins), text.rfind(ends)
        if start < 0 or end < start:
            continue
        try:
            value = read(text[start : end + len(ends)])
            # Refuses lone surrogates and numbers of thousands of digits, which no evidence can hold.
            "".join(map(str, value.values())).encode()
        except (ValueError, SyntaxError, TypeError, AttributeError, MemoryError, RecursionError):
            continue
        return value
    return None


def _ordered(text: str) -> dict[str, Any]:
    return dict(ast.literal_eval(text.removeprefix(_ORDERED)))


_ORDERED = "OrderedDict"
_FORMS = (("{", "}", ast.literal_eval), ("{", "}", json.loads), (f"{_ORDERED}([", "])", _ordered))
"""How a dictionary is shown: its beginning, its end, what reads it. Python 3.11 shows an OrderedDict without braces."""


def _same(key: str, given: Any, truth: str) -> bool:
    """True if an answer is the truth: a topic may lack its first slash, a type its `msg`, and both may be in a list."""
    if isinstance(given, (list, tuple, set)) and len(given) == 1:
        given = next(iter(given))
    text = str(given).strip()
    if key.startswith("topic"):
        return f"/{text.lstrip('/')}" == truth
    return text.replace("/msg/", "/").replace(".msg.", "/") == truth.replace("/msg/", "/")


def _named(evidence: Evidence, case: str, keys: tuple[str, ...]) -> tuple[bool, str, str]:
    part = evidence.part(case)
    given = answer(part) or {}
    right = bool(part.inputs) and all(_same(key, given.get(key), str(part.inputs[key])) for key in keys)
    wanted = ", ".join(str(part.inputs.get(key)) for key in keys)
    seen = ", ".join(str(given.get(key, "nothing")) for key in keys)
    return right, wanted, seen


def _finds(*keys: str) -> Callable[[Evidence], Finding]:
    def judge(evidence: Evidence) -> Finding:
        results = [_named(evidence, case, keys) for case in CASES]
        _, wanted, seen = next((result for result in results if not result[0]), results[0])
        return Finding(all(result[0] for result in results), wanted, seen)

    return judge


def _wrong(evidence: Evidence) -> Iterator[tuple[Part, Mapping[str, Any] | None]]:
    """The parts that were run and not answered right, each with its answer."""
    for part in evidence:
        if part.inputs and not _named(evidence, part.name, KEYS)[0]:
            yield part, answer(part)


mismatched = Draft(
    "inspecting_topics.mismatch",
    "Inspecting topics · Why they do not meet",
    "Find out which topic and type each of two nodes uses.",
    OwnLadder(scenario, *CRASHES, *OTHER_CRASHES, OWN),
)
mismatched.asks("topic_published", 2.5, "Finds the talker's topic", _finds("topic_published"))
mismatched.asks("topic_subscribed", 2.5, "Finds the listener's topic", _finds("topic_subscribed"))
mismatched.asks("type_published", 2.5, "Finds the talker's type", _finds("type_published"))
mismatched.asks("type_subscribed", 2.5, "Finds the listener's type", _finds("type_subscribed"))


def looked_too_early(seen: Evidence, _: Evidence) -> bool:
    """A node was asked about before it was met."""
    missing = any("NodeNameNonExistentError" in part.traceback for part in seen)
    return missing or any(given is not None and not any(given.values()) for _, given in _wrong(seen))


mismatched.knows(
    "looked_too_early",
    looked_too_early,
    "Your function asked the graph before it had discovered the two nodes: a new node knows no other node yet.",
    "Wait, with a limit, until both names are in node.get_node_names_and_namespaces(); then ask what they "
    "have.",
    before="syntax_error",
)


def invented_answer(seen: Evidence, _: Evidence) -> bool:
    """The same answer whatever was planted."""
    given = [answer(seen.part(case)) for case in CASES]
    return None not in given and all(one == given[0] for one in given)


mismatched.knows(
    "invented_answer",
    invented_answer,
    "Your answer is the same each time, but each pair of nodes is another one.",
    "The names of the two nodes are the arguments of your function: look these nodes up.",
)


mismatched.knows(
    "not_written",
    lambda seen, _: seen.parts and all(part.returned == "None" and not part.said() for part in seen),
    "Your function ends and returns nothing: a step is not written yet.",
    "If you make a dictionary, write return before it. Otherwise find the TODO in your solution cell and write that "
    "step; the hints below the cell open one at a time.",
    certain=True,
)


@mismatched.mistake("gave_up")
def gave_up(seen: Evidence, _: Evidence) -> Advice | None:
    """A TimeoutError, as the waiting that the notebook hands out raises it, although both nodes were there."""
    found = [_GAVE_UP.search(part.traceback) for part, given in _wrong(seen) if given is None]
    words = [match[0] for match in found if match]
    if not words:
        return None
    return Advice(
        f"Your function gave up waiting in {len(words)} of the {len(list(seen))} runs, although both nodes were "
        f"there: {words[0]}",
        "Look at what you leave out: of a node's topics only /rosout and /parameter_events are to be passed over. And "
        "do you ask for the publishers of the talker, and for the subscriptions of the listener?",
    )


@mismatched.mistake("no_answer")
def no_answer(seen: Evidence, _: Evidence) -> Advice | None:
    """The subject returned something that is not a dictionary with the four keys."""
    for part, given in _wrong(seen):
        if part.ending is not None and (given is None or not set(KEYS) <= set(given)):
            asked = f"Return a dictionary with the keys {', '.join(KEYS)} (a program prints it)."
            if given:
                missing = ", ".join(key for key in KEYS if key not in given)
                return Advice(
                    f"Your answer lacks {missing}.",
                    f"{asked} If yours has them, it did not find that side: go through all ends of each topic, not "
                    "only the first.",
                )
            said = [line for line in part.said() if line != "None" and len(line) <= MAX_QUOTED]
            last = f": the last that it said is “{said[-1]}”" if said else ""
            return Advice(f"Your function ended without an answer{last}.", asked)
    return None


@mismatched.mistake("wrong_node")
def wrong_node(seen: Evidence, _: Evidence) -> Advice | None:
    """A topic that every node has, or that another node has, is given as the answer."""
    for part, answered in _wrong(seen):
        given = {str(value) for value in (answered or {}).values()}
        if named := sorted(given & {*_EVERYWHERE, *part.inputs.get("beside", ())}):
            return Advice(
                f"Your answer names {' and '.join(named)}: every node has /rosout and /parameter_events, and a third "
                "node that has nothing to do with it has others.",
                "Ask for the topics of the two nodes you were given, and leave out those two.",
            )
    return None


mismatched.knows(
    "never_ended",
    lambda seen, _: not all(_is_answered(Evidence([part], seen.reference)) for part in seen),
    "Your function was still busy when the time was over.",
    "Looking at the graph needs no spin. Wait for the two nodes with a limit, and return.",
)


EXERCISE = mismatched.exercise(
    limit=120.0,
    arguments="the full names of the talker and of the listener",
    sample_arguments=("/nobody", "/nobody_else"),
    text={
        "where the talker *publishes*": "topic_published type_published",
        "where the listener *subscribes*": "topic_subscribed type_subscribed",
        "A dictionary that is printed instead of returned is accepted as well.": "topic_published",
        "Ask about each node separately, because topic and type can both be wrong.": (
            "topic_published type_published topic_subscribed type_subscribed"
        ),
    },
)
