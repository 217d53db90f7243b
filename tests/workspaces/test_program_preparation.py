"""The line about a build: it survives the way to the judge, and only the first one counts."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.judge import evidence_files
from autograder.kit.evidence import Event, Evidence, Part
from autograder.kit.output.launched_processes import Process, process_line, processes, remappings
from autograder.kit.output.workspace_reports import (
    MAX_LINE,
    Interface,
    PackageReport,
    WorkspaceReport,
    report_of,
    workspace_report_line,
)
from autograder.workspaces import program_preparation
from autograder.workspaces.builds.colcon_build import Build
from autograder.workspaces.builds.install_folder import LIBRARY
from autograder.workspaces.packages import Package
from autograder.workspaces.program_plans import Plan
from autograder.workspaces.program_preparation import report_line

if TYPE_CHECKING:
    from pathlib import Path


def part(*lines: str) -> Part:
    return Part("x", {}, [Event(0.0, "output", "stdout", {"text": line}) for line in lines])


def reported(seen: Part, phase: str = "built") -> WorkspaceReport:
    """The report of a run, which has one."""
    found = report_of(seen, phase)
    assert found is not None
    return found


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
            ["p"],
            ["launch/p.launch.py"],
        )
    ],
)


def test_a_report_comes_back_as_it_went() -> None:
    assert report_of(part("chatter", workspace_report_line(REPORT))) == REPORT


def test_the_first_report_counts() -> None:
    forged = workspace_report_line(WorkspaceReport(phase="built", built=True))
    assert report_of(part(workspace_report_line(REPORT), forged)) == REPORT


def test_a_report_is_none_of_the_subject_s_words() -> None:
    assert part(workspace_report_line(REPORT), process_line(Process(7, 5, ("talker",))), "hello").said() == [
        "hello"
    ]


def test_a_long_log_is_cut() -> None:
    long = WorkspaceReport(phase="built", built=False, log="é" * 100_000, line="x" * 10_000)
    line = workspace_report_line(long)
    assert len(line.encode()) <= MAX_LINE
    assert report_of(part(line)) is not None


def other(number: int) -> PackageReport:
    return PackageReport(
        f"examples_{number}", "ament_python", ["p = a.b:c"] * 5, [], ["rclpy"] * 9, ["a.py"] * 9
    )


@pytest.mark.parametrize("number", [0, 3, 12, 200])
def test_packages_beside_the_needed_ones_take_nothing_from_them(number: int) -> None:
    others = [other(n) for n in range(number)]
    line = workspace_report_line(REPORT, others)
    assert len(line.encode()) <= MAX_LINE
    seen = reported(part(line))
    assert seen.complete
    assert seen.packages[:1] == REPORT.packages
    assert len(seen.packages) == 1 + min(number, 12 if number < 100 else 10)


def test_what_was_left_out_is_not_taken_for_missing() -> None:
    whole = Interface("srv/A.srv", "int64 a\n---\n", True)
    long = Interface("srv/B.srv", "int64 a\n" * 1_000, True)
    package = replace(REPORT.packages[0], interfaces=[whole, long])
    seen = reported(part(workspace_report_line(replace(REPORT, packages=[package]))))
    assert not seen.complete
    assert list(seen.packages[0].interfaces) == [whole, replace(long, text=None)]
    many = reported(part(workspace_report_line(replace(REPORT, packages=[package] * 200))))
    assert not many.complete


def test_of_definitions_the_one_that_is_asked_for_is_reported_without_comments(tmp_path: Path) -> None:
    (tmp_path / "srv").mkdir()
    (tmp_path / "srv" / "A.srv").write_text("int64 a\n")
    (tmp_path / "srv" / "B.srv").write_text(
        "# A licence\n\nint64 a  # one\nstring b '#'  # two\n---\n#\nint64 c\n"
    )
    found = Build(tmp_path, ok=True, packages=(Package("a", tmp_path, "ament_cmake"),))
    plan = Plan(lambda _: ["a"], lambda _: "", lambda _: [], definition="B.srv")
    seen = reported(part(report_line("found", found, plan)), "found")
    assert [(i.file, i.text) for i in seen.packages[0].interfaces] == [
        ("srv/B.srv", "int64 a\nstring b '#'  # two\n---\nint64 c"),
        ("srv/A.srv", None),
    ]


def test_a_file_whose_name_is_no_text_is_reported(tmp_path: Path) -> None:
    (tmp_path / os.fsdecode(b"f\xfcr.py")).touch()
    seen = report_of(
        part(report_line("built", Build(tmp_path, ok=True, packages=(Package("a", tmp_path, ""),))))
    )
    assert seen is not None
    assert list(seen.packages[0].modules) == ["f?r.py"]


def package_with(folder: Path, name: str, **texts: str) -> Package:
    """A package of these files; in their names _ stands for the dot."""
    (folder / name).mkdir()
    for file, text in texts.items():
        (folder / name / file.replace("_", ".")).write_text(text)
    return Package(name, folder / name, "ament_cmake")


@pytest.mark.parametrize(
    ("needed", "looked_into", "complete"), [("a", "ab", True), ("d", "da", True), ("abcd", "ab", False)]
)
def test_the_packages_that_are_needed_are_looked_into_first_and_only_so_far(
    needed: str, looked_into: str, complete: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program_preparation, "MAX_LOOK", 25_000)
    setup = '"p = a.b:c"  #' + "x" * 9_000
    packages = tuple(package_with(tmp_path, name, setup_py=setup) for name in "abcd")
    found = Build(tmp_path, ok=True, packages=packages)
    seen = report_of(
        part(report_line("found", found, Plan(lambda _: needed, lambda _: "", lambda _: []))), "found"
    )
    assert seen is not None
    assert seen.complete == complete
    assert [package.name for package in seen.packages if package.programs] == [*looked_into]


def test_a_definition_without_room_is_left_out_and_not_taken_for_missing(tmp_path: Path) -> None:
    long = package_with(tmp_path, "a", A_srv="int64 a\n" * 20_000, CMakeLists_txt="#" * 60_000)
    found = Build(tmp_path, ok=True, packages=(long,))
    plan = Plan(lambda _: ["a"], lambda _: "", lambda _: [], definition="A.srv")
    seen = reported(part(report_line("found", found, plan)), "found")
    assert not seen.complete
    assert list(seen.packages[0].interfaces) == [Interface("A.srv", None, True)]


XML_DEPENDS = ("ament_cmake", "rosidl_default_generators", "rosidl_interface_packages")


@pytest.mark.parametrize(
    ("depends", "declares", "says"),
    [
        (XML_DEPENDS, False, "it does not name rosidl_default_runtime"),
        ((*XML_DEPENDS, "rosidl_default_runtime"), True, "it does"),
        ((*XML_DEPENDS, *["std_msgs"] * 200), False, "it does not name rosidl_default_runtime"),
        ((*XML_DEPENDS, *["std_msgs"] * 200, "rosidl_default_runtime"), True, "it does"),
    ],
)
def test_what_a_package_declares_is_asked_of_its_dependencies_alone(
    depends: tuple[str, ...], declares: bool, says: str, tmp_path: Path
) -> None:
    package = package_with(tmp_path, "a", AddTwoInts_srv="int64 a", setup_py="#" * 150_000)
    found = Build(tmp_path, ok=True, packages=(replace(package, dependencies=depends),))
    plan = Plan(lambda _: ["a"], lambda _: "", lambda _: [], definition="AddTwoInts.srv")
    exercise = exercises.get("lab_1_3.interface")
    seen = Evidence([part(report_line("built", found, plan))], evidence_files.load_reference(exercise.id))
    point = next(criterion for criterion in exercise.criteria if criterion.name == "declares")
    finding = point.judge(seen)
    assert (finding.passed, finding.seen) == (declares, says)


def test_entry_points_are_those_that_are_installed(tmp_path: Path) -> None:
    prefix = tmp_path / "install" / "a"
    metadata = prefix / LIBRARY / "a-0.0.0.egg-info"
    metadata.mkdir(parents=True)
    (metadata / "entry_points.txt").write_text("[console_scripts]\np = a.b:c\n")
    (prefix / "lib" / "a").mkdir(parents=True)
    (prefix / "lib" / "a" / "p").write_text("")
    (prefix / "share" / "a").mkdir(parents=True)
    (prefix / "share" / "a" / "package.xml").write_text("")
    made = Build(tmp_path, ok=True, install=tmp_path / "install", packages=(Package("a", tmp_path, ""),))
    seen = reported(part(report_line("built", made)))
    assert (list(seen.packages[0].programs), list(seen.packages[0].installed)) == (["p = a.b:c"], ["p"])
    (metadata / "entry_points.txt").write_text("p = a.b:c\n" * 20_000)
    seen = reported(part(report_line("built", made)))
    assert list(seen.packages[0].programs) == []


def test_launch_files_are_those_of_the_sources_and_after_the_build_those_that_are_installed(
    tmp_path: Path,
) -> None:
    package = package_with(tmp_path, "a")
    for file in ("launch/a.launch.py", "launch/b.yaml", "start.launch.xml", "config/c.yaml", "launch/README"):
        (package.folder / file).parent.mkdir(exist_ok=True)
        (package.folder / file).touch()
    found = Build(tmp_path, ok=False, packages=(package,))
    assert launches(report_line("found", found)) == [
        "launch/a.launch.py",
        "launch/b.yaml",
        "start.launch.xml",
    ]
    built = replace(found, ok=True, install=tmp_path / "install")
    share = tmp_path / "install" / "a" / "share" / "a"
    share.mkdir(parents=True)
    assert launches(report_line("built", built)) == []
    (share / "a.launch.py").touch()
    assert launches(report_line("built", built)) == ["share/a/a.launch.py"]


def launches(line: str) -> list[str]:
    """The launch files of the one package of a report."""
    report = reported(part(line), "built" if '"phase":"built"' in line else "found")
    (package,) = report.packages
    return list(package.launch_files)


def test_nonsense_is_no_report() -> None:
    assert report_of(part("@workspace {", "@workspace 7", '@workspace {"phase": "built"}')) is None
    assert processes(part("@process [", "@process 7", '@process ["talker"]', "@process [7, 5]")) == []


def test_rules_are_read_from_a_command_line() -> None:
    argv = ("talker", "--ros-args", "-r", "__node:=x", "--remap", "a:=/b", "-p", "c:=1")
    assert remappings(argv) == [("__node", "x"), ("a", "/b")]
    assert processes(part(process_line(Process(7, 5, argv)))) == [Process(7, 5, argv)]


def test_what_a_package_needs_for_interfaces_is_what_is_left_out_last() -> None:
    """Forty messages and twelve dependencies leave room for ten: a right package lost a point for the eleventh."""
    package = PackageReport(
        "my_robot_interfaces",
        "ament_cmake",
        dependencies=[
            *(f"other_msgs_{n}" for n in range(12)),
            "rosidl_default_generators",
            "rosidl_default_runtime",
        ],
        interfaces=[
            Interface(f"a_message_with_a_long_name_{n}.msg", "string text", listed=True) for n in range(40)
        ],
    )
    report = reported(part(workspace_report_line(replace(REPORT, packages=[package]))))
    assert not report.complete
    assert {"rosidl_default_generators", "rosidl_default_runtime"} < set(report.packages[0].dependencies)
