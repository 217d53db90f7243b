"""Inspecting topics: find out on the graph why two nodes do not hear each other.

The judge plants a talker and a listener that do not meet, under random names, and asks for the name and the type that
each of them uses. No code that the student can read contains them: they must be looked up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit import Quest, Robot

if TYPE_CHECKING:
    from random import Random

KEYS = ("topic_published", "topic_subscribed", "type_published", "type_subscribed")
"""The keys of the dictionary that is asked for."""
CASES = ("the name differs", "the type differs", "both differ")
EARLY = ("battery", "beacon", "camera", "compass", "gripper", "lamp", "lidar")
LATE = ("servo", "sonar", "tracker", "valve", "wheel")
"""In the sorted list of a node's topics, the former come before /parameter_events and /rosout, and the latter after
them. One case has a topic of the former kind and one has topics of the latter, so a subject that looks only at the
first topic of a node, or only at the last, is wrong in each run.
"""
BYSTANDERS = ("actuator", "adapter", "aerial", "airbag")
OTHERS = ("zapper", "zester", "zipper", "zither")
"""The former come first in every list of names and the latter last, so that who takes the first one that there is, or
the last, takes the same in each run."""
QUALITIES = ("state", "status", "level", "position", "speed", "report", "alarm", "mode")
SLIPS = ("/{0}/{1}s", "/{2}/{0}/{1}", "/{0}/{3}", "/{1}", "/{0}_{1}")
"""The wrong names of a topic /{0}/{1} are of the kind that happens: an ending, a namespace, another word."""
TYPES = (
    "String", "Bool", "Char", "Int8", "Int16", "Int32", "Int64", "UInt8", "UInt16", "UInt32", "Float32", "Float64",
)  # fmt: skip
"""Types of std_msgs. Three of twelve in the right order: one guess in 1,320 is right."""
OTHER_TYPES = ("Accel", "Point", "Pose", "Pose2D", "Quaternion", "Transform", "Twist", "Vector3", "Wrench")
"""Types of geometry_msgs. If the two sides differ, one of them has one of these."""


def robots(random: Random) -> dict[str, Robot]:
    """Draw for each case two nodes that do not meet, and a third that is beside the point.

    No two cases share a name or a type: an answer that is made up fits one case at most. A list of all topics with
    their types does not say which of them are whose.
    """
    (early, *others), (late, *more) = (random.sample(words, len(words)) for words in (EARLY, LATE))
    anywhere, *things = random.sample([*others, *more], 2 * len(CASES) + 1)
    qualities = random.sample(QUALITIES, 2 * len(CASES))
    kinds = zip(random.sample(TYPES, len(CASES)), random.sample(OTHER_TYPES, len(CASES)), strict=True)
    drawn = {}
    for case, thing, (plain, geometric) in zip(CASES, (early, late, anywhere), kinds, strict=True):
        types = random.sample((f"std_msgs/msg/{plain}", f"geometry_msgs/msg/{geometric}"), 2)
        other, its_own, quality, second = things.pop(), things.pop(), qualities.pop(), qualities.pop()
        topic, third = f"/{thing}/{quality}", random.choice(BYSTANDERS)
        wrong = random.choice(SLIPS).format(thing, quality, other, second)
        names = (topic, topic) if case == CASES[1] else random.sample((topic, wrong), 2)
        kind = types[0], types[case != CASES[0]]
        talks, hears = ({name: one} for name, one in zip(names, kind, strict=True))
        # Where both sides have one type, these have the other, so that no type of theirs is right in each run.
        their_types = types[1:] if case == CASES[0] else types
        beside = {
            f"/{word}/{random.choice(QUALITIES)}": random.choice(their_types)
            for word in (third, its_own, random.choice(OTHERS))
        }
        # In one participant a topic has one type, so if the two sides share the name, the third node only listens.
        its_topics = {**beside, **talks} if names[0] != names[1] else beside
        # The subject is told the names of two nodes: no word of a topic may be among theirs.
        bystander, talker, listener = (
            f"/{word}_{number}"
            for word, number in zip(
                (third, "driver", "monitor"), random.sample(range(100, 1000), 3), strict=True
            )
        )
        drawn[case] = Robot(
            asked=(talker, listener),
            answer=dict(zip(KEYS, (*names, *kind), strict=True)),
            # Made first, it comes first among the ends of a topic: a subject that checks one only is wrong.
            nodes={
                bystander: {"publishes": its_topics, "subscribes": {**beside, **hears}},
                talker: {"publishes": talks},
                listener: {"subscribes": hears},
            },
        )
    return drawn


NEXT_STEPS = {
    "gave_up": (
        "Look at what you leave out: of a node's topics only /rosout and /parameter_events are to be "
        "passed over. And do you ask for the publishers of a node that publishes, and for the "
        "subscriptions of one that subscribes?"
    ),
    "wrong_node": (
        "Ask each node for what it publishes or what it subscribes to, as the task needs it, and compare "
        "the whole type. Leave out /rosout and /parameter_events: every node has these two."
    ),
}
"""What the student should do now, by the key of the mistake."""

EXERCISE = Quest(robots, next_steps=NEXT_STEPS).exercise(
    "inspecting_topics.mismatch",
    "Inspecting topics · Why they do not meet",
    "Find out which topic and type each of two nodes uses.",
    finds={
        "topic_published": "Finds the talker's topic",
        "topic_subscribed": "Finds the listener's topic",
        "type_published": "Finds the talker's type",
        "type_subscribed": "Finds the listener's type",
    },
    limit=120.0,
    arguments="the full names of the talker and of the listener",
    sample_arguments=("/nobody", "/nobody_else"),
    text={
        "where the talker *publishes*": "topic_published type_published",
        "where the listener *subscribes*": "topic_subscribed type_subscribed",
        "Ask about each node separately, because topic and type can both be wrong.": (
            "topic_published type_published topic_subscribed type_subscribed"
        ),
    },
)
