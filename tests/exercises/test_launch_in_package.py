"""Where a launch file of a package lies, and what a student is told of it: no ROS is started."""

from __future__ import annotations

import pytest

from autograder import exercises
from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.output.workspace_reports import PackageReport, WorkspaceReport, workspace_report_line
from tests.cases import cases

PACKAGE = "my_robot_pkg"
RIGHT = f"share/{PACKAGE}/launch/remap.launch.py"
EXERCISE = exercises.get("exercise_1_1.package")
(INSTALLED,) = (one for one in EXERCISE.criteria if one.name == "installed")


def _evidence(found: list[str], built: list[str], *, missing: str = "", complete: bool = True) -> Evidence:
    """A package with these launch files, before and after its build; where it is incomplete they were left out."""
    packages = {"found": found, "built": built}
    lines = [
        workspace_report_line(
            WorkspaceReport(
                phase=phase,
                built=phase == "built",
                packages=[PackageReport(PACKAGE, "ament_python", launch_files=files)] if complete else [],
                missing=missing if phase == "built" else "",
                complete=complete,
            )
        )
        for phase, files in packages.items()
    ]
    events = [Event(0.0, "output", "stdout", {"text": line}) for line in lines]
    reference = Reference(EXERCISE.id, {"publisher": {"/robot/status_updates": "std_msgs/msg/String"}})
    return Evidence([Part("launching", {"text": "status 1"}, events)], reference)


@pytest.mark.parametrize(
    "name", ["remap.launch.py", "remap.launch.xml", "remap.launch.yaml", "remap.launch.yml"]
)
def test_a_launch_file_of_each_language_is_installed_in_the_folder_launch(name: str) -> None:
    file = f"share/{PACKAGE}/launch/{name}"
    assert INSTALLED.judge(
        _evidence([f"launch/{name}"], [file, f"share/{PACKAGE}/launch/plain.launch.py"])
    ).passed


@pytest.mark.parametrize(
    ("found", "built", "key", "words"), cases(__file__, "what_is_wrong_with_the_place_of_a_launch_file")
)
def test_what_is_wrong_with_the_place_of_a_launch_file(
    found: list[str], built: list[str], key: str, words: str
) -> None:
    seen = _evidence(found, built, missing="remap.launch")
    assert not INSTALLED.judge(seen).passed
    told = [(mistake.key, advice) for mistake in EXERCISE.mistakes if (advice := mistake.recognize(seen))]
    assert told[0][0] == key
    assert words in told[0][1].text


def test_nothing_is_said_of_the_place_of_a_file_that_is_installed() -> None:
    seen = _evidence(["launch/remap.launch.py"], [RIGHT])
    told = {mistake.key for mistake in EXERCISE.mistakes if mistake.recognize(seen)}
    assert not told & {"launch_not_installed", "launch_elsewhere", "launch_file_name", "data_file_missing"}


def test_what_a_long_report_has_left_out_is_not_judged_as_missing() -> None:
    assert INSTALLED.judge(_evidence([], [], complete=False)).passed
    assert not INSTALLED.judge(_evidence([], [], complete=False, missing="remap.launch")).passed
