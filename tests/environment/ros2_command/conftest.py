"""A small ROS package to work with, and a way to call `ros2` as a user does."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.judge.ros_setup import lease_domain
from course_runtime.ros2_command.install import LAUNCH_FRONT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

if importlib.util.find_spec("launch") is None:
    sys.path.append(str(LAUNCH_FRONT))

ROOT = Path(__file__).resolve().parents[3]
NODES = Path(__file__).with_name("nodes")
LONGEST = 180.0  # seconds; only a failing test ever waits so long


class Running:
    """A process whose output is read while it runs."""

    def __init__(self, command: list[str], env: dict[str, str], cwd: Path) -> None:
        self.process = subprocess.Popen(
            command,
            env=env,
            cwd=cwd,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        self.lines: list[str] = []
        self._news = threading.Condition()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            with self._news:
                self.lines.append(line.rstrip("\n"))
                self._news.notify_all()
        with self._news:
            self._news.notify_all()

    @property
    def text(self) -> str:
        return "\n".join(self.lines)

    def wait_for(self, text: str) -> str:
        """Wait until a line with this text was printed, and return it."""
        with self._news:
            deadline = time.monotonic() + LONGEST
            while True:
                for line in self.lines:
                    if text in line:
                        return line
                left = deadline - time.monotonic()
                if left <= 0 or not self._reader.is_alive():
                    pytest.fail(f"'{text}' was never printed; there was:\n{self.text}")
                self._news.wait(min(left, 0.2))

    def send(self, number: signal.Signals) -> None:
        self.process.send_signal(number)

    def end(self) -> int:
        """Wait for the end and for all output, and return the exit code."""
        code = self.process.wait(LONGEST)
        self._reader.join(LONGEST)
        return code

    def kill(self) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait(LONGEST)


@pytest.fixture(scope="session")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An install folder with the package `demo_pkg`, whose programs are the files of `nodes/`."""
    folder = tmp_path_factory.mktemp("install")
    for part in ("share/ament_index/resource_index/packages", "share/demo_pkg/launch", "lib/demo_pkg"):
        (folder / part).mkdir(parents=True)
    (folder / "share/ament_index/resource_index/packages/demo_pkg").touch()
    for source in NODES.glob("*.py"):
        program = folder / "lib/demo_pkg" / source.stem
        program.write_text(f"#!{sys.executable}\n{source.read_text()}")
        program.chmod(0o755)
    (folder / "lib/demo_pkg/notes.txt").write_text("no program\n")
    return folder


@pytest.fixture(scope="session")
def domain() -> Iterator[str]:
    """A DDS domain that nobody else on this machine uses."""
    with lease_domain() as number:
        yield str(number)


@pytest.fixture
def other_domain() -> Iterator[str]:
    """Another one, on which there is nobody at all."""
    with lease_domain() as number:
        yield str(number)


@pytest.fixture
def env(prefix: Path, domain: str, tmp_path: Path) -> dict[str, str]:
    """The environment of every `ros2` of these tests."""
    prefixes = [str(prefix), *os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)]
    return {
        **{name: value for name, value in os.environ.items() if name != "OVERRIDE_LAUNCH_PROCESS_OUTPUT"},
        "AMENT_PREFIX_PATH": os.pathsep.join(filter(None, prefixes)),
        "PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")])),
        "PYTHONUNBUFFERED": "1",
        "RCUTILS_COLORIZED_OUTPUT": "0",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": domain,
        "ROS_LOG_DIR": str(tmp_path / "ros_log"),
    }


@pytest.fixture
def ros2(env: dict[str, str], tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Call `ros2 WORDS…` and return what it printed and its exit code."""

    def call(*words: str, stdin: str | None = None, **variables: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "course_runtime.ros2_command", *words],
            env=env | variables,
            cwd=tmp_path,
            input=stdin,
            stdin=subprocess.DEVNULL if stdin is None else None,
            capture_output=True,
            text=True,
            timeout=LONGEST,
            check=False,
        )

    return call


@pytest.fixture
def start(env: dict[str, str], tmp_path: Path) -> Iterator[Callable[..., Running]]:
    """Start `ros2 WORDS…`, with `program` a program of the demo package, with `code` this code, and go on meanwhile."""
    started: list[Running] = []

    def begin(*words: str, program: bool = False, code: str = "", **variables: str) -> Running:
        if program:
            command = [sys.executable, str(NODES / f"{words[0]}.py"), *words[1:]]
        elif code:
            command = [sys.executable, "-c", code, *words]
        else:
            command = [sys.executable, "-m", "course_runtime.ros2_command", *words]
        running = Running(command, env | variables, tmp_path)
        started.append(running)
        return running

    yield begin
    for running in started:
        running.kill()
