"""The doctor's findings: on things that are broken in a known way, and on this machine."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_runtime import doctor, jupyter_files, loopback, ros_flavour
from course_runtime.doctor import Finding, as_text, exit_code
from course_runtime.place import Place
from course_runtime.ros_flavour import Ros
from course_runtime.ros_report import INTERFACE_FIELDS, rclpy_version
from environment import bootstrap
from environment.setup_steps import SetupError

if TYPE_CHECKING:
    from course_runtime.doctor import State

HEALTHY = {"version": "7.1.5", "prefix": "/env", "rmw": "rmw_fastrtps_cpp", "fields": INTERFACE_FIELDS}


def program(folder: Path, name: str, script: str) -> None:
    """Put a program into a folder."""
    (folder / name).write_text(f"#!/bin/sh\n{script}\n")
    (folder / name).chmod(0o755)


@pytest.mark.parametrize(
    ("states", "code"),
    [(["ok", "optional", "unchecked"], 0), (["ok", "missing"], 1), ([], 0)],
)
def test_only_something_missing_is_a_failure(states: list[State], code: int) -> None:
    assert exit_code([Finding("a", state, "b") for state in states]) == code


def test_the_text_names_state_thing_detail_and_remedy() -> None:
    text = as_text(
        [Finding("CMake", "missing", "not found", "Type: ./course setup"), Finding("Disk", "ok", "9 GB")]
    )
    assert text.splitlines() == [
        "MISSING      CMake: not found",
        "               Type: ./course setup",
        "ok           Disk: 9 GB",
    ]


def ros_findings(monkeypatch: pytest.MonkeyPatch, printed: str, recorded: Ros | None = None) -> list[Finding]:
    """Return what is found when the report of a fresh process is this."""
    monkeypatch.setattr(doctor, "_output", lambda command, limit=0: (0, printed))
    monkeypatch.setattr(ros_flavour, "load", lambda prefix: recorded)
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    monkeypatch.setenv("ROS_DOMAIN_ID", "65")
    return doctor.ros()


def test_a_healthy_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    found = ros_findings(monkeypatch, f"a library said hello\n{json.dumps(HEALTHY)}\n", Ros("wheels"))
    assert [finding.state for finding in found] == ["ok", "ok", "ok"]
    assert found[0].detail == "Jazzy from wheels, rclpy 7.1.5 in /env"
    assert found[1].detail == "rmw_fastrtps_cpp, ROS_DOMAIN_ID 65"


def test_the_version_is_that_of_the_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "share/rclpy/package.xml"
    package.parent.mkdir(parents=True)
    package.write_text("<package>\n  <version> 7.1.5 </version>\n</package>")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'other'}:{tmp_path}")
    assert rclpy_version() == ("7.1.5", str(tmp_path))


def test_an_installed_wheel_has_no_ament_prefix_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("AMENT_PREFIX_PATH")
    package = tmp_path / "share/rclpy/package.xml"
    package.parent.mkdir(parents=True)
    package.write_text("<package><version>7.1.5</version></package>")
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert rclpy_version() == ("7.1.5", str(tmp_path))
    monkeypatch.setattr(doctor, "IS_CLONE", False)
    found = ros_findings(monkeypatch, json.dumps({**HEALTHY, "prefix": sys.prefix}))
    assert [finding.detail for finding in found][:1] == ["from wheels, rclpy 7.1.5"]


def test_an_rclpy_that_cannot_be_imported(monkeypatch: pytest.MonkeyPatch) -> None:
    report = {"rclpy_error": "ImportError: librcl.so", "interfaces_error": "ImportError: librcl.so"}
    found = ros_findings(monkeypatch, json.dumps(report), Ros("system"))
    assert [finding.state for finding in found] == ["missing", "unchecked", "missing"]
    assert "librcl.so" in found[0].detail
    assert "sourced at set-up" in found[0].remedy


@pytest.mark.parametrize("printed", ["", "Segmentation fault", "[1, 2]"])
def test_a_process_that_ends_without_a_report(monkeypatch: pytest.MonkeyPatch, printed: str) -> None:
    found = ros_findings(monkeypatch, printed)
    assert found[0].state == "missing"
    assert "./course setup" in found[0].remedy


def test_an_interface_package_with_other_fields(monkeypatch: pytest.MonkeyPatch) -> None:
    fields = {**INTERFACE_FIELDS, "AddTwoInts.Request": {"x": "int64"}}
    found = ros_findings(monkeypatch, json.dumps({**HEALTHY, "fields": fields}), Ros("wheels"))
    assert [finding.state for finding in found] == ["ok", "ok", "missing"]
    assert "in the way" in found[2].detail


def test_two_processes_that_do_not_hear_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loopback, "seconds_to_first_message", lambda: None)
    (found,) = doctor.talk()
    assert found.state == "missing"
    assert "UDPv4" in found.remedy


def test_no_talk_without_rclpy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_output", lambda command: (1, "ModuleNotFoundError"))
    assert doctor.talk()[0].state == "unchecked"


def kernelspec(folder: Path, **changes: object) -> Path:
    """Write a kernelspec, sound but for the changes."""
    path = folder / "kernel.json"
    path.write_text(json.dumps({"argv": ["/bin/sh"], "env": jupyter_files.KERNEL_VARIABLES, **changes}))
    return path


def test_a_sound_kernelspec(tmp_path: Path) -> None:
    assert doctor.kernel(kernelspec(tmp_path)).state == "ok"


def test_a_kernelspec_that_lets_log_lines_cost_points(tmp_path: Path) -> None:
    found = doctor.kernel(kernelspec(tmp_path, env={"RCUTILS_COLORIZED_OUTPUT": "0"}))
    assert found.state == "missing"
    assert "RCUTILS_LOGGING_USE_STDOUT" in found.detail
    assert "RCUTILS_COLORIZED_OUTPUT" not in found.detail


@pytest.mark.parametrize("changes", [{"argv": ["/nowhere/python"]}, {"argv": []}, {"argv": None}])
def test_a_kernelspec_that_starts_nothing(tmp_path: Path, changes: dict[str, object]) -> None:
    assert doctor.kernel(kernelspec(tmp_path, **changes)).state == "missing"


def test_a_kernelspec_that_is_not_there(tmp_path: Path) -> None:
    assert doctor.kernel(tmp_path / "kernel.json").state == "missing"


def test_room_in_a_folder(tmp_path: Path) -> None:
    assert doctor.folder_space("Disk", tmp_path, 1, "Make room.").state == "ok"
    full = doctor.folder_space("Disk", tmp_path, 10**18, "Make room.")
    assert (full.state, full.remedy) == ("missing", "Make room.")
    assert doctor.folder_space("Disk", tmp_path / "nowhere", 1, "Make room.").state == "missing"


def test_a_folder_that_is_somebody_elses_is_no_matter_of_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_runtime.doctor.may_write", lambda _: False)
    found = doctor.space()[0]
    assert found.state == "missing"
    assert "Make room" not in found.remedy
    assert f"Have {doctor.ROOT.owner()}, whose folder it is" in found.remedy


@pytest.mark.parametrize(
    ("is_set_up", "words"), [(True, "was changed since it was set up"), (False, "is not set up yet")]
)
def test_in_a_shared_course_the_set_up_says_who_has_to_run_what(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_set_up: bool, words: str
) -> None:
    place = Place(tmp_path, Path("/usr/bin/python3"))
    if is_set_up:
        place.notes.mkdir(parents=True)
    monkeypatch.setattr("environment.bootstrap.may_write", lambda _: False)
    with pytest.raises(SetupError, match=words) as error:
        bootstrap.set_up(place, {}, with_tests=False)
    assert f"Have {tmp_path.owner()}" in str(error.value)
    assert f"{tmp_path}/course setup" in str(error.value)


def test_a_sandbox_that_is_not_there_is_optional(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    (found,) = doctor.sandbox()
    assert (found.name, found.state) == ("bubblewrap", "optional")
    assert "grade a class" in found.detail


def test_a_sandbox_that_cannot_work_is_optional_and_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program(tmp_path, "bwrap", "echo 'bwrap: No permissions to create new namespace' >&2; exit 1")
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    (found,) = doctor.sandbox()
    assert (found.name, found.state) == ("Sandbox", "optional")
    assert "No permissions" in found.detail


def test_a_sandbox_that_works_and_its_guards() -> None:
    first, *limits = doctor.sandbox()
    if first.state != "ok":
        pytest.skip(first.detail)
    assert {"Limit on memory", "Limit on processes", "Limit on disk"} <= {found.name for found in limits}


def test_a_missing_compiler_comes_with_its_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    for name in ("CC", "CXX"):
        monkeypatch.delenv(name, raising=False)
    found = {finding.name: finding for finding in doctor.build_tools()}
    assert found["a C and C++ compiler"].state == "missing"
    assert found["a C and C++ compiler"].remedy
    assert found["CMake"].state == "missing"
    assert found["colcon"].state == "missing"


def test_a_program_that_hangs_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_SHORT", 0.05)
    program(tmp_path, "hang", "exec sleep 60")
    code, text = doctor._output([str(tmp_path / "hang")])
    assert code == 127
    assert "timed out" in text


@pytest.mark.ros
def test_this_machine_has_all_that_the_course_needs(capsys: pytest.CaptureFixture[str]) -> None:
    assert doctor.main(["--json"]) == 0
    found = [Finding(**finding) for finding in json.loads(capsys.readouterr().out)]
    assert [finding.name for finding in found if finding.state in ("missing", "unchecked")] == []
    assert {"ROS 2", "Two nodes talk", "my_robot_interfaces", "Kernel python3"} <= {f.name for f in found}
