"""Exercise 1.1, remapping: a launch file that moves a topic of two programs, which stay as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit import common_mistakes as common
from autograder.kit import workspace_mistakes as workspace
from autograder.kit.launch_report import Process, processes, remappings
from autograder.kit.model import Advice, Bench, Criterion, Exercise, Finding, Look, Mistake
from autograder.kit.runners import Launches

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part

OLD_NAME = "chatter"
"""The topic's name in the code of the programs."""
NODES = 2
"""Programs that are to be started, each with a rule."""
MESSAGES = 2
"""Messages of the talker's that are waited for."""
SAYING = {Look.FAST: 2.0, Look.REAL_TIME: 5.0}
"""Seconds of wall time in which the listener must have said the judge's text."""
BEGINNING = {Look.FAST: 20.0, Look.REAL_TIME: 40.0}
"""Seconds of wall time in which a launch must have started its first process, or ended."""
BUILDING = 180.0
"""Seconds of wall time that building the student's workspace may take."""
PAUSE = {Look.FAST: 3.0, Look.REAL_TIME: 10.0}
"""Seconds of wall time that a launch may let pass between its first process and its second."""
LATE = 3.0
"""Seconds of wall time, of six periods, in which the talker must have spoken."""
PART = "launching"


def scenario(bench: Bench) -> None:
    """Launch it; hear the talker and talk to the listener under the new name."""
    topic, type_name = bench.reference.only("publisher")
    text = f"status {bench.random.randrange(10_000, 100_000)} from the judge"
    bench.part(PART, text=text)
    bench.listen(topic, type_name)
    speaker = bench.speak(topic, type_name)
    bench.start()
    bench.wait_until(_has_begun, BUILDING + BEGINNING[bench.look], quiet=BUILDING)
    bench.wait_until(lambda evidence: len(_of_nodes(evidence.main)) >= NODES, PAUSE[bench.look])
    talks = bench.await_endpoint("publisher", topic)
    listens = bench.await_endpoint("subscription", topic)
    if listens:
        speaker.send(data=text)
        bench.wait_until(lambda evidence: text in _all_words(evidence.main), SAYING[bench.look])
    if talks:
        bench.wait_until(lambda evidence: len(_from_subject(evidence.main, topic)) >= MESSAGES, LATE)
    if talks and listens:
        # The launch's processes are reported beside the wire, and a third one may still be on its way to the graph.
        bench.watch_graph(_is_settled, PAUSE[bench.look])
    bench.stop()


def _has_begun(evidence: Evidence) -> bool:
    return bool(processes(evidence.main) or evidence.main.of("log"))


def _all_words(part: Part) -> str:
    return "\n".join(part.said())


def _from_subject(part: Part, topic: str) -> list[str]:
    own = str(part.inputs.get("text"))
    texts = [str(event.data["fields"].get("data")) for event in part.of("message", topic)]
    return [text for text in texts if text != own]


def _roles(evidence: Evidence) -> tuple[dict[str, str], dict[str, str], str, str]:
    """The subject's publishers and subscriptions of the reference's type; the topic's name; the type."""
    topic, type_name = evidence.reference.only("publisher")
    sides = [
        {name: kind for name, kind in evidence.main.endpoints(role).items() if kind == type_name}
        for role in ("publisher", "subscription")
    ]
    return sides[0], sides[1], topic, type_name


def _names(endpoints: dict[str, str]) -> str:
    return ", ".join(sorted(endpoints))


def talker_moved(evidence: Evidence) -> Finding:
    """The talker's messages come under the new name."""
    publishers, _, topic, _ = _roles(evidence)
    heard = _from_subject(evidence.main, topic)
    seen = (
        f"“{heard[0]}”" if heard else f"a publisher on {_names(publishers)}" if publishers else "no publisher"
    )
    return Finding(bool(heard), f"the talker's messages on {topic}", seen)


def listener_moved(evidence: Evidence) -> Finding:
    """A text that is sent under the new name is said by the listener."""
    _, subscriptions, topic, _ = _roles(evidence)
    said = topic in subscriptions and str(evidence.main.inputs.get("text")) in _all_words(evidence.main)
    seen = f"it listens on {_names(subscriptions)}" if subscriptions else "no subscription"
    if topic in subscriptions and not said:
        seen = f"it listens on {topic}, but does not say what it hears"
    return Finding(said, f"the listener says what is sent on {topic}", "it says it" if said else seen)


def nothing_stayed(evidence: Evidence) -> Finding:
    """Nobody is left under the old name."""
    publishers, subscriptions, topic, _ = _roles(evidence)
    left = sorted({*publishers, *subscriptions} - {topic})
    seen = (
        f"{', '.join(left)} as well"
        if left
        else f"only {topic}"
        if publishers or subscriptions
        else "nothing"
    )
    return Finding(
        not left and bool(publishers) and bool(subscriptions), f"both nodes, on {topic} only", seen
    )


def by_the_launch(evidence: Evidence) -> Finding:
    """Both programs were given a rule for the name, and there is one talker; their code was left as it is."""
    topic, _ = evidence.reference.only("publisher")
    sides = _programs(evidence.main, topic)
    given = {_lower(process.pid) for process in processes(evidence.main) if _is_given_a_rule(process, topic)}
    # Where an endpoint does not tell whose it is, any process that was given a rule may have it.
    told = all(side and (side <= given or (0 in side and given)) for side in sides)
    if told and _talkers(evidence) > 1:
        return Finding(False, "one talker", f"{_talkers(evidence)} talkers on {topic}")
    count = len(given & (sides[0] | sides[1]))
    seen = (
        f"{count} of the programs on {topic} were given a rule"
        if count
        else "no program on it was given a rule"
    )
    return Finding(told, f"each program is given a remapping of {OLD_NAME} by the launch file", seen)


_SIDES = ("publisher", "subscription")


def _ends(part: Part) -> set[tuple[str, str, int]]:
    """The ends of topics that were ever seen: role, topic, process."""
    return {
        (role, name, process)
        for survey in part.of("interface")
        for role, name, process in survey.data.get("ends", ())
    }


def _programs(part: Part, topic: str) -> list[set[int]]:
    """The processes that publish on a topic, and those that subscribe; 0 for one that is not known."""
    return [
        {process for role, name, process in _ends(part) if (role, name) == (side, topic)} for side in _SIDES
    ]


def _talkers(evidence: Evidence) -> int:
    """How many programs publish under the new name. One more listener, under a name of its own, is nobody's harm."""
    topic, _ = evidence.reference.only("publisher")
    return len(_programs(evidence.main, topic)[0])


def _lower(pid: int) -> int:
    """The part of a process's id that its endpoints tell."""
    return pid & 0xFFFF


def _is_given_a_rule(process: Process, topic: str) -> bool:
    return any(_begins_at(old) and _leads_to(topic, new) for old, new in remappings(process.argv))


def _begins_at(name: str) -> bool:
    """Whether a rule is one for the name in the code; a node's name may stand before it, and a namespace."""
    return name.rpartition(":")[2].rpartition("/")[2] == OLD_NAME


def _is_settled(evidence: Evidence) -> bool:
    """Whether all is known of a launch: each program's ends are on the graph, or one too many is."""
    if not nothing_stayed(evidence).passed:
        return True
    known = {process for _, _, process in _ends(evidence.main)}
    started = processes(evidence.main)
    parents = {process.parent for process in started}
    programs = {_lower(process.pid) for process in started if process.pid not in parents}
    return by_the_launch(evidence).passed and (programs <= known or 0 in known)


def _leads_to(topic: str, target: str) -> bool:
    """Whether a rule's target is the topic; a relative one has the node's namespace in front."""
    return topic == target or topic.endswith(f"/{target.removeprefix('~').lstrip('/')}")


def only_one_remapped(evidence: Evidence) -> Advice | None:
    """One end was moved, the other stayed behind."""
    publishers, subscriptions, topic, _ = _roles(evidence)
    if not (publishers and subscriptions) or (topic in publishers) == (topic in subscriptions):
        return None
    moved, left = ("talker", "listener") if topic in publishers else ("listener", "talker")
    there = _names(subscriptions if left == "listener" else publishers)
    return Advice(
        f"The {moved} is on {topic}, but the {left} is still on {there}: the two do not meet.",
        f"Give the {left}'s node in the launch file the same remapping. A rule holds for the one node that it is given "
        "to; nobody follows by itself.",
    )


def not_remapped(evidence: Evidence) -> Advice | None:
    """Both run, both under another name than asked for."""
    publishers, subscriptions, topic, _ = _roles(evidence)
    if not (publishers and subscriptions) or topic in publishers or topic in subscriptions:
        return None
    names = sorted({*publishers, *subscriptions})
    near = next((name for name in names if name.endswith(topic)), "")
    if near:
        return Advice(
            f"Your nodes are on {near}: the target of your rule is relative, so the namespace came in front of it.",
            f"Write the target with a slash at its front: {topic}.",
        )
    return Advice(
        f"Your nodes use {', '.join(names)}; the task asks for {topic}.",
        f"In Python: remappings=[('chatter', '{topic}')]. In XML, inside <node>: <remap from=\"chatter\" "
        f'to="{topic}"/>. The name as it stands in the code comes first.',
    )


def renamed_in_code(evidence: Evidence) -> Advice | None:
    """Everything is on the topic, and no rule brought it there."""
    if by_the_launch(evidence).passed or not (
        talker_moved(evidence).passed and listener_moved(evidence).passed
    ):
        return None
    _, _, topic, _ = _roles(evidence)
    return Advice(
        f"Both nodes are on {topic}, but not by the launch file: the name was changed in the code of a program.",
        "Leave the programs as they are, with chatter in them, and remap the topic for each node in the launch file.",
    )


def someone_stayed(evidence: Evidence) -> Advice | None:
    """Besides the two there is one more under another name."""
    publishers, subscriptions, topic, _ = _roles(evidence)
    left = sorted({*publishers, *subscriptions} - {topic})
    if not left or topic not in publishers or topic not in subscriptions:
        return None
    return Advice(
        f"Both ends are on {topic}, but something is still on {', '.join(left)}.",
        "Start each of the two programs once, each with its remapping.",
    )


def started_twice(evidence: Evidence) -> Advice | None:
    """More than one talker speaks under the new name."""
    if _talkers(evidence) < 2:
        return None
    topic, _ = evidence.reference.only("publisher")
    return Advice(
        f"There are {_talkers(evidence)} talkers on {topic}: the launch file starts that program more than once.",
        "Start the talker once. A listener hears every talker of its topic, and cannot tell them apart.",
    )


def one_node_only(evidence: Evidence) -> Advice | None:
    """Only one of the two programs runs."""
    publishers, subscriptions, _, _ = _roles(evidence)
    if bool(publishers) == bool(subscriptions):
        return None
    there, missing = ("talker", "listener") if publishers else ("listener", "talker")
    return Advice(
        f"Only the {there} is there; no {missing} was started, or it did not stay.",
        f"The launch file must start both programs. Is the {missing} in the list that it returns?",
    )


def nothing_launched(evidence: Evidence) -> Advice | None:
    """The launch went well and started nothing."""
    if _of_nodes(evidence.main) or evidence.main.of("log") or evidence.main.traceback:
        return None
    return Advice(
        "The launch file started no node.",
        "generate_launch_description() must return LaunchDescription([...]) with a Node for each of the two programs.",
    )


def _of_nodes(part: Part) -> list[Process]:
    """The processes that a launch started with arguments for ROS."""
    return [process for process in processes(part) if "--ros-args" in process.argv]


def _complaint(part: Part) -> str:
    """What the launch itself says of the file, without the words around it."""
    lines = [str(event.data["text"]) for event in part.of("output")]
    for number, line in enumerate(lines):
        if "[ERROR] [launch]:" not in line and not line.startswith("ros2: "):
            continue
        causes = [later.removeprefix(" - ") for later in lines[number + 1 :] if later.startswith(" - ")]
        what = (causes or [line.partition("[launch]:")[2].strip() or line])[-1]
        what = what.removeprefix("Caught exception in launch (see debug for traceback):").strip()
        return re2.sub(r" on the libexec directory '[^']*'|, searching: \[.*| in '/[^']*'", "", what)
    return ""


def syntax_error(evidence: Evidence) -> Advice | None:
    """Python cannot read the launch file."""
    what = _complaint(evidence.main)
    if not re2.match(r"(?:Syntax|Indentation|Tab)Error", what):
        return None
    return Advice(
        f"Python could not read the launch file: {what}.",
        "A bracket, a quote, a comma or the indentation is off there or just before it.",
    )


def launch_error(evidence: Evidence) -> Advice | None:
    """The launch failed and says why."""
    what = _complaint(evidence.main)
    if not what:
        return None
    return Advice(
        f"The launch failed: {what}",
        "Compare the names of the package and of the programs with `ros2 pkg executables my_robot_pkg`, and the file "
        "with the example.",
    )


EXERCISE = Exercise(
    id="exercise_1_1.remap",
    title="Exercise 1.1 · Topic remapping",
    task="A launch file that starts talker and listener under another topic's name.",
    scenario=scenario,
    criteria=(
        Criterion("talker", "The talker speaks under the new name", 3, talker_moved),
        Criterion("listener", "The listener hears under the new name", 4, listener_moved),
        Criterion("nothing_left", "Nobody is under the old name", 1, nothing_stayed),
        Criterion("launch", "The launch file does it", 2, by_the_launch),
    ),
    mistakes=(
        *workspace.BUILD,
        Mistake("only_one_remapped", only_one_remapped, certain=True),
        Mistake("not_remapped", not_remapped, certain=True),
        Mistake("started_twice", started_twice, certain=True),
        Mistake("renamed_in_code", renamed_in_code),
        Mistake("someone_stayed", someone_stayed, certain=True),
        *common.CRASHES,
        Mistake("syntax_error", syntax_error, certain=True),
        Mistake("launch_error", launch_error, certain=True),
        *common.OTHER_CRASHES,
        Mistake("one_node_only", one_node_only),
        Mistake("nothing_launched", nothing_launched),
    ),
    roles=("publisher",),
    limit=400.0,
    runner=Launches(),
    wraps_commands=True,
    recorded=(),  # how many messages come before the listener is there is up to the machine
)
