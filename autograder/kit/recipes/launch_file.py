"""A recipe for a launch file that starts a publisher and a listener, and remaps their topic to a new name.

The judge listens to the publisher and publishes to the listener, both under the new name. The remapping must come from
the launch file, not from the programs' code, and the judge checks this in two ways. First, the runner of the launch
reports the command line of each process, which shows its remapping rules. Then the judge starts each program again
without its rule: if the program still uses the new name, the name is in its code.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from autograder.kit.bench import Bench, Pace
from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.evidence import Evidence
from autograder.kit.mistakes import package_mistakes, runner_mistakes
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES
from autograder.kit.output.launched_processes import Process, all_are_there, as_run, processes, remappings
from autograder.kit.output.workspace_reports import report_of
from autograder.kit.runners import ALONE, BUILDING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Part
    from autograder.kit.model import Mistake

NODES = 2
"""The number of programs that the launch file should start, each with a remapping rule."""
MESSAGES = 2
"""The number of messages for which the judge waits."""
SAYING = {Pace.FAST: 2.0, Pace.REAL_TIME: 5.0}
"""Time limit in seconds of wall time for the listener to report the judge's text."""
BEGINNING = {Pace.FAST: 20.0, Pace.REAL_TIME: 40.0}
"""Time limit in seconds of wall time for a launch to start its first process or to end."""
PAUSE = {Pace.FAST: 3.0, Pace.REAL_TIME: 10.0}
"""The maximum time between the first process of a launch and its second, in seconds of wall time."""
LATE = 4.5
"""Time limit in seconds of wall time to receive the publisher's messages. In Fast DDS, if the first message is lost,
the next ones may be delayed until the heartbeat of the publisher, 3 s later.
"""
PART = "launching"
MOST = 4
"""The maximum number of programs that the judge starts without their remapping rules, if a launch file starts many."""


class Launched:
    """The programs that a launch file started, as the judge saw them: their endpoints, processes and remapping rules.

    Args:
        package: The package of the two programs.
        old_name: The topic's name in the programs' code.

    Attributes:
        topic: The new name.
        publishers: The names on which a publisher of the topic's type was seen.
        subscriptions: The names on which a subscription to the type was seen.
    """

    def __init__(self, evidence: Evidence, package: str, old_name: str) -> None:
        self._part, self._package, self._old_name = evidence.main, package, old_name
        self._alone = [replace(evidence, parts=[part]) for part in list(evidence)[1:]]
        self.topic, kind = evidence.reference.only("publisher")
        self.publishers, self.subscriptions = (
            {name for name, type_name in self._part.endpoints(role).items() if type_name == kind}
            for role in ("publisher", "subscription")
        )
        self._processes = processes(self._part)
        surveys = self._part.of("interface")
        self._ends = {
            (role, name, process) for s in surveys for role, name, process in s.data.get("ends", ())
        }
        self._talk, self._listen = (
            {process for role, name, process in self._ends if (role, name) == (side, self.topic)}
            for side in ("publisher", "subscription")
        )
        """The ids of the processes that publish under the new name, and of those that subscribe to it. The id 0 stands
        for an unknown process.
        """
        # An endpoint does not show how it got its name; a remapping rule in its process's command line does.
        self._given = {_lower(process.pid) for process in self._processes if self._has_a_rule(process.argv)}
        self._own = {
            _lower(process.pid)
            for process in self._processes
            if any(package in word for word in process.argv) and not _is_a_tool(process.argv)
        }
        """The ids of the processes that run programs of the package. They may include a tool whose arguments contain
        the package's name.
        """

    @property
    def heard(self) -> list[str]:
        """The texts of the messages that arrived under the new name, except the judge's own."""
        own = str(self._part.inputs.get("text"))
        texts = [str(event.data["fields"].get("data")) for event in self._part.of("message", self.topic)]
        return [text for text in texts if text != own]

    @property
    def says_what_it_hears(self) -> bool:
        """True if a program reported the text that the judge sent under the new name."""
        return self.topic in self.subscriptions and _says_its_text(self._part)

    @property
    def elsewhere(self) -> list[str]:
        """The names of the endpoints that do not have the new name."""
        return sorted((self.publishers | self.subscriptions) - {self.topic})

    @property
    def old_names(self) -> list[str]:
        """The names in :attr:`elsewhere` that consist of the old name in some namespace."""
        return [name for name in self.elsewhere if name.rpartition("/")[2] == self._old_name]

    @property
    def is_there(self) -> bool:
        """True if there is an endpoint under the old or the new name."""
        return bool(self.old_names) or self.topic in self.publishers | self.subscriptions

    @property
    def not_moved(self) -> list[str]:
        """The programs that use the new name even if they are started without their remapping rules."""
        seen = [(one.main, Launched(one, self._package, self._old_name)) for one in self._alone]
        return [
            str(part.inputs["program"]) for part, it in seen if it.topic in it.publishers | it.subscriptions
        ]

    @property
    def without_rules(self) -> list[tuple[str, ...]]:
        """The programs to start again without their remapping rules, each as its package, its name and its arguments.

        Each of them used the new name. If a program's rule was not recognized, the program is started
        without arguments, because they may contain the rule in another form.
        """
        ends = self._talk | self._listen
        there = [one for one in self._processes if {0, _lower(one.pid)} & ends]
        words = [
            as_run(one.argv, self._programs, self._leads_there)[: None if self._has_a_rule(one.argv) else 2]
            for one in there
            if self._has_a_rule(one.argv) or _lower(one.pid) in self._own
        ]
        return list({one[:2]: one for one in words if one}.values())[:MOST]

    @property
    def talkers(self) -> int:
        """The number of programs that publish under the new name."""
        return len(self._talk)

    @property
    def given_a_rule(self) -> int:
        """The number of programs that use the new name and were started with a remapping rule for it."""
        return len(self._given & (self._talk | self._listen))

    @property
    def moved_by_rules(self) -> bool:
        """True if each program that uses the new name was started with a remapping rule for this name.

        An endpoint of an unknown process counts as remapped if any process has such a rule, because it may belong to
        that process. Subscribers that are not programs of the package, such as ``ros2 topic echo``, are ignored.
        """
        given, listen = self._given, self._listen
        listeners = listen & (given | self._own) or listen
        return all(side and (side <= given or (0 in side and given)) for side in (self._talk, listeners))

    @property
    def has_a_talker(self) -> bool:
        """True if a program of the package publishes under the new name, as far as the judge can tell."""
        return self._has_one_of_its_own(self._talk)

    @property
    def has_a_listener(self) -> bool:
        """True if a program of the package subscribes under the new name, as far as the judge can tell."""
        return self._has_one_of_its_own(self._listen)

    def _has_one_of_its_own(self, side: set[int]) -> bool:
        # The student's package may have a different name. Then a remapping rule shows which processes are its programs.
        # An endpoint of an unknown process (0) counts, because it may belong to any program.
        without_a_rule = (self._talk | self._listen) & self._own - self._given
        return bool(side & (self._own | self._given) or 0 in side or without_a_rule)

    @property
    def is_settled(self) -> bool:
        """True if nothing about the launch can change any more: all endpoints are on the graph, or a wrong one is."""
        if self.elsewhere or not (self.publishers and self.subscriptions):
            return True
        return self.moved_by_rules and self.talkers < NODES and self.all_are_there

    @property
    def rules(self) -> list[str]:
        """The names that the programs' remapping rules replace."""
        return [old for process in self._processes for old, _ in remappings(process.argv)]

    @property
    def all_are_there(self) -> bool:
        """True if each started program has a topic endpoint on the graph, or an endpoint's process is unknown."""
        return all_are_there(self._part)

    @cached_property
    def _programs(self) -> list[tuple[str, str]]:
        """For each program of the workspace, its module with slashes instead of dots, and the end of its path."""
        report = report_of(self._part)
        packages = report.packages if report is not None else ()
        named = [(package.name, entry.partition("=")) for package in packages for entry in package.programs]
        return [
            (target.partition(":")[0].strip().replace(".", "/"), f"/lib/{package}/{name.strip()}")
            for package, (name, _, target) in named
        ]

    def _has_a_rule(self, argv: Sequence[str]) -> bool:
        return any(self._leads_there(old, new) for old, new in remappings(argv))

    def _leads_there(self, old: str, new: str) -> bool:
        """Return True if the rule ``old:=new`` renames the topic of the program to the topic of the exercise."""
        begins = old.rpartition(":")[2].rpartition("/")[2] == self._old_name
        # If the new name is relative, it is accepted in any namespace.
        leads_to_it = self.topic == new or self.topic.endswith(f"/{new.removeprefix('~').lstrip('/')}")
        return begins and leads_to_it


class LaunchFile:
    """The recipe for a launch file that remaps a topic of two programs.

    The recipe recognizes the mistakes ``no_workspace``, ``bad_package``, ``build_failed``, ``launch_error``.

    Args:
        package: The package of the two programs.
        old_name: The topic's name in the programs' code.

    Example::

        recipe = LaunchFile("my_robot_pkg", "chatter")
        remap = Draft("lab_8_1.remap", "Lab 8.1 · Remapping", "Start both programs with another topic.", recipe)

        @remap.criterion("talker", "The talker publishes under the new name", points=10)
        def talker(seen: Launched, expected: Launched) -> Finding:
            return Finding(bool(seen.heard), f"messages on {seen.topic}", ", ".join(seen.heard) or "none")

        EXERCISE = remap.exercise(limit=400.0, runner=Launches(), wraps_commands=True)
    """

    roles = ("publisher",)

    def __init__(self, package: str, old_name: str) -> None:
        self._package, self._old_name = package, old_name

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        return (
            *package_mistakes.BUILD,
            OWN,
            *CRASHES,
            *runner_mistakes.LAUNCH,
            *OTHER_CRASHES,
            OWN_LATE,
        )

    def seen(self, evidence: Evidence) -> Launched:
        """Return what the judge saw of the student's programs."""
        return Launched(evidence, self._package, self._old_name)

    def expected(self, evidence: Evidence) -> Launched:
        """Return the same as :meth:`seen`, because criteria need only the new name from the reference solution."""
        return self.seen(evidence)

    def scenario(self, bench: Bench) -> None:
        """Launch the file, listen to the publisher, and publish to the listener, under the new name."""
        topic, type_name = bench.reference.only("publisher")
        text = f"status {bench.random.randrange(10_000, 100_000)} from the judge"
        bench.part(PART, text=text)
        bench.listen(topic, type_name)
        speaker = bench.speak(topic, type_name)
        bench.start()
        bench.wait_until(_has_begun, BUILDING + BEGINNING[bench.pace], quiet=BUILDING)
        bench.wait_until(lambda evidence: len(_of_nodes(evidence.main)) >= NODES, PAUSE[bench.pace])
        # On a busy machine, the other programs may appear on the graph seconds after the first one.
        bench.watch_graph(lambda evidence: self.seen(evidence).all_are_there, PAUSE[bench.pace])
        talks = bench.await_endpoint("publisher", topic)
        listens = bench.await_endpoint("subscription", topic)
        if listens:
            bench.await_attention()
            speaker.send(data=text)
            bench.wait_until(lambda evidence: _says_its_text(evidence.main), SAYING[bench.pace])
        if talks:
            bench.wait_until(lambda evidence: len(self.seen(evidence).heard) >= MESSAGES, LATE)
        if talks and listens:
            # Endpoints of other programs may still appear. The graph does not show the process of an endpoint, so wait
            # until no further endpoint can change the verdict.
            bench.watch_graph(lambda evidence: self.seen(evidence).is_settled, PAUSE[bench.pace])
        seen = self.seen(Evidence([bench.seen()], bench.reference))
        bench.stop()
        for words in seen.without_rules if topic in seen.publishers & seen.subscriptions else ():
            self._run_alone(bench, words)

    def _run_alone(self, bench: Bench, words: Sequence[str]) -> None:
        """Start a program without its remapping rules, and wait until it uses the old or the new name of the topic."""
        bench.part(f"{words[1]} without its rule", program=words[1])
        bench.start(ALONE, *words)
        bench.watch_graph(lambda evidence: self.seen(evidence).is_there, BEGINNING[bench.pace])
        bench.stop()


def _has_begun(evidence: Evidence) -> bool:
    return bool(processes(evidence.main) or evidence.main.of("log"))


def _says_its_text(part: Part) -> bool:
    return str(part.inputs.get("text")) in "\n".join(part.said())


def _lower(pid: int) -> int:
    """Return the lower 16 bits of a process id, because the identifiers of its endpoints contain only these."""
    return pid & 0xFFFF


def _is_a_tool(argv: tuple[str, ...]) -> bool:
    """Return True if a command line starts the command ``ros2``, with or without a Python before it."""
    return any(word.rpartition("/")[2] == "ros2" for word in argv[:2])


def _of_nodes(part: Part) -> list[Process]:
    """Return the processes that a launch started with ``--ros-args`` in their command lines."""
    return [process for process in processes(part) if "--ros-args" in process.argv]
