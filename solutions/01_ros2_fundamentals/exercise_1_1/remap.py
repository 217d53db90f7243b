"""Exercise 1.1, remapping: a launch file that moves a topic of two programs, which stay as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.in_words import counted
from autograder.kit.model import Advice, Finding
from autograder.kit.recipes.launch_file import Launched, LaunchFile
from autograder.kit.runners import Launches

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence

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


@remap.criterion("talker", 3, "The talker speaks under the new name")
def talker(seen: Launched, _: Launched) -> Finding:
    """The talker's messages come under the new name."""
    found = f"a publisher on {names(seen.publishers)}" if seen.publishers else "no publisher"
    expected, heard = f"the talker's messages on {seen.topic}", seen.heard
    if heard and not seen.has_a_talker:
        return Finding(False, expected, f"“{heard[0]}” from something else")
    return Finding(bool(heard), expected, f"“{heard[0]}”" if heard else found)


@remap.criterion("listener", 4, "The listener hears under the new name")
def listener(seen: Launched, _: Launched) -> Finding:
    """A text that is sent under the new name is said by the listener."""
    found = f"it listens on {names(seen.subscriptions)}" if seen.subscriptions else "no subscription"
    said, expected = seen.says_what_it_hears, f"the listener says what is sent on {seen.topic}"
    if said and not seen.has_a_listener:
        return Finding(False, expected, "something else says it")
    return Finding(said, expected, "it says it" if said else found)


@remap.criterion("nothing_left", 1, "No node uses the old name")
def nothing_left(seen: Launched, _: Launched) -> Finding:
    """No node of the subject's uses the old name, in whatever namespace; other topics are free."""
    there = names(seen.publishers | seen.subscriptions) or "nothing"
    old = seen.old_names
    right = not old and bool(seen.publishers) and bool(seen.subscriptions)
    return Finding(
        right, f"both nodes, and none on {OLD_NAME}", f"{', '.join(old)} as well" if old else there
    )


@remap.criterion("launch", 2, "The launch file does it")
def by_the_launch(seen: Launched, _: Launched) -> Finding:
    """Both programs were given a rule for the name that moves them, and there is one talker."""
    if seen.moved_by_rules and seen.talkers > 1:
        return Finding(False, "one talker", f"{seen.talkers} talkers on {seen.topic}")
    count = seen.given_a_rule
    some = f"{counted(count, 'program')} on {seen.topic} with a remapping rule"
    expected = f"each program is given a remapping of {OLD_NAME} by the launch file"
    if seen.not_moved:
        moved = f"each program is on {seen.topic} because of its rule"
        return Finding(False, moved, f"there without a rule, too: {', '.join(seen.not_moved)}")
    return Finding(
        seen.moved_by_rules,
        expected,
        some if count else f"no program was remapped from {OLD_NAME} to {seen.topic}",
    )


@remap.mistake("only_one_remapped", certain=lambda seen: seen.all_are_there)
def only_one_remapped(seen: Launched, _: Launched) -> Advice | None:
    """One end was moved, the other stayed behind."""
    talks, listens = seen.topic in seen.publishers, seen.topic in seen.subscriptions
    if not (seen.publishers and seen.subscriptions) or talks == listens:
        return None
    moved, left = ("talker", "listener") if talks else ("listener", "talker")
    others = seen.subscriptions if talks else seen.publishers
    return Advice(
        f"The {moved} is on {seen.topic}, but the {left} is still on {names(others)}: the two do not meet.",
        f"Give the {left}'s node in the launch file the same remapping. A rule holds only for the node that it is "
        "given to.",
    )


@remap.mistake("not_remapped", certain=lambda seen: seen.all_are_there)
def not_remapped(seen: Launched, _: Launched) -> Advice | None:
    """Both programs run, but under a wrong name."""
    there = seen.publishers | seen.subscriptions
    if not (seen.publishers and seen.subscriptions) or seen.topic in there:
        return None
    why = f"Your nodes use {names(there)}; the task asks for {seen.topic}."
    how = (
        f"In Python: remappings=[('chatter', '{seen.topic}')]. In XML, inside <node>: <remap from=\"chatter\" "
        f'to="{seen.topic}"/>. The name in the code comes first.'
    )
    if seen.rules:
        return Advice(why, how)
    return Advice(
        f"{why} The launch file gives your programs no remapping rule.",
        f"{how} A SetRemap holds only for the nodes below it in its own group.",
    )


remap.knows(
    "renamed_in_code",
    lambda seen, _: seen.moved_by_rules and " and ".join(seen.not_moved),
    "Without the rule of the launch file, {seen.topic} was still the topic of your {}: the new name is in the code, so "
    "the rule moves nothing.",
    f"Put the old name, {OLD_NAME}, back into the code of your {{}}, and build. The rule in the launch file then moves "
    "it.",
    certain=True,
)


remap.knows(
    "renamed_in_code",
    lambda seen, _: not seen.moved_by_rules and seen.says_what_it_hears and " and ".join(seen.not_moved),
    "Both nodes are on {seen.topic}, but not by the launch file: started without it, your {} is there, too. The name "
    "was changed in the code.",
    "Leave the programs as they are, with chatter in them, and remap the topic for each node in the launch file.",
    certain=True,
)


def _missing(seen: Launched) -> str:
    """Return the package's program that was replaced, for example by a command; empty if none was."""
    if seen.heard and not seen.has_a_talker:
        return "talker"
    return "listener" if seen.says_what_it_hears and not seen.has_a_listener else ""


@remap.mistake("one_node_only", late=True)
def one_node_only(seen: Launched, _: Launched) -> Advice | None:
    """Only one of the two programs runs, perhaps with something else in the place of the other."""
    if missing := _missing(seen):
        does = "speaks" if missing == "talker" else "listens"
        return Advice(
            f"The {missing} of your package was not started: something else {does} on {seen.topic}.",
            f"Start the program {missing} of my_robot_pkg in the launch file, with the remapping.",
        )
    if bool(seen.publishers) == bool(seen.subscriptions):
        return None
    there, missing = ("talker", "listener") if seen.publishers else ("listener", "talker")
    return Advice(
        f"Only the {there} is there; no {missing} was started, or it ended.",
        f"The launch file must start both programs. Is there a node for the {missing} in it?",
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
    },
)
