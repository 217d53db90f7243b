"""What a box can see and touch, and what not: asked from inside, by a notebook in a box and by a command."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from autograder import course
from autograder.boxes import visible_host
from autograder.boxes.run_limits import Limits
from autograder.boxes.sandbox import Enclosure
from autograder.boxes.visible_host import Bind, installation
from autograder.execution.executed_cells import Cell
from autograder.execution.notebook_processes import BoxedProcesses, NotebookSetting
from autograder.execution.notebook_runner import run_notebook
from autograder.messages.judge_messages import SOCKET_VARIABLE
from autograder.safe_files import scratch_folder
from autograder.standard_output import collect
from course_runtime import ros_flavour
from course_runtime.place import Place
from course_runtime.ros_flavour import Ros
from tests.boxes.fork_servers import SilentJudge
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.boxes.fork_server import Addresses

Ask = Callable[[str], Any]


@pytest.fixture(params=["the kernel", "a command"])
def ask(request: pytest.FixtureRequest, tmp_path: Path, boxed: Addresses) -> Ask:
    """Runs Python code in a box; the answer is what it leaves in ``answer``."""
    source = "import ctypes, errno, json, os, pathlib, socket, subprocess, sys\n{code}\nprint('>' + json.dumps(answer))"

    def kernel(code: str) -> Any:
        limits = Limits(cell_seconds=30)
        with (
            scratch_folder(tmp_path) as folder,
            BoxedProcesses(boxed, NotebookSetting(folder, limits, {"data/a.txt": b"hello"})) as place,
        ):
            run = run_notebook(
                [Cell(source.format(code=code))],
                judge=contextlib.nullcontext(SilentJudge()),
                processes=place,
            ).cells[0]
        return answer("".join(output.get("text", "") for output in run.outputs) or run.error)

    def command(code: str) -> Any:
        with (
            scratch_folder(tmp_path) as folder,
            Enclosure(boxed.supervisors, folder / "box", files={"data/a.txt": b"hello"}) as enclosure,
        ):
            done = enclosure.run(["python", "-c", source.format(code=code)], limit=30.0)
        return answer(done.output.decode())

    def answer(said: str) -> Any:
        line = next((line for line in said.splitlines() if line.startswith(">")), None)
        assert line is not None, said
        return json.loads(line[1:])

    return kernel if request.param == "the kernel" else command


def test_its_own_files_and_the_notebooks(ask: Ask) -> None:
    code = (
        "answer = [pathlib.Path('data/a.txt').read_text(), os.getcwd(), os.environ['HOME'], os.getuid() != 0]"
    )
    assert ask(code) == ["hello", "/home/student/notebook", "/home/student", True]


def test_nothing_of_the_hosts_files(ask: Ask, tmp_path: Path) -> None:
    (tmp_path / "gradebook.db").write_text("points")
    root = course.root()
    secret = [
        root / "solutions",
        root / "tests",
        root / ".git",
        root / "pyproject.toml",
        tmp_path,
        Path.home() / ".bashrc",
    ]
    names = [str(path) for path in secret if path.exists()]
    assert ask(f"answer = [name for name in {names!r} if os.path.exists(name)]") == []
    # A course that was cloned into /tmp is seen there, as far as it is seen at all.
    assert set(ask("answer = os.listdir('/home') + os.listdir('/tmp')")) <= {"student", *root.parts}


def test_only_the_installation_below_a_home_folder(ask: Ask) -> None:
    home = str(Path.home())
    code = (
        f"answer = [os.path.join(folder, name) for folder, _, names in os.walk({home!r}, onerror=None)"
        f" for name in names if not any(folder.startswith(root) for root in {[str(p) for p in installation()]!r})]"
    )
    assert ask(code) == []


def test_nothing_but_the_scratch_can_be_written(ask: Ask) -> None:
    code = cases(__file__, "nothing_but_the_scratch_can_be_written")
    writable = ask(code)
    # An empty entry of sys.path is the notebook's own folder; mtrr is hidden by what takes anything and keeps nothing.
    assert [name for name in writable if name not in ("", "mtrr")] == []


def test_no_variable_of_the_host(ask: Ask) -> None:
    known = (SOCKET_VARIABLE, *cases(__file__, "variables_of_a_box"))
    texts = "[path.read_text() for path in pathlib.Path('/proc').glob('[0-9]*/environ')]"
    for code in ("answer = sorted(os.environ)", f"answer = chr(0).join({texts}).split(chr(0))"):
        assert [name for name in ask(code) if name and not name.startswith(known)] == []


def test_no_other_process(ask: Ask, tmp_path: Path) -> None:
    code = "answer = [open(f'/proc/{pid}/cmdline').read() for pid in os.listdir('/proc') if pid.isdecimal()]"
    lines = ask(code)
    assert 1 <= len(lines) <= 4
    assert not [line for line in lines if str(tmp_path) in line]


def test_no_open_file_of_the_host(ask: Ask) -> None:
    code = cases(__file__, "no_open_file_of_the_host")
    mine = ("socket:", "pipe:", "anon_inode:", "/dev/null", "/dev/urandom", "/proc/", "/dev/shm/")
    links = ask(code)
    assert [link for link in links if not link.startswith(mine)] == []
    # A pidfd would be a way out of the box.
    assert [link for link in links if "pidfd" in link] == []


def test_no_network_but_its_own_loopback(ask: Ask) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        code = f"""
answer = []
for address in [("127.0.0.1", {port}), ("10.0.0.1", 80), ("1.1.1.1", 53)]:
    with socket.socket() as s:
        s.settimeout(2)
        answer.append(s.connect_ex(address))
answer.append(sorted(name for _, name in socket.if_nameindex()))
"""
        *refused, interfaces = ask(code)
    assert 0 not in refused
    assert interfaces == ["lo"]


def test_no_abstract_socket_of_the_host(ask: Ask) -> None:
    name = f"\0autograder-test-{os.getpid()}"
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(name)
        server.listen()
        code = f"s = socket.socket(socket.AF_UNIX); answer = s.connect_ex({name!r})"
        assert ask(code) != 0


def test_no_host_of_a_virtual_machine(ask: Ask) -> None:
    code = cases(__file__, "no_host_of_a_virtual_machine")
    assert ask(code) == []


def test_no_right_at_all(ask: Ask) -> None:
    code = "answer = dict(line.split(':', 1) for line in open('/proc/self/status').read().splitlines())"
    status = {name: value.strip() for name, value in ask(code).items()}
    for kind in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb"):
        assert int(status[kind], 16) == 0, kind
    assert status["NoNewPrivs"] == "1"
    assert status["Seccomp"] == "2"


@pytest.mark.skipif(os.uname().machine != "x86_64", reason="the numbers are those of x86_64")
def test_calls_that_are_refused(ask: Ask) -> None:
    calls = cases(__file__, "calls_that_are_refused")
    asked = "".join(f"answer.append([{call}, ctypes.get_errno()])\n" for call in calls)
    said = ask(f"libc = ctypes.CDLL(None, use_errno=True)\nanswer = []\n{asked}")
    refused = [-1, errno.EPERM], [-1, errno.ENOSYS]
    assert [call for call, answer in zip(calls, said, strict=True) if answer not in refused] == []


def test_what_honest_programs_need_is_there(ask: Ask) -> None:
    code = cases(__file__, "what_honest_programs_need_is_there")
    assert ask(code) == [1, 3, 0, True, [1, 2], True, True]


def test_what_honest_programs_say_of_descriptors_and_files(ask: Ask) -> None:
    code = cases(__file__, "what_honest_programs_say_of_descriptors_and_files")
    assert ask(code) == [True, False, 0, 1, True, True]


@pytest.fixture
def sourced(tmp_path: Path) -> dict[str, str]:
    """The variables of a terminal in which a ROS, and on top of it a workspace, is sourced."""
    ros, workspace = tmp_path / "opt" / "jazzy", tmp_path / "home" / "ros2_ws" / "install" / "my_robot_pkg"
    (ros / "share" / "rclpy").mkdir(parents=True)
    (ros / "share" / "rclpy" / "package.xml").touch()
    for prefix in (ros, workspace):
        (prefix / "share" / "ament_index").mkdir(parents=True)
        (prefix / "lib" / "site-packages").mkdir(parents=True)
    return {
        "AMENT_PREFIX_PATH": f"{workspace}:{ros}",
        "LD_LIBRARY_PATH": f"{workspace}/lib:{ros}/lib/x86_64-linux-gnu",
        "PATH": f"{workspace}/bin:/usr/bin:{tmp_path}/home/bin:.",
        "PYTHONPATH": f"{workspace}/lib/site-packages",
        "LMS_API_TOKEN": "planted",
        "ROS_PASSWORD": "planted",
        "LC_PASSWORD": "planted",
    }


@pytest.mark.parametrize(
    ("recorded", "seen"), [(None, "opt/jazzy"), (Ros("wheels"), ""), (Ros("system", {}), "")]
)
def test_a_sourced_ros_is_part_of_the_installation_and_a_workspace_is_not(
    tmp_path: Path, sourced: dict[str, str], monkeypatch: pytest.MonkeyPatch, recorded: Ros | None, seen: str
) -> None:
    monkeypatch.setattr(ros_flavour, "load", lambda _: recorded)
    found = [path for path in visible_host._installation(sourced) if path.is_relative_to(tmp_path)]
    assert found == [tmp_path / seen] * bool(seen)
    got = visible_host.box_environment(given=sourced)
    named = {entry for value in got.values() for entry in value.split(":") if str(tmp_path) in entry}
    assert named == ({f"{tmp_path}/{seen}", f"{tmp_path}/{seen}/lib/x86_64-linux-gnu"} if seen else set())
    assert got["PATH"] == "/usr/bin"
    assert "planted" not in got.values()


def test_a_workspace_that_the_class_names_is_seen(tmp_path: Path, sourced: dict[str, str]) -> None:
    workspace = tmp_path / "home/ros2_ws/install/my_robot_pkg"
    variables = {**sourced, visible_host.OVERLAYS: str(workspace)}
    assert workspace in visible_host._installation(variables)
    got = visible_host.box_environment(given=variables)
    assert got["PYTHONPATH"] == sourced["PYTHONPATH"]
    assert visible_host.OVERLAYS not in got


def test_of_an_environment_only_the_listed_parts_are_seen(ask: Ask) -> None:
    hidden = [path for path in Path(sys.prefix).iterdir() if path.name in ("course", "pip.conf", ".lock")]
    assert Path(sys.prefix, "course") in hidden
    names = [str(path) for path in hidden]
    assert ask(f"answer = [name for name in {names!r} if os.path.exists(name)]") == []
    assert ask("answer = [os.path.exists(os.path.join(sys.prefix, 'pyvenv.cfg')), sys.prefix]") == [
        True,
        sys.prefix,
    ]


def test_the_lock_of_the_set_up_is_out_of_sight() -> None:
    """A folder can be locked by whoever may read it, and a student's lock would keep everybody's set-up waiting."""
    locked = Place(course.root(), Path(sys.executable)).locked
    assert [seen for seen in installation() if locked.is_relative_to(seen)] == []


@pytest.fixture
def enclosure(tmp_path: Path, boxed: Addresses) -> Iterator[Enclosure]:
    with scratch_folder(tmp_path) as folder, Enclosure(boxed.supervisors, folder / "box") as made:
        yield made


def test_a_commands_end_and_output(enclosure: Enclosure) -> None:
    done = enclosure.run(["sh", "-c", "echo out; echo err >&2; exit 7"], limit=10.0)
    assert (done.returncode, done.output, done.cut) == (7, b"out\nerr\n", False)
    assert enclosure.run(["sh", "-c", "kill -9 $$"], limit=10.0).returncode == -9


def test_a_command_at_its_limit_and_its_daemons(enclosure: Enclosure) -> None:
    sleep = f"sleep 987.{os.getpid()}"  # another run of the tests beside this one has sleepers, too
    done = enclosure.run(["sh", "-c", f"setsid {sleep} & {sleep}"], limit=0.5)
    assert done.returncode is None
    assert subprocess.run(["pgrep", "-f", sleep], stdout=subprocess.PIPE).stdout == b""


def test_a_bind_shows_a_folder_and_protects_it(enclosure: Enclosure, tmp_path: Path) -> None:
    (tmp_path / "given").mkdir()
    (tmp_path / "given" / "file").write_text("text")
    binds = [Bind(tmp_path / "given", Path("/given"))]
    done = enclosure.run(["sh", "-c", "cat /given/file; echo x > /given/file"], limit=10.0, binds=binds)
    assert done.output.startswith(b"text")
    assert done.returncode != 0
    assert (tmp_path / "given" / "file").read_text() == "text"


def test_a_command_whose_box_cannot_be_made_says_why_and_its_ctrl_c_reaches_nobody(
    enclosure: Enclosure,
) -> None:
    """bubblewrap has ended before it could say which process is the first: 0 would be a process group, its killer's."""

    class Nonsense(Bind):
        def arguments(self) -> list[str]:
            return ["--no-such-option"]

    with enclosure.start(["true"], binds=[Nonsense(Path("/"))]) as running:
        running.interrupt()
        assert b"--no-such-option" in collect(running, 10.0, 1000).output
        assert running.exit_code() != 0
    assert enclosure.run(["true"], limit=10.0).returncode == 0


def test_boxes_of_one_submission_share_a_network_and_others_do_not(
    tmp_path: Path, boxed: Addresses, enclosure: Enclosure
) -> None:
    serve = (
        "import socket; s = socket.create_server(('127.0.0.1', 4242)); print('up', flush=True); s.accept()"
    )
    knock = ["python", "-c", "import socket; socket.create_connection(('127.0.0.1', 4242), 5)"]
    with (
        Enclosure(boxed.supervisors, tmp_path / "neighbour") as neighbour,
        enclosure.start(["python", "-c", serve]) as server,
    ):
        assert server.read(10.0) == b"up\n"
        assert neighbour.run(knock, limit=10.0).returncode != 0
        assert enclosure.run(knock, limit=10.0).returncode == 0
