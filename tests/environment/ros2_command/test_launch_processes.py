"""`ros2 launch` with real processes: its words, Ctrl-C, crashes, timers and handlers."""

from __future__ import annotations

import re
import signal
import textwrap
import time
from typing import TYPE_CHECKING, Any

import pytest

from tests.cases import cases, named_cases

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable
    from pathlib import Path

    from conftest import Running

    Ros2 = Callable[..., subprocess.CompletedProcess[str]]
    Start = Callable[..., Running]

HEAD = cases(__file__, "HEAD")


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], str]:
    """Write a Python launch file with these actions, and return its path."""

    def make(actions: str) -> str:
        path = tmp_path / "test.launch.py"
        path.write_text(HEAD + textwrap.indent(textwrap.dedent(actions), " " * 8) + "\n    ])\n")
        return str(path)

    return make


def shape(text: str) -> list[str]:
    """Return lines of output with what differs between two runs left out."""
    text = re.sub(r"pid \[?\d+", lambda m: re.sub(r"\d+", "N", m[0]), text)
    return re.sub(r"below \S+", "below DIR", text).splitlines()


def gone(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:  # noqa: PTH123
            # A process that nobody has waited for yet is gone as well.
            return file.read().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


def wait_until_gone(pid: int) -> None:
    deadline = time.monotonic() + 20
    while not gone(pid):
        assert time.monotonic() < deadline, f"process {pid} is still there"
        time.sleep(0.01)


@pytest.mark.parametrize("case", named_cases(__file__, "what_a_launch_says"))
def test_what_a_launch_says(ros2: Ros2, write: Callable[[str], str], case: dict[str, Any]) -> None:
    done = ros2("launch", *case.get("words", ()), write(case["actions"]))
    lines = shape(done.stdout)
    told = tuple(line for line in lines if case.get("of", "") in line)
    assert told == case.get("lines", told)
    assert [text for text in case.get("shows", ()) if text not in "\n".join([*lines, ""])] == []
    hidden = (*case.get("hides", ()), "Traceback" if "code" in case else "no such text")
    assert [text for text in hidden if text in done.stdout + done.stderr] == []
    assert done.returncode == case.get("code", 0)


def test_the_log_has_what_is_said(ros2: Ros2, write: Callable[[str], str], tmp_path: Path) -> None:
    ros2("launch", write("LogInfo(msg='x')"))
    log = (tmp_path / "ros_log/latest/launch.log").read_text()
    assert re.search(r"^\d+\.\d{7} \[INFO\] \[launch.user\]: x$", log, re.MULTILINE)


@pytest.mark.parametrize("name", ["/tmp/none.launch.py", "*.py", ""])
def test_a_file_that_its_package_has_not_is_said_so(ros2: Ros2, name: str) -> None:
    done = ros2("launch", "demo_pkg", name)
    assert f"file '{name}' was not found in the share directory of package 'demo_pkg'" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("actions", "ready", "signals", "code", "says"), named_cases(__file__, "a_signal_ends_every_process")
)
def test_a_signal_ends_every_process(
    start: Start,
    write: Callable[[str], str],
    actions: str,
    ready: tuple[str, ...],
    signals: tuple[tuple[str, str], ...],
    code: int,
    says: tuple[str, ...],
) -> None:
    running = start("launch", write(actions))
    lines = [running.wait_for(text) for text in ready]
    for name, answer in signals:
        running.send(signal.Signals[name])
        running.wait_for(answer)
    assert running.end() == code
    text = "\n".join(shape(running.text))
    assert [said for said in says if said not in text] == []
    pids = [line.rpartition("[")[2].rstrip("]") for line in lines if "started with pid" in line]
    assert all(gone(int(pid)) for pid in pids)


def test_even_a_killed_launch_leaves_nothing_behind(start: Start, write: Callable[[str], str]) -> None:
    running = start("launch", write("ExecuteProcess(cmd=['sleep', '100']),"))
    line = running.wait_for("[sleep-1]: process started with pid [")
    running.send(signal.SIGKILL)
    running.process.wait(20)
    wait_until_gone(int(line.rpartition("[")[2].rstrip("]")))


def test_ctrl_c_reaches_what_a_process_has_started(start: Start, write: Callable[[str], str]) -> None:
    command = "['sh', '-c', 'sleep 100 & echo inner $!; wait']"
    running = start("launch", write(f"ExecuteProcess(cmd={command}, output='screen'),"))
    inner = int(running.wait_for("inner").split()[-1])
    running.send(signal.SIGINT)
    running.end()
    wait_until_gone(inner)


def test_arguments_of_a_launch_file(ros2: Ros2, write: Callable[[str], str]) -> None:
    path = write(
        """
        DeclareLaunchArgument('rate', default_value='2', description='messages in a second'),
        DeclareLaunchArgument('mode', choices=['a', 'b'], default_value=['a'], description='how'),
        GroupAction([DeclareLaunchArgument('more', default_value=LaunchConfiguration('rate'))]),
        LogInfo(msg=['rate ', LaunchConfiguration('rate')]),
        """
    )
    assert ros2("launch", path, "--show-args").stdout == textwrap.dedent(
        """\
        Arguments (pass arguments as '<name>:=<value>'):

            'rate':
                messages in a second
                (default: '2')

            'mode':
                how. Valid choices are: ['a', 'b']
                (default: 'a')

            'more':
                no description given
                (default: LaunchConfig('rate'))
        """
    )
    assert "rate 5" in ros2("launch", path, "rate:=4", "rate:=5").stdout
    assert "is not valid" in ros2("launch", path, "mode:=c").stdout
    wrong = ros2("launch", path, "rate=5")
    assert wrong.stderr == "malformed launch argument 'rate=5', expected format '<name>:=<value>'\n"
    assert wrong.returncode == 1


def test_a_launch_file_of_a_package(ros2: Ros2, prefix: Path) -> None:
    folder = prefix / "share/demo_pkg/launch"
    (folder / "one.launch.xml").write_text(
        '<launch><arg name="who" default="you"/><log message="$(dirname) $(var who)"/></launch>'
    )
    done = ros2("launch", "demo_pkg", "one.launch.xml", "who:=me")
    assert f"[INFO] [launch.user]: {folder} me" in done.stdout
    missing = ros2("launch", "demo_pkg", "two.launch.xml")
    assert missing.stderr.startswith("file 'two.launch.xml' was not found in the share directory of package")
    assert missing.returncode == 1
    assert ros2("launch", "no_such_pkg", "x.launch.py").stderr.startswith("Package 'no_such_pkg' not found: ")


def test_files_include_each_other(ros2: Ros2, tmp_path: Path) -> None:
    (tmp_path / "inner.launch.py").write_text(
        HEAD
        + "DeclareLaunchArgument('who'),"
        + "LogInfo(msg=['py ', ThisLaunchFileDir(), LaunchConfiguration('who')])])"
    )
    (tmp_path / "middle.launch.yaml").write_text(
        "launch:\n- arg: {name: who}\n- include:\n    file: $(dirname)/inner.launch.py\n"
        "    arg:\n    - {name: who, value: $(var who)!}\n- log: {message: yaml $(var who)}\n"
    )
    (tmp_path / "outer.launch.xml").write_text(
        '<launch><group><include file="$(dirname)/middle.launch.yaml">'
        '<arg name="who" value="ada"/></include></group>'
        '<log message="xml $(var who nobody)"/></launch>'
    )
    text = ros2("launch", str(tmp_path / "outer.launch.xml")).stdout
    said = [
        line.removeprefix("[INFO] [launch.user]: ") for line in text.splitlines() if "launch.user" in line
    ]
    # What an included file sets is known to what follows, up to the end of the group.
    assert said == [f"py {tmp_path}ada!", "yaml ada!", "xml nobody"]
    assert "'who'" in ros2("launch", "--show-args", str(tmp_path / "middle.launch.yaml")).stdout


@pytest.mark.parametrize("given", [True, False])
def test_a_file_included_in_a_group_asks_its_include_for_its_arguments(
    given: bool, ros2: Ros2, write: Callable[[str], str], tmp_path: Path
) -> None:
    inner = tmp_path / "inner.launch.xml"
    inner.write_text('<launch><arg name="who"/><log message="here is $(var who)"/></launch>')
    arguments = ", launch_arguments=[('who', 'ada')]" if given else ""
    done = ros2("launch", write(f"GroupAction([IncludeLaunchDescription({str(inner)!r}{arguments})]),"))
    assert ("here is ada" in done.stdout) == given
    assert ("missing required argument 'who'" in done.stdout + done.stderr) == (not given)


def test_the_service_leaves_signals_as_they_were(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from launch import LaunchDescription, LaunchService
    from launch.actions import ExecuteProcess

    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD)]
    service = LaunchService()
    service.include_launch_description(
        LaunchDescription([ExecuteProcess(cmd=["echo", "in"], output="screen")])
    )
    assert service.run() == 0
    assert "[echo-1] in" in capsys.readouterr().out
    assert [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD)] == before


def test_a_log_folder_that_can_not_be_made_is_named(
    ros2: Ros2, write: Callable[[str], str], tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    done = ros2("launch", write("LogInfo(msg='x'),"), ROS_LOG_DIR=str(tmp_path / "file"))
    assert "set ROS_LOG_DIR to a folder that can be written" in done.stderr
    assert done.returncode == 1
