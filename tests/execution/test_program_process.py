"""Students' programs from the fork server: nobody can tell them from those that `ros2 run` starts."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import subprocess
import sys
import time
import zipapp
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest

from autograder.boxes import boxed_processes
from autograder.boxes.sandbox import Enclosure
from autograder.boxes.visible_host import HOME, Bind, box_environment
from autograder.judge.ros_setup import boxed_ros_environment
from autograder.workspaces.program_plans import ros2
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from autograder.boxes.boxed_processes import Running, WarmCommand
    from autograder.boxes.fork_server import Addresses

PACKAGE = "some_pkg"
READY = "ready"
"""A program that says this gets a Ctrl-C."""

PROGRAMS = cases(__file__, "PROGRAMS")
"""The programs by name; what they show is that name."""
UNEQUAL = re.compile(
    r"\[\d+\.\d+\]"  # the time of a log line
    r"|0x[0-9a-f]+"
    r"|(?m:^(?:Extension modules: |Current thread's C stack|  Binary file |  <truncated rest ).*\n)"
    # A crash shows the calls that a fork began with, after the program's own.
    r'|  File "(?:[^"]*/(?:autograder/(?:boxes|execution)|course_runtime/ros2_command)/[^"]*|<frozen runpy>)", .*\n'
    r'|  File "[^"]*/bin/ros2", .*\n'
)


MET_BY_CHANCE = re.compile(
    r"Traceback \(most recent call last\):\n(?:(?!Traceback).*\n)*?"
    r"(?m:^During handling of the above exception, another exception occurred:\n)"
)
"""The exception that was being handled just when Ctrl-C came."""


def comparable(text: str) -> list[str]:
    """The lines that must be equal; the line at which Ctrl-C met a program is chance."""
    text = UNEQUAL.sub("", text)
    if READY not in text:
        return [line for line in text.splitlines() if line]
    lines = MET_BY_CHANCE.sub("", text).splitlines()
    return [line for line in lines if line and not line.startswith(" ")]


@dataclass(frozen=True)
class Run:
    output: str
    code: int | None


@pytest.fixture
def enclosure(boxed: Addresses, tmp_path: Path) -> Iterator[Enclosure]:
    with Enclosure(boxed.supervisors, tmp_path / "enclosure") as made:
        yield made


@pytest.fixture
def start(enclosure: Enclosure, tmp_path: Path, boxed: Addresses) -> Callable[..., Running | WarmCommand]:
    """Starts a program of the package, from the fork server unless it is to be cold."""
    install = tmp_path / "install"
    folder = install / "lib" / PACKAGE
    folder.mkdir(parents=True)
    marker = install / "share/ament_index/resource_index/packages" / PACKAGE
    marker.parent.mkdir(parents=True)
    marker.touch()
    place = HOME / "install"
    of_the_class = {"LANG": "C.UTF-8", "PYTHONUNBUFFERED": "1", "PYTHONFAULTHANDLER": "1"}
    environment = box_environment(
        {**boxed_ros_environment(), **of_the_class, "AMENT_PREFIX_PATH": str(place)}
    )

    def start(name: str, text: str | bytes, *, cold: bool = False, **more: str) -> Running | WarmCommand:
        program = folder / name
        program.write_bytes(text if isinstance(text, bytes) else f"#!{sys.executable}\n{text}\n".encode())
        program.chmod(0o755)
        words, binds = ["run", PACKAGE, name, "one", "--two"], [Bind(install, place)]
        variables = {**environment, **more}
        if cold:
            return enclosure.start(
                [ros2(), *words], binds=binds, environment=variables, cwd=HOME, scratch=False
            )
        return enclosure.ros2(boxed.programs, words, binds=binds, environment=variables, cwd=HOME)

    return start


def end_of(running: Running | WarmCommand) -> Run:
    output, asked = b"", False
    deadline = time.monotonic() + 60.0
    while (data := running.read(30.0)) != b"":
        assert time.monotonic() < deadline, "it says more and more, and does not end"
        assert data is not None, f"it says no more than {output!r} and does not end: {_states(running.pid)}"
        output += data
        if f"{READY}\n".encode() in output and not asked:
            running.interrupt()
            asked = True
    code = running.exit_code()
    running.end()
    return Run(output.decode(), code)


def library(tmp_path: Path, name: str) -> None:
    """A library in the package's folder that answers 42."""
    source = tmp_path / "own.c"
    source.write_text("int answer(void) { return 42; }\n")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", tmp_path / "install" / name, source], check=True)


def libraries_in(*folders: object) -> dict[str, str]:
    """The variable that says so, before what every box has."""
    given = box_environment().get("LD_LIBRARY_PATH", "")
    return {"LD_LIBRARY_PATH": os.pathsep.join([*map(str, folders), *([given] if given else [])])}


@pytest.mark.parametrize("name", PROGRAMS)
def test_it_is_as_ros2_run_starts_it(
    start: Callable[..., Running | WarmCommand], tmp_path: Path, name: str
) -> None:
    if name == "has_a_module_of_its_own":
        (tmp_path / "install" / "lib" / PACKAGE / "random.py").write_text("MINE = 1\n")
    cold = end_of(start(name, PROGRAMS[name], cold=True))
    warm = end_of(start(name, PROGRAMS[name]))
    assert comparable(warm.output) == comparable(cold.output)
    assert warm.code == cold.code


def test_it_finds_rclpy_imported(start: Callable[..., Running | WarmCommand]) -> None:
    assert end_of(start("a", "import sys; print('rclpy' in sys.modules)")) == Run("True\n", 0)


def test_it_may_be_an_archive(start: Callable[..., Running | WarmCommand], tmp_path: Path) -> None:
    (tmp_path / "archived").mkdir()
    (tmp_path / "archived" / "__main__.py").write_text("print('archived')\n")
    zipapp.create_archive(tmp_path / "archived", tmp_path / "archive", interpreter=sys.executable)
    assert end_of(start("an_archive", (tmp_path / "archive").read_bytes())) == Run("archived\n", 0)


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_it_may_have_libraries_of_its_own(
    start: Callable[..., Running | WarmCommand], tmp_path: Path
) -> None:
    """A workspace with a package in C or C++ has them, and a new process is told where."""
    library(tmp_path, "libown.so")
    running = start(
        "a",
        "import ctypes, sys; print(ctypes.CDLL('libown.so').answer(), 'rclpy' in sys.modules)",
        **libraries_in(HOME / "install"),
    )
    assert end_of(running) == Run("42 True\n", 0)


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("name", ["librcl.so", "libstd_msgs__rosidl_generator_c.so.1"])
def test_a_library_of_its_own_comes_before_one_of_the_same_name(
    start: Callable[..., Running | WarmCommand], tmp_path: Path, name: str
) -> None:
    library(tmp_path, name)
    running = start(
        "a", f"import ctypes; print(ctypes.CDLL('{name}').answer())", **libraries_in(HOME / "install")
    )
    assert end_of(running) == Run("42\n", 0)


@pytest.mark.parametrize(
    "folders",
    [[HOME / f"none-{n}" for n in range(20)], [HOME / "none", ""], ["", HOME / "none"]],
    ids=["many", "here_last", "here_first"],
)
def test_it_is_told_where_its_libraries_are(
    start: Callable[..., Running | WarmCommand], folders: list[object]
) -> None:
    """However they are written: what a fork cannot follow becomes a new process."""
    text, path = "import os; print(os.environ['LD_LIBRARY_PATH'])", libraries_in(*folders)
    assert end_of(start("a", text, **path)) == end_of(start("a", text, cold=True, **path))


def test_it_cannot_close_its_output_and_stay(
    start: Callable[..., Running | WarmCommand], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A `ros2` on the path is a real one, and so is a student's: then the first process is theirs as well."""
    monkeypatch.setattr(boxed_processes, "_CLOSING_SECONDS", 0.5)
    theirs = tmp_path / "install" / "bin" / "ros2"
    theirs.parent.mkdir()
    theirs.write_text(f"#!{sys.executable}\nimport os, time\nos.closerange(0, 9)\ntime.sleep(600)\n")
    theirs.chmod(0o755)
    running = start("a", "", PATH=str(HOME / "install" / "bin"))
    assert end_of(running) == Run("", -9)


@pytest.mark.parametrize(
    "attack",
    [
        "import os, signal; os.kill(os.getppid(), signal.SIGKILL)",
        "import os, signal; os.kill(-1, signal.SIGKILL)",
        "import os\nif not os.fork():\n    os.setsid()\n    os.closerange(0, 3)\n    while True: pass",
        "import os\nif not os.fork():\n    while True: os.write(1, b'x' * 60_000)",
        "import rclpy, sys\nrclpy.init = print\nsys.modules['json'] = None\n",
        "import socket\nfor n in range(3, 50):\n    try:\n        socket.socket(fileno=n).shutdown(2)\n"
        "    except OSError:\n        pass",
    ],
    ids=["kills_its_parent", "kills_all", "stays", "talks_on", "replaces_modules", "shuts_every_socket"],
)
def test_it_does_nothing_to_the_next_one(start: Callable[..., Running | WarmCommand], attack: str) -> None:
    running = start("attack", attack)
    end_of(running)
    assert not list(_members(running.pid)), "nothing of its box is alive"
    following = start("next", "import json, rclpy; rclpy.init(); print('well'); rclpy.shutdown()")
    assert end_of(following) == Run("well\n", 0)


def _members(first: int) -> Iterator[int]:
    """The processes of the box that began with a process, as far as they live."""
    from pathlib import Path

    try:
        yield from (int(p.name) for p in Path(f"/proc/{first}/root/proc").iterdir() if p.name.isdecimal())
    except OSError:
        return


def _states(first: int) -> dict[str, str]:
    """What the living processes of the box do, and which signals wait for them or have a handler, by command line."""
    from pathlib import Path

    place, states = Path(f"/proc/{first}/root/proc"), {}
    for process in _members(first):
        with contextlib.suppress(OSError):
            words = (place / f"{process}/cmdline").read_bytes().replace(b"\0", b" ").decode()
            lines = (place / f"{process}/status").read_text().splitlines()
            shown = [
                line for line in lines if line.startswith(("State", "SigPnd", "ShdPnd", "SigIgn", "SigCgt"))
            ]
            states[f"{process}: {words}"] = ", ".join(shown)
    return states
