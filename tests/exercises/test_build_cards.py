"""What a card says of a build that failed: no ROS is started."""

from __future__ import annotations

import pytest

from autograder.kit.evidence import Event, Evidence, Part, Reference
from autograder.kit.workspace_mistakes import BUILD
from autograder.kit.workspace_report import WorkspaceReport, as_line

PATH = "CMakeLists.txt:6: rosidl_generate_interfaces() the passed file 'AddTwoInts.srv' doesn't exist relative to /ws"


@pytest.mark.parametrize(
    ("line", "next_step"),
    [
        (PATH, 'such as "srv/Name.srv"'),
        ("src/arm.cpp:7: 'nod' was not declared", "Go to the place that the line names"),
        ("no space left on device", "look for the first line with the word error"),
    ],
)
def test_the_next_step_of_a_failed_build_names_no_place_that_is_not_there(line: str, next_step: str) -> None:
    report = WorkspaceReport("built", built=False, trouble="build", package="my_robot_interfaces", line=line)
    part = Part("building", {}, [Event(0.1, "output", "stdout", {"text": as_line(report)})])
    evidence = Evidence([part], Reference("lab_1_3.interface", {}))
    found = next(m for m in BUILD if m.recognise(evidence))
    advice = found.recognise(evidence)
    assert found.key == "build_failed"
    assert advice is not None
    assert advice.text == f"colcon build fails in my_robot_interfaces: {line}"
    assert next_step in advice.next_step
