"""Exercise 1.1, remapping: a launch file that moves a topic of two programs, which stay as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit import Draft, Finding, LaunchFile
from autograder.kit.in_words import counted
from autograder.kit.runners import Launches

if TYPE_CHECKING:
    from autograder.kit import Evidence
    from autograder.kit.recipes.launch_file import Launched

OLD_NAME = "chatter"
"""The topic's name in the code of the programs."""

remap = Draft(
    "exercise_1_1.remap",
    "Exercise 1.1 · Topic remapping",
    "A launch file that starts talker and listener under another topic's name.",
    LaunchFile("my_robot_pkg", OLD_NAME),
)


def names(endpoints: set[str]) -> str:
    """The names for a card."""
    return ", ".join(sorted(endpoints))


@remap.criterion("talker", "The talker speaks under the new name", points=3)
def talker(seen: Launched, _: Launched) -> Finding:
    """The talker's messages come under the new name."""
    found = f"“{seen.heard[0]}”" if seen.heard else f"publishers: {names(seen.publishers) or 'none'}"
    stranger = " from something else" if seen.heard and not seen.has_a_talker else ""
    right = bool(seen.heard) and not stranger
    return Finding(right, f"the talker's messages on {seen.topic}", f"{found}{stranger}")


@remap.criterion("listener", "The listener hears under the new name", points=4)
def listener(seen: Launched, _: Launched) -> Finding:
    """A text that is sent under the new name is said by the listener."""
    says, is_ours = seen.says_what_it_hears, seen.has_a_listener
    found = f"; subscriptions: {names(seen.subscriptions)}" if seen.subscriptions else ""
    words = ("it says it" if is_ours else "something else says it") if says else f"nothing says it{found}"
    return Finding(says and is_ours, f"the listener says what is sent on {seen.topic}", words)


@remap.criterion("nothing_left", "No node uses the old name", points=1)
def nothing_left(seen: Launched, _: Launched) -> Finding:
    """No node of the subject's uses the old name, in whatever namespace; other topics are free."""
    found = (
        f"{', '.join(seen.old_names)} as well"
        if seen.old_names
        else names(seen.publishers | seen.subscriptions)
    )
    right = not seen.old_names and bool(seen.publishers and seen.subscriptions)
    return Finding(right, f"both nodes, and none on {OLD_NAME}", found or "nothing")


@remap.criterion("launch", "The launch file does it", points=2)
def by_the_launch(seen: Launched, _: Launched) -> Finding:
    """Both programs were given a rule for the name that moves them, and there is one talker."""
    expected = f"each program is given a remapping of {OLD_NAME} by the launch file"
    if seen.moved_by_rules and seen.talkers > 1:
        return Finding(False, "one talker", f"{seen.talkers} talkers on {seen.topic}")
    if seen.not_moved:
        return Finding(False, expected, f"on {seen.topic} without a rule, too: {', '.join(seen.not_moved)}")
    found = f"{counted(seen.given_a_rule, 'program')} on {seen.topic} with a remapping rule"
    return Finding(seen.moved_by_rules, expected, found)


def left_behind(seen: Launched, _: Launched) -> tuple[str, str] | None:
    """Return the only program that was not moved, and the names that it uses."""
    ends = {"talker": seen.publishers, "listener": seen.subscriptions}
    stayed = [(end, names(used)) for end, used in ends.items() if seen.topic not in used]
    return stayed[0] if len(stayed) == 1 and all(ends.values()) else None


def unmoved(seen: Launched, _: Launched) -> str:
    """Return the wrong names under which both programs run, with what may be missing."""
    used = seen.publishers | seen.subscriptions
    no_rule = "" if seen.rules else ". The launch file gives your programs no remapping rule"
    both = seen.publishers and seen.subscriptions and seen.topic not in used
    return f"Your nodes use {names(used)}; the task asks for {seen.topic}{no_rule}" if both else ""


remap.knows(
    "only_one_remapped",
    left_behind,
    "One program is on {seen.topic}, but the {0[0]} is still on {0[1]}: the two do not meet.",
    "Give the {0[0]}'s node in the launch file the same remapping. A rule holds only for the node that it is given to.",
    certain=lambda seen: seen.all_are_there,
)
remap.knows(
    "not_remapped",
    unmoved,
    "{}.",
    "In Python: remappings=[('chatter', '{seen.topic}')]. In XML, inside <node>: <remap from=\"chatter\" "
    'to="{seen.topic}"/>. The name in the code comes first. A SetRemap holds only for the nodes below it in its group.',
    certain=lambda seen: seen.all_are_there,
)
remap.knows(
    "renamed_in_code",
    lambda seen, _: (seen.moved_by_rules or seen.says_what_it_hears) and " and ".join(seen.not_moved),
    "Started without the launch file, your {} is on {seen.topic}, too: the new name is in the code.",
    f"Put the old name, {OLD_NAME}, back into the code of your {{}}, and build. Then let the launch file remap the "
    "topic of each node.",
    certain=True,
)


def missing(seen: Launched, _: Launched) -> tuple[str, str] | None:
    """Return the package's program that does not run, and what the judge saw instead."""
    if seen.heard and not seen.has_a_talker:
        return "talker", f"something else speaks on {seen.topic}"
    if seen.says_what_it_hears and not seen.has_a_listener:
        return "listener", f"something else listens on {seen.topic}"
    if bool(seen.publishers) == bool(seen.subscriptions):
        return None
    return (
        ("listener", "only the talker is there")
        if seen.publishers
        else ("talker", "only the listener is there")
    )


remap.knows(
    "one_node_only",
    missing,
    "The {0[0]} of your package was not started, or it ended: {0[1]}.",
    "The launch file must start both programs of my_robot_pkg. Is there a node for the {0[0]} in it?",
    late=True,
)


def nodes_of_one_name(evidence: Evidence) -> str:
    """Return a remark if two nodes have the same name."""
    surveys = [event.data.get("nodes", []) for event in evidence.main.of("interface")]
    twin = next((name for names in surveys for name in names if names.count(name) > 1), "")
    words = (
        f"Two of your nodes are called {twin}: name=... in a launch file renames every node of the process."
    )
    return words if twin else ""


EXERCISE = remap.exercise(
    limit=400.0,
    remarks=(nodes_of_one_name,),
    runner=Launches(),
    wraps_commands=True,
    recorded=(),  # how many messages come before the listener is there is up to the machine
    text={
        "Write a launch file that starts both programs": "talker listener",
        "let both use `/robot/status_updates` instead of `chatter`": "talker listener nothing_left",
        "Leave the programs as they are, with `chatter` in their code.": "launch",
        "It also checks that the launch file starts one talker, and gives both programs the rule.": "launch",
        "Show the output of both on the screen": "",
    },
    counts={
        "launch": "In a terminal, a file in XML or YAML counts as well.",
        "": "The names of the nodes are free.",
    },
)
