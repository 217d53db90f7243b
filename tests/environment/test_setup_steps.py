"""The steps of the set-up: their inputs, and their effect on an environment that is there already."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import pytest

from course_runtime import system_packages
from course_runtime.place import Place, environment_paths
from course_runtime.ros_flavour import RECORD, Ros
from environment import bootstrap
from environment.setup_steps import Setup, SetupError
from environment.steps import Step, digest
from tests.cases import cases
from tests.copies import copied

ROOT = Path(__file__).resolve().parents[2]
PLACE = Place(ROOT, Path("/usr/bin/python3.11"))
JAZZY = Ros("system", {"AMENT_PREFIX_PATH": ("/opt/ros/jazzy",), "LD_LIBRARY_PATH": ("/opt/ros/jazzy/lib",)})


def steps(
    place: Place = PLACE, ros: Ros | None = None, with_tests: bool = False, extras: tuple[str, ...] = ()
) -> dict[str, Step]:
    """Return the steps of a set-up by their names."""
    setup = Setup(place, ros or Ros("wheels"), {}, io.StringIO())
    return {step.name: step for step in setup.steps(with_tests, extras)}


def made_from(step: Step) -> str:
    return digest(step.inputs, ROOT)


def test_the_order() -> None:
    assert list(steps(with_tests=True)) == [
        *("environment", "uv", "packages", "sources", "fast_dds"),
        *(
            "interfaces_my_robot_interfaces",
            "interfaces_small_robot_interfaces",
            "interfaces_agent_interfaces",
        ),
        *("start", "ros2", "jupyter", "project", "dev"),
    ]


def test_without_tests_their_tools_are_not_installed() -> None:
    assert not {"dev", "cluster", "postgresql"} & set(steps())


def test_an_extra_is_installed_where_it_is_asked_for() -> None:
    assert list(steps(extras=("cluster",)))[-1] == "cluster"
    assert PLACE.lock("cluster") in steps(extras=("cluster",))["cluster"].inputs
    assert PLACE.lock("cluster") in steps(with_tests=True)["dev"].inputs


def test_an_extra_that_was_asked_for_once_stays(tmp_path: Path) -> None:
    place = Place(tmp_path, Path("/usr/bin/python3.11"))
    place.notes.mkdir(parents=True)
    assert bootstrap._extras(place, ()) == []
    assert bootstrap._extras(place, ("cluster",)) == ["cluster"]
    assert bootstrap._extras(place, ()) == ["cluster"]
    assert bootstrap._extras(place, ("postgresql",)) == ["cluster", "postgresql"]


def test_another_python_another_folder_or_another_ros_makes_another_environment() -> None:
    usual = made_from(steps()["environment"])
    others = [
        steps(replace(PLACE, base_python=Path("/usr/bin/python3.12"))),
        steps(ros=JAZZY),
        steps(ros=replace(JAZZY, paths={"AMENT_PREFIX_PATH": ("/opt/ros/other",)})),
    ]
    assert len({usual, *(made_from(other["environment"]) for other in others)}) == 4


def test_a_notice_about_a_ros_that_is_left_out_makes_the_same_environment() -> None:
    noticed = steps(ros=Ros("wheels", notice="ROS 2 humble is sourced"))
    assert made_from(noticed["environment"]) == made_from(steps()["environment"])


def test_the_ros_wheels_are_left_out_where_a_ros_is_sourced() -> None:
    ros_lock = PLACE.lock("ros")
    assert ros_lock in steps()["packages"].inputs
    assert ros_lock not in steps(ros=JAZZY)["packages"].inputs
    assert PLACE.lock("course") in steps(ros=JAZZY)["packages"].inputs


def test_the_interfaces_are_made_from_every_file_of_their_package() -> None:
    names = {path.name for path in steps()["interfaces_my_robot_interfaces"].inputs if isinstance(path, Path)}
    assert {
        "AddTwoInts.srv",
        "Fibonacci.action",
        "interface_packages.py",
        "wheel_repairs.py",
        "only_python.cmake",
    } == names


def test_a_package_in_a_chapters_folder_is_built_alone(tmp_path: Path) -> None:
    copied(ROOT / "environment", tmp_path / "environment")
    usual = steps(place := Place(tmp_path, PLACE.base_python))
    package = tmp_path / "solutions/02_power/interfaces/power_interfaces"
    (package / "srv").mkdir(parents=True)
    (package / "srv/SetLevel.srv").touch()
    (tmp_path / "solutions/02_power/lab_2_1").mkdir()
    with_it = steps(place)
    step = with_it.pop("interfaces_power_interfaces")
    assert step.doing == "building power_interfaces with colcon"
    assert package / "srv/SetLevel.srv" in step.inputs
    assert step.stands_alone
    assert {name: one.inputs for name, one in with_it.items()} == {
        name: one.inputs for name, one in usual.items()
    }


def test_a_sourced_ros_comes_after_the_environment_in_every_search_path(tmp_path: Path) -> None:
    place = Place(tmp_path, Path("/usr/bin/python3.11"))
    paths = environment_paths(place, JAZZY)
    assert paths["AMENT_PREFIX_PATH"] == [f"{tmp_path}/.venv", "/opt/ros/jazzy"]
    assert paths["LD_LIBRARY_PATH"] == [f"{tmp_path}/.venv/lib", "/opt/ros/jazzy/lib"]


def test_a_command_that_fails_is_an_error_that_says_what_it_was_to_do(tmp_path: Path) -> None:
    log = tmp_path / "log.txt"
    with log.open("w") as output:
        setup = Setup(
            Place(tmp_path, Path("/usr/bin/python3.11")), Ros("wheels"), {"PATH": "/usr/bin:/bin"}, output
        )
        with pytest.raises(SetupError, match="building failed"):
            setup._run("building", ["sh", "-c", "echo because; exit 3"])
    assert "because" in log.read_text()


def test_the_commands_of_the_set_up_see_neither_another_ros_nor_another_python(tmp_path: Path) -> None:
    humble = tmp_path / "opt/ros/humble"
    (humble / "share/rclpy").mkdir(parents=True)
    (humble / "share/rclpy/package.xml").touch()
    environ = {
        "PATH": "/usr/bin:/bin",
        "AMENT_PREFIX_PATH": str(humble),
        "PYTHONPATH": f"{humble}/lib/python3.10/site-packages",
        "PYTHONHOME": "/usr",
        "VIRTUAL_ENV": "/home/me/another",
    }
    log = tmp_path / "log.txt"
    place = Place(tmp_path, Path("/usr/bin/python3.11"))
    with log.open("w") as output:
        Setup(place, Ros("wheels"), environ, output)._run("looking", ["env"])
    lines = log.read_text().splitlines()
    assert f"VIRTUAL_ENV={tmp_path}/.venv" in lines
    assert f"AMENT_PREFIX_PATH={tmp_path}/.venv" in lines
    assert not [line for line in lines if "humble" in line or line.startswith("PYTHONHOME")]


SECRET = {"LMS_API_TOKEN": "planted-4711", "LC_SECRET": "planted-4711", "ROS_SECRET": "planted-4711"}
LEFT = (
    "build/my_robot_interfaces/colcon_command_prefix_build.sh.env",
    "colcon-log/events.log",
    "interfaces/a/package.xml",
)


def test_a_build_keeps_no_variable_of_the_user_and_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copied(ROOT / "environment/interfaces", tmp_path / "environment/interfaces")
    (tmp_path / ".venv/bin").mkdir(parents=True)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    place = Place(tmp_path, Path(sys.executable))
    workspace = tmp_path / "reference_ws/install"
    environ = {**os.environ, **SECRET, "CMAKE_PREFIX_PATH": str(workspace)}
    with (tmp_path / "log.txt").open("w") as log:
        setup = Setup(place, JAZZY, environ, log)
        colcon, builds = place.prefix / "bin/colcon", tmp_path / "builds"
        colcon.write_text(f"#!/bin/sh\nenv >{builds}; stat -c 'mode %a' {tmp_path}/temporary/*\n")
        colcon.chmod(0o755)
        setup._build_interfaces(place.interfaces[0])
    assert "mode 700" in (tmp_path / "log.txt").read_text()
    assert "planted-4711" not in builds.read_text()
    assert str(workspace) not in builds.read_text()
    assert f"CMAKE_PREFIX_PATH={place.prefix}" in builds.read_text()
    assert list((tmp_path / "temporary").iterdir()) == []
    assert not place.notes.exists()


def test_what_installs_packages_gets_the_variables_of_the_user(tmp_path: Path) -> None:
    setup = Setup(PLACE, Ros("wheels"), {**SECRET, "PIP_INDEX_URL": "https://one.example"}, io.StringIO())
    assert setup._installer_variables()["PIP_INDEX_URL"] == "https://one.example"
    assert not set(SECRET) & set(setup._build_variables())


def test_a_set_up_removes_what_earlier_ones_have_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = Place(tmp_path, Path(sys.executable))
    for name in LEFT:
        (place.notes / name).parent.mkdir(parents=True)
        (place.notes / name).write_text("LMS_API_TOKEN=planted-4711")
    (place.notes / "setup.log").write_text("planted-4711")
    (place.notes / "setup.log").chmod(0o644)
    monkeypatch.setattr(Setup, "steps", lambda *_: [])
    monkeypatch.setattr(Setup, "compile_modules", lambda _: None)
    monkeypatch.setattr(system_packages, "require", lambda *_: None)
    monkeypatch.setattr(bootstrap, "_provide", lambda *_: None)
    bootstrap.set_up(place, {"PATH": os.environ["PATH"]}, with_tests=False)
    assert [path.name for path in place.notes.iterdir()] == ["setup.log"]
    assert (place.notes / "setup.log").stat().st_mode & 0o777 == 0o600


def test_what_was_done_in_the_old_environment_is_to_be_done_again_in_a_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = Place(tmp_path, Path(sys.executable))
    for file in (place.prefix / "lib/old.py", place.notes / "setup.log", place.notes / "stamps/packages"):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    monkeypatch.setattr(Setup, "_run", lambda *_: None)
    steps(place)["environment"].run()
    left = {path for path in place.prefix.rglob("*") if path.is_file()}
    assert left == {place.notes / "setup.log", place.prefix / RECORD}


def test_modules_are_compiled_also_for_a_python_that_keeps_no_bytecode(tmp_path: Path) -> None:
    place = Place(tmp_path, Path(sys.executable))
    place.python.parent.mkdir(parents=True)
    place.python.symlink_to(sys.executable)
    lab = "solutions/a_chapter/a_lab"
    files = {
        "autograder/engine.py",
        "course_runtime/place.py",
        "environment/steps.py",
        f"{lab}/talker.py",
        f"{lab}/unfinished.py",
    }
    for name in files | {f"{lab}/talker.answers/wrong/answer.py"}:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("def (" if "unfinished" in name else "x = 1")
    log = tmp_path / "log.txt"
    with log.open("w") as output:
        Setup(place, Ros("wheels"), {"PYTHONDONTWRITEBYTECODE": "1"}, output).compile_modules()
    compiled = {path.name.partition(".")[0] for path in tmp_path.rglob("*.pyc")}
    assert compiled == {"engine", "place", "steps", "talker"}, log.read_text()


@pytest.fixture
def calls(tmp_path: Path) -> tuple[Setup, list[str], Path]:
    """A set-up in an environment whose Python and uv only write down that they were called, and what it says."""
    place = Place(tmp_path, Path("/usr/bin/python3.11"))
    said: list[str] = []
    called = tmp_path / "called"
    for name in ("python", "uv"):
        program = place.prefix / "bin" / name
        program.parent.mkdir(parents=True, exist_ok=True)
        program.write_text(
            f"""#!/bin/sh
case "$*" in "-m pip config list") echo "global.index-url='https://one.example/simple'"; exit; esac
echo "{name} $* index=$UV_DEFAULT_INDEX" >>{called}
! [ -e {tmp_path}/no-{name} ]
"""
        )
        program.chmod(0o755)
    place.notes.mkdir()
    place.lock("course").parent.mkdir(parents=True)
    place.lock("course").write_text("setuptools==1 \\\n    --hash=sha256:aa\n")
    log = (tmp_path / "log.txt").open("w")
    return Setup(place, Ros("wheels"), {"PATH": "/usr/bin:/bin"}, log, said.append), said, called


def test_uv_installs_with_hashes_from_where_pip_would(calls: tuple[Setup, list[str], Path]) -> None:
    setup, said, called = calls
    setup._install_packages([setup.place.lock("course")])
    lines = called.read_text().splitlines()
    assert [line.partition(" ")[0] for line in lines] == ["uv", "uv"]
    for line in lines:
        for option in (
            "--require-hashes",
            "index=https://one.example/simple",
            "--compile-bytecode",
        ):
            assert option in line
    assert said == []
    assert "one.example" not in Path(setup.log.name).read_text(), "an address may contain a password"


def test_where_uv_cannot_pip_installs_the_same_and_it_is_said(calls: tuple[Setup, list[str], Path]) -> None:
    setup, said, called = calls
    (setup.place.root / "no-uv").touch()
    setup._install_packages([setup.place.lock("course")])
    assert [line.partition(" ")[0] for line in called.read_text().splitlines()] == ["uv", "python", "python"]
    assert "--require-hashes" in called.read_text().splitlines()[-1]
    assert said == ["uv could not install the packages: pip tries, which takes longer"]


def test_a_uv_that_cannot_be_had_is_no_failure(calls: tuple[Setup, list[str], Path]) -> None:
    setup, said, called = calls
    (setup.place.root / "no-python").touch()
    setup._get_uv()
    assert said == ["uv cannot be had here: pip installs the packages, which takes longer"]
    (setup.place.prefix / "bin/uv").unlink()
    with pytest.raises(SetupError, match="installing packages failed"):
        setup._install_packages([setup.place.lock("course")])
    assert "uv " not in {line[:3] for line in called.read_text().splitlines()}


# What is looked at before anything is done.


def test_a_folder_called_venv_that_is_none_is_not_touched(tmp_path: Path) -> None:
    (tmp_path / ".venv").mkdir()
    (tmp_path / ".venv/thesis.txt").write_text("mine")
    with pytest.raises(SetupError, match="Move it away"):
        bootstrap._check_place(Place(tmp_path, Path("/usr/bin/python3.11")))
    assert (tmp_path / ".venv/thesis.txt").read_text() == "mine"


def test_a_folder_with_a_colon_in_its_name_is_refused(tmp_path: Path) -> None:
    root = tmp_path / "course:1"
    root.mkdir()
    with pytest.raises(SetupError, match="colon"):
        bootstrap._check_place(Place(root, Path("/usr/bin/python3.11")))


def test_a_space_in_the_path_is_said(tmp_path: Path) -> None:
    python = Path("/usr/bin/python3.11")
    assert "will not start" in Place(tmp_path / "my course", python).warning
    assert Place(Path("/home/me/course"), python).warning == ""


def test_a_disk_without_room_is_said_before_anything_is_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bootstrap, "_SPACE_NEEDED", 10**18)
    with pytest.raises(SetupError, match="GB left"):
        bootstrap._check_space(Place(tmp_path, Path("/usr/bin/python3.11")))


@pytest.mark.parametrize(
    ("line", "said"), cases(__file__, "a_failure_shows_the_end_of_the_log_and_the_usual_cause")
)
def test_a_failure_shows_the_end_of_the_log_and_the_usual_cause(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], line: str, said: str
) -> None:
    log = tmp_path / "setup.log"
    log.write_text("\n".join([*(f"line {number}" for number in range(100)), "x" * 5000, line]) + "\n")
    bootstrap._explain_failure(log)
    shown = capsys.readouterr().err
    assert line in shown
    assert "line 10\n" not in shown
    assert max(len(shown_line) for shown_line in shown.splitlines()) < 300
    assert said.lower() in shown.lower()


def test_a_set_up_without_a_network_installs_from_the_folder_alone(tmp_path: Path) -> None:
    assert bootstrap.without_network(None) == {}
    variables = bootstrap.without_network(tmp_path)
    assert (variables["PIP_NO_INDEX"], variables["PIP_FIND_LINKS"]) == ("1", str(tmp_path))
    with pytest.raises(SetupError, match=r"environment\.lock --wheels FOLDER` fills one"):
        bootstrap.without_network(tmp_path / "none")


def test_uv_is_given_no_option_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The project is installed without an index, and pip may be told that there is none anyway."""
    setup = Setup(Place(tmp_path, Path(sys.executable)), Ros("wheels"), {}, io.StringIO())
    asked: list[list[str]] = []
    listed = subprocess.CompletedProcess([], 0, stdout=":env:.no-index='1'\n")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: listed)
    monkeypatch.setattr(
        Setup, "_run", lambda _self, _what, command, *_: asked.append(list(map(str, command)))
    )
    setup._uv("--no-index", "--editable", "here")
    assert asked[0].count("--no-index") == 1
