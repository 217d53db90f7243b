"""A recipe for a program of a package, which the judge builds and runs. It must have a node and log a line."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

import re2

from autograder.kit.bench import Bench, Pace
from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.in_words import first_difference
from autograder.kit.mistakes import package_mistakes, unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES
from autograder.kit.model import Finding, Mistake
from autograder.kit.runners import RunsProgram

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part

SAYING = {Pace.FAST: 2.0, Pace.REAL_TIME: 5.0}
"""Time limit in seconds of wall time from the appearance of the program's node until the program logs its line."""
LATE = 0.3
"""At the end, the judge waits for more lines until no event has come for this many seconds."""
COMPARED, LONG = 200, 400
"""The maximum number of lines to compare, and of characters in each, because comparing more could take minutes."""


class _Ran:
    """A program as the judge saw it: its nodes and its lines."""

    def __init__(self, evidence: Evidence) -> None:
        self._evidence = evidence

    @property
    def line(self) -> str:
        """The line that the reference solution logs; empty while the reference is being recorded."""
        recorded = self._evidence.reference.parts
        said = recorded[0].first("said") if recorded else None
        return str(said.data["text"]) if said is not None else ""

    @property
    def nodes(self) -> list[str]:
        """The names of the program's nodes."""
        return sorted({node for part in self._evidence for node in _nodes(part)})

    @property
    def has_node(self) -> bool:
        """True if the program made a node, even if that node existed so briefly that its name is unknown."""
        return any(part.had_node for part in self._evidence)

    @property
    def words(self) -> list[str]:
        """The lines that the program logged and printed, without messages of ``ros2`` about a missing program."""
        return [word for part in self._evidence for word in _words(part)]

    @property
    def says_it(self) -> bool:
        """True if the program logged or printed the expected line."""
        line = self.line
        return bool(line) and any(_says(said, line) for part in self._evidence for said in part.said())

    @property
    def nearest(self) -> str:
        """The program's line that is most similar to the expected one; empty if the program printed nothing."""
        if self.says_it:
            return self.line
        words = self.words
        alike = [word for word in words[:COMPARED] if len(word) < LONG]
        near = difflib.get_close_matches(self.line, alike, n=1, cutoff=0.0) or words[:1]
        return near[0] if near else ""

    @property
    def first_difference(self) -> str:
        """A sentence that shows the first difference of the most similar line from the expected one."""
        return first_difference(self.nearest, self.line)


_COLOUR = re2.compile(r"\x1b\[[\d;]*m")
_LETTER = re2.compile(r"[A-Za-z0-9]")


def _says(said: str, line: str) -> bool:
    """Return True if a text contains a line, without a letter or digit directly before or after it."""
    before, found, after = _COLOUR.sub(" ", said).partition(line)
    return bool(found) and not _LETTER.match(before[-1:]) and not _LETTER.match(after)


def _nodes(part: Part) -> list[str]:
    return [node for survey in part.of("interface") for node in survey.data.get("nodes", ())]


def _words(part: Part) -> list[str]:
    return [line for line in part.said() if not re2.match(r"Package '|No executable found|\[ros2run\]", line)]


class Program:
    """The recipe for a program of a package.

    The recipe recognizes the mistakes ``no_workspace``, ``bad_package``, ``build_failed``, ``package_name``,
    ``entry_point``, ``main_guard``, ``nothing_on_the_graph``.

    Args:
        package: The name of the package in the task.
        program: The name of the program in the task, as in ``ros2 run PACKAGE PROGRAM``.
        part: The name of the program's run in the reference output.

    Example::

        recipe = Program("my_robot_pkg", "simple_node", "saying hello")
        hello = Draft("lab_8_1.hello", "Lab 8.1 · The first node", "A package with a node that says hello.", recipe)
        hello.asks("starts", "Builds, and ros2 run starts it", recipe.starts, points=3)
        hello.asks("node", "Is a node on the graph", recipe.is_a_node, points=3)
        hello.asks("line", "Says the line", recipe.says_the_line, points=4)
        EXERCISE = hello.exercise(limit=400.0, runner=recipe.runner)
    """

    roles = ()

    def __init__(self, package: str, program: str, part: str) -> None:
        self._entry, self._part = package_mistakes.EntryPoint(package, program), part
        self.runner = RunsProgram(package, program)

    def seen(self, evidence: Evidence) -> _Ran:
        """Return what the judge saw of the student's program."""
        return _Ran(evidence)

    def expected(self, evidence: Evidence) -> _Ran:
        """Return the same as :meth:`seen`, because a :class:`_Ran` also contains the line of the reference output."""
        return _Ran(evidence)

    def scenario(self, bench: Bench) -> None:
        """Build and run the program. Wait until its node is on the graph and it has printed its line."""
        bench.part(self._part)
        bench.start()
        package_mistakes.await_build(bench)
        there = bench.await_node()
        bench.wait_until(lambda evidence: _Ran(evidence).says_it, SAYING[bench.pace])
        if there:
            bench.run_time(SAYING[bench.pace], quiet=LATE)
        bench.note_its_log()
        bench.stop()

    def starts(self, evidence: Evidence) -> Finding:
        """Decide whether the package builds and ``ros2 run`` starts its program."""
        expected = f"colcon builds {self._entry.package}, and ros2 run starts {self._entry.program}"
        report = package_mistakes.build_report(evidence.main)
        ends = ("constructed", "returned", "raised")
        if any(part.of("subject", name) for part in evidence for name in ends):
            return Finding(False, expected, "a class or function from a notebook, which is not a package")
        if report is not None and not report.built:
            return Finding(False, expected, package_mistakes.seen_of_build(report))
        if report is not None and report.missing:
            return Finding(False, expected, f"built, but ros2 run does not find {report.missing}")
        if package_mistakes.entry_point(evidence, self._entry):
            return Finding(False, expected, "built, but its entry point points to nothing")
        seen = _Ran(evidence)
        # A program that raised an exception did start, so this criterion holds. Other criteria judge the exception's
        # effects.
        ran = seen.has_node or bool(seen.words) or any(part.traceback for part in evidence)
        return Finding(ran, expected, "built and started" if ran else "the program did nothing")

    def is_a_node(self, evidence: Evidence) -> Finding:
        """Decide whether a node of the program is on the graph."""
        ran = _Ran(evidence)
        unnamed = "a node, for a moment" if ran.has_node else "no node"
        return Finding(ran.has_node, "a node on the graph", ", ".join(ran.nodes) or unnamed)

    def says_the_line(self, evidence: Evidence) -> Finding:
        """Decide whether the program logged or printed the reference's line."""
        seen = _Ran(evidence)
        near, recording = seen.nearest, not evidence.reference.parts
        return Finding(seen.says_it or recording, f"“{seen.line}”", f"“{near}”" if near else "nothing")

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The mistakes of the program, most specific first. Those of its package come with the runner."""
        return (
            OWN,
            *CRASHES,
            *OTHER_CRASHES,
            OWN_LATE,
            *unfinished.NOTHING_THERE[:3],
        )
