"""The line about a build: it survives the way to the judge, and only the first one counts."""

from __future__ import annotations

from autograder.kit.evidence import Event, Part
from autograder.kit.launch_report import Process, process_line, processes, remappings
from autograder.kit.workspace_report import (
    MAX_LINE,
    Interface,
    PackageReport,
    WorkspaceReport,
    as_line,
    report_of,
)


def part(*lines: str) -> Part:
    return Part("x", {}, [Event(0.0, "output", "stdout", {"text": line}) for line in lines])


REPORT = WorkspaceReport(
    phase="built",
    built=False,
    line="setup.py:7: “bad”",
    packages=[
        PackageReport(
            "a",
            "ament_cmake",
            ["p = a.b:c"],
            [Interface("srv/A.srv", "int64 a\n---\n", True)],
            [],
            ["a/b.py"],
            ["a_group"],
        )
    ],
)


def test_a_report_comes_back_as_it_went() -> None:
    assert report_of(part("chatter", as_line(REPORT))) == REPORT


def test_the_first_report_counts() -> None:
    forged = as_line(WorkspaceReport(phase="built", built=True))
    assert report_of(part(as_line(REPORT), forged)) == REPORT


def test_a_report_is_none_of_the_subject_s_words() -> None:
    assert part(as_line(REPORT), process_line(Process(7, 5, ("talker",))), "hello").said() == ["hello"]


def test_a_long_log_is_cut() -> None:
    long = WorkspaceReport(phase="built", built=False, log="é" * 100_000, line="x" * 10_000)
    line = as_line(long)
    assert len(line.encode()) <= MAX_LINE
    assert report_of(part(line)) is not None


def test_nonsense_is_no_report() -> None:
    assert report_of(part("@workspace {", "@workspace 7", '@workspace {"phase": "built"}')) is None
    assert processes(part("@process [", "@process 7", '@process ["talker"]', "@process [7, 5]")) == []


def test_rules_are_read_from_a_command_line() -> None:
    argv = ("talker", "--ros-args", "-r", "__node:=x", "--remap", "a:=/b", "-p", "c:=1")
    assert remappings(argv) == [("__node", "x"), ("a", "/b")]
    assert processes(part(process_line(Process(7, 5, argv)))) == [Process(7, 5, argv)]
