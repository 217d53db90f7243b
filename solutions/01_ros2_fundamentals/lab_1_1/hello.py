"""Lab 1.1, the first node: a package that builds, and a program of it that says hello."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

import re2

from autograder.kit import common_mistakes as common
from autograder.kit import package_programs as programs
from autograder.kit import workspace_mistakes as workspace
from autograder.kit.model import Advice, Bench, Criterion, Exercise, Finding, Look, Mistake
from autograder.kit.runners import RunsProgram

if TYPE_CHECKING:
    from autograder.kit.evidence import Evidence, Part

PACKAGE = "my_robot_pkg"
PROGRAM = "simple_node"
ENTRY = programs.Entry(PACKAGE, PROGRAM)
"""What the task calls them: `ros2 run my_robot_pkg simple_node`."""
SAYING = {Look.FAST: 2.0, Look.REAL_TIME: 5.0}
"""Seconds of wall time, after its node appeared, in which it must have said its line."""
LATE = 0.3
"""Seconds without any event after which the log of a program that said its line has arrived."""
TRIES = 3
"""Runs of a program that ends at once: its node may be there for less time than discovery takes."""
PART = "saying hello"


def scenario(bench: Bench) -> None:
    """Build and run it; look for its node and its line."""
    for run in range(1, TRIES + 1 if bench.look is Look.REAL_TIME else 2):
        bench.part(PART if run == 1 else f"{PART}, run {run}")
        bench.start()
        programs.await_build(bench)
        there = bench.await_node()
        bench.wait_until(_says_it, SAYING[bench.look])
        if there:
            bench.run_time(SAYING[bench.look], quiet=LATE)
        bench.note_its_log()
        bench.stop()
        if there:
            return


def _expected(evidence: Evidence) -> str:
    """The line that the reference solution logs; nothing while that is being recorded."""
    if not evidence.reference.parts:
        return ""
    line = evidence.reference.part(PART).first("said")
    return str(line.data["text"]) if line is not None else ""


def _says_it(evidence: Evidence) -> bool:
    line = _expected(evidence)
    return bool(line) and any(line in said for part in evidence for said in part.said())


def _nodes(part: Part) -> list[str]:
    return [node for survey in part.of("interface") for node in survey.data.get("nodes", ())]


def _words(part: Part) -> list[str]:
    """What the program said, without what `ros2` says of a program that it cannot run."""
    return [line for line in part.said() if not re2.match(r"Package '|No executable found|\[ros2run\]", line)]


def starts(evidence: Evidence) -> Finding:
    """The package builds, and `ros2 run` starts its program."""
    expected = f"colcon builds {PACKAGE}, and ros2 run starts {PROGRAM}"
    report = workspace.build_report(evidence.main)
    if any(part.of("subject", name) for part in evidence for name in ("constructed", "returned", "raised")):
        return Finding(False, expected, "something from a notebook, which is no package")
    if report is not None and not report.built:
        return Finding(False, expected, workspace.seen_of_build(report))
    if report is not None and report.missing:
        return Finding(False, expected, f"built; there is no {report.missing} in it")
    ran = any(_nodes(part) or _words(part) for part in evidence)
    return Finding(ran, expected, "built and started" if ran else "the program did nothing")


def is_a_node(evidence: Evidence) -> Finding:
    """A node of the program's is on the graph."""
    nodes = sorted({node for part in evidence for node in _nodes(part)})
    return Finding(bool(nodes), "a node on the graph", ", ".join(nodes) or "no node")


def says_hello(evidence: Evidence) -> Finding:
    """The reference's line is in its log (or printed)."""
    line = _expected(evidence)
    words = [word for part in evidence for word in _words(part)]
    near = difflib.get_close_matches(line, words, n=1, cutoff=0.0) or words[:1]
    seen = f"“{line}”" if _says_it(evidence) else f"“{near[0]}”" if near else "nothing"
    return Finding(_says_it(evidence) or not evidence.reference.parts, f"“{line}”", seen)


def entry_point(evidence: Evidence) -> Advice | None:
    """The package is there, and its setup.py does not name the program, or names what is not there."""
    return programs.entry_point(evidence, ENTRY)


def package_name(evidence: Evidence) -> Advice | None:
    """The workspace holds packages, and none of the task's name."""
    return programs.package_name(evidence, PACKAGE)


def no_executable(evidence: Evidence) -> Advice | None:
    """`ros2 run` knows the package and finds no such program in it."""
    return programs.no_executable(evidence, ENTRY)


def no_node(evidence: Evidence) -> Advice | None:
    """It says the line, and no node says it."""
    if is_a_node(evidence).passed or not _says_it(evidence):
        return None
    return Advice(
        "The line is there, but no node says it: your program never appeared on the graph.",
        "Make a class derived from Node, call super().__init__('simple_node') in it, and log with "
        "self.get_logger().info(...).",
    )


def wrong_text(evidence: Evidence) -> Advice | None:
    """Its node says something else."""
    finding = says_hello(evidence)
    if finding.passed or not any(_words(part) for part in evidence) or not is_a_node(evidence).passed:
        return None
    return Advice(
        f"Your node says {finding.seen}; the task asks for {finding.expected}.",
        "Compare the two letter by letter: capitals, the comma, the exclamation mark and the full stop count.",
    )


def not_logged(evidence: Evidence) -> Advice | None:
    """Its node says nothing."""
    if (
        says_hello(evidence).passed
        or any(_words(part) for part in evidence)
        or not is_a_node(evidence).passed
    ):
        return None
    return Advice(
        "Your node is on the graph, but it says nothing.",
        "Log the line in __init__, after super().__init__: self.get_logger().info('...').",
    )


EXERCISE = Exercise(
    id="lab_1_1.hello",
    title="Lab 1.1 · The first node",
    task="A package that builds, and a node in it that says hello.",
    scenario=scenario,
    criteria=(
        Criterion("starts", "Builds, and ros2 run starts it", 3, starts),
        Criterion("node", "Is a node on the graph", 3, is_a_node),
        Criterion("line", "Says the line", 4, says_hello),
    ),
    mistakes=(
        *workspace.BUILD,
        Mistake("package_name", package_name, certain=True),
        Mistake("entry_point", entry_point, certain=True),
        Mistake("entry_point", no_executable, certain=True),
        workspace.NOT_SOURCED,
        *common.CRASHES,
        *common.OTHER_CRASHES,
        Mistake("wrong_text", wrong_text),
        Mistake("not_logged", not_logged),
        Mistake("nothing_on_the_graph", no_node),
        common.NOTHING_THERE[0],
        common.NOTHING_THERE[1],
    ),
    roles=(),
    limit=400.0,
    runner=RunsProgram(PACKAGE, PROGRAM),
)
