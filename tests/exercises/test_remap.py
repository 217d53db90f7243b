"""How sure the remapping exercise is of what a launch file left behind: no ROS is started."""

from __future__ import annotations

import pytest

from autograder import exercises
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.output.launched_processes import Process, process_line
from autograder.kit.output.workspace_reports import PackageReport, WorkspaceReport, workspace_report_line
from autograder.kit.recipes.launch_file import Launched
from tests.cases import cases, named_cases

STRING = "std_msgs/msg/String"
NEW, OLD = "/robot/status_updates", "/chatter"
REFERENCE = Reference("exercise_1_1.remap", {"publisher": {NEW: STRING}})
RULES = ("--ros-args", "-r", f"chatter:={NEW}")


def _evidence(*started: int, talkers: dict[int, str], listener: int) -> Evidence:
    """Three or fewer programs of a launch: which process publishes under which name, and which one listens."""
    launched = [
        Event(0.0, "output", "stdout", {"text": process_line(Process(pid, 1, ("program", *RULES)))})
        for pid in started
    ]
    ends = [["publisher", name, process] for process, name in talkers.items()]
    ends.append(["subscription", NEW, listener])
    interface = Event(
        1.0,
        "interface",
        "",
        {"publisher": dict.fromkeys(talkers.values(), STRING), "subscription": {NEW: STRING}, "ends": ends},
    )
    return Evidence([Part("launching", {"text": "status 1"}, [*launched, interface])], REFERENCE)


@pytest.mark.parametrize(("what", "next_step"), cases(__file__, "the_next_step_fits_what_the_launch_says"))
def test_the_next_step_fits_what_the_launch_says(what: str, next_step: str) -> None:
    failed = Event(0.0, "output", "stderr", {"text": f"[ERROR] [launch]: {what}"})
    seen = Evidence([Part("launching", {"text": "status 1"}, [failed])], REFERENCE)
    known = [one for one in exercises.get("exercise_1_1.remap").mistakes if one.key == "launch_error"]
    advice = next(filter(None, (mistake.recognize(seen) for mistake in known)))
    assert what in advice.text
    assert next_step in advice.next_step


@pytest.mark.parametrize(
    ("started", "certain"), named_cases(__file__, "who_was_not_moved_is_certain_once_all_programs_are_there")
)
def test_who_was_not_moved_is_certain_once_all_programs_are_there(
    started: tuple[int, ...], certain: bool
) -> None:
    seen = _evidence(*started, talkers={11: OLD}, listener=12)
    told = [
        mistake
        for mistake in exercises.get("exercise_1_1.remap").mistakes
        if mistake.key == "only_one_remapped" and mistake.recognize(seen)
    ]
    assert told
    assert told[0].certain is certain


PATH = "/home/student/ros2_ws/install/my_robot_pkg/lib/my_robot_pkg"


@pytest.mark.parametrize(
    ("argv", "alone"),
    [
        *cases(__file__, "a_program_without_its_rules_keeps_its_other_arguments"),
        (("python3", f"{PATH}/talker", *RULES), ("my_robot_pkg", "talker", "--ros-args")),
        (("python3", "-u", f"{PATH}/talker", *RULES), ("my_robot_pkg", "talker", "--ros-args")),
        ((f"{PATH}/talker", "7", *RULES), ("my_robot_pkg", "talker", "7", "--ros-args")),
        ((f"{PATH}/talker", *RULES, "--params-file", "/tmp/p"), ("my_robot_pkg", "talker", "--ros-args")),
        (
            ("python3", f"{PATH}/talker", *RULES, "--remap", "mood:=chatter", "--remap", f"~/chatter:={NEW}"),
            ("my_robot_pkg", "talker", "--ros-args", "--remap", "mood:=chatter"),
        ),
    ],
)
def test_a_program_without_its_rules_keeps_its_other_arguments(
    argv: tuple[str, ...], alone: tuple[str, ...]
) -> None:
    assert _launched(argv).without_rules == [alone]


@pytest.mark.parametrize(
    "argv",
    [
        ("python3", "talker.py", *RULES),
        ("python3", "-m", "my_robot_pkg.talker", *RULES),
        ("python3", f"{PATH}/--prefix", *RULES),
    ],
)
def test_what_is_no_packages_program_is_not_started_again(argv: tuple[str, ...]) -> None:
    assert _launched(argv).without_rules == []


@pytest.mark.parametrize(
    ("started", "alone"),
    cases(__file__, "a_module_or_file_is_started_again_as_the_program_that_setup_py_makes_of_it"),
)
def test_a_module_or_file_is_started_again_as_the_program_that_setup_py_makes_of_it(
    started: tuple[str, ...], alone: tuple[str, ...]
) -> None:
    entries = ("speak=my_robot_pkg.talker:main", "hear = my_robot_pkg.hear:main [extra]")
    assert _launched(("python3", *started, *RULES), entries).without_rules == [("my_robot_pkg", *alone)]


@pytest.mark.parametrize(
    "started", [("-m", "my_robot_pkg.other"), ("other.py",), ("-m", "talker"), ("talker",)]
)
def test_a_module_that_is_no_program_of_the_package_is_not_started_again(started: tuple[str, ...]) -> None:
    entries = ("talker = my_robot_pkg.talker:main", "--prefix = my_robot_pkg.other:main")
    assert _launched(("python3", *started, *RULES), entries).without_rules == []


@pytest.mark.parametrize(("names", "not_moved"), cases(__file__, "who_is_there_without_a_rule_was_not_moved"))
def test_who_is_there_without_a_rule_was_not_moved(
    names: tuple[str, str], not_moved: tuple[str, ...]
) -> None:
    launching = _evidence(11, 12, talkers={11: NEW}, listener=12)
    alone = [
        Part(
            f"{program} without its rule",
            {"program": program},
            [Event(1.0, "interface", "", {role: {name: STRING}})],
        )
        for program, role, name in zip(
            ("talker", "listener"), ("publisher", "subscription"), names, strict=True
        )
    ]
    seen = Evidence([*launching, *alone], REFERENCE)
    assert Launched(seen, "my_robot_pkg", "chatter").not_moved == list(not_moved)
    exercise = exercises.get("exercise_1_1.remap")
    held = {criterion.name: criterion.judge(seen).passed for criterion in exercise.criteria}
    assert held["launch"] is (not not_moved)
    told = [
        (mistake.certain, advice.next_step)
        for mistake in exercise.mistakes
        if mistake.key == "renamed_in_code" and (advice := mistake.recognize(seen))
    ]
    assert [certain for certain, _ in told] == [True] * bool(not_moved)
    assert all(" and ".join(not_moved) in step for _, step in told)


def _launched(argv: tuple[str, ...], programs: tuple[str, ...] = ()) -> Launched:
    """The one program of a launch, which publishes under the new name, and the programs that setup.py names."""
    report = WorkspaceReport("built", built=True, packages=[PackageReport("my_robot_pkg", "", programs)])
    built = Event(0.0, "output", "report", {"text": workspace_report_line(report)})
    started = Event(0.0, "output", "report", {"text": process_line(Process(11, 1, argv))})
    ends = {"publisher": {NEW: STRING}, "subscription": {}, "ends": [["publisher", NEW, 11]]}
    seen = Evidence([Part("launching", {}, [built, started, Event(1.0, "interface", "", ends)])], REFERENCE)
    return Launched(seen, "my_robot_pkg", "chatter")


@pytest.mark.parametrize(
    ("nodes", "told"), [(["/bot", "/bot"], "Two of your nodes are called /bot: name="), (["/a", "/b"], "")]
)
def test_two_nodes_of_one_name_are_worth_a_remark(nodes: list[str], told: str) -> None:
    seen = Evidence([Part("launching", {}, [Event(0.0, "interface", "graph", {"nodes": nodes})])], REFERENCE)
    remarks = [text for remark in exercises.get("exercise_1_1.remap").remarks if (text := remark(seen))]
    assert [text.partition(".")[0] for text in remarks] == [told] * bool(told)
