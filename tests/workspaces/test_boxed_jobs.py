"""Builds and programs in real boxes: what a student's setup.py and program can do there, and what they cannot."""

from __future__ import annotations

import fcntl
import os
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.boxes.fork_server import BESIDE, SUPERVISOR_MODULE, ForkServer
from autograder.boxes.sandbox import Enclosure, why_impossible
from autograder.kit.runners import LaunchesFromPackage
from autograder.workspaces import program_preparation
from autograder.workspaces.boxed_jobs import BoxedJobs, BoxedProgram
from autograder.workspaces.builds.colcon_build import describe_workspace
from autograder.workspaces.graded_builds import GradedBuilds
from autograder.workspaces.jobs import BuildOutcome, ProgramJob
from autograder.workspaces.program_plans import course_interfaces, plan_for
from autograder.workspaces.program_preparation import Preparation
from tests.cases import cases

sys.path.insert(0, str(Path(__file__).parent))

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.workspaces.builds.colcon_build import Build

pytestmark = pytest.mark.skipif(bool(why_impossible()), reason=f"no boxes here: {why_impossible()}")


@pytest.fixture(scope="module")
def supervisors() -> Iterator[str]:
    with tempfile.TemporaryDirectory() as folder:
        process = ForkServer(BESIDE, SUPERVISOR_MODULE, Path(folder) / "k")
        yield process.address
        process.stop()


@pytest.fixture
def jobs(supervisors: str, tmp_path: Path) -> Iterator[BoxedJobs]:
    with Enclosure(supervisors, tmp_path / "submission") as submission:
        yield BoxedJobs(supervisors, submission, tmp_path)


@pytest.fixture
def builds(jobs: BoxedJobs, tmp_path: Path) -> GradedBuilds:
    (tmp_path / "builds").mkdir(mode=0o700)
    return GradedBuilds(tmp_path / "builds", jobs)


def made(builds: GradedBuilds, workspace: Path, setup: str = "") -> Build:
    """The workspace's build, with some lines at the end of its setup.py."""
    file = workspace / "src" / "tiny_pkg" / "setup.py"
    file.write_text(file.read_text() + setup)
    return builds.build(describe_workspace(workspace), None, name="ros2_ws")


def said(program: BoxedProgram) -> str:
    output = b""
    while (data := program.read(20.0)) != b"":
        assert data is not None, "the program says nothing and does not end"
        output += data
    program.end()
    return output.decode()


def test_it_is_built_in_a_box_and_run_in_another(
    builds: GradedBuilds, jobs: BoxedJobs, workspace: Path, tmp_path: Path
) -> None:
    build = made(builds, workspace)
    assert build.ok, build.log
    assert build.install is not None
    assert not build.install.is_relative_to(workspace)
    (tmp_path / "tree").mkdir()
    program = jobs.start(
        ProgramJob(
            [sys.executable, "/home/student/ros2_ws/install/tiny_pkg/lib/tiny_pkg/hello"],
            {**jobs.environment, "PYTHONPATH": f"/home/student/ros2_ws/install/tiny_pkg/{_library()}"},
            sources=tmp_path / "tree",
            entries={"ros2_ws": build.install.parent},
            hidden=(),
        )
    )
    assert said(program) == "hello from the workspace\n"
    assert program.exit_code() == 0


REMAP = cases(__file__, "REMAP")


def test_a_launch_file_finds_the_files_of_its_package_beside_the_programs_that_are_lent_to_it(
    builds: GradedBuilds, jobs: BoxedJobs, workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(workspace, tmp_path / "course")
    monkeypatch.setattr(program_preparation, "reference_workspace", lambda: tmp_path / "course")
    package = workspace / "src" / "tiny_pkg"
    (package / "tiny_pkg" / "hello.py").unlink()
    (package / "launch").mkdir()
    (package / "launch" / "remap.launch.py").write_text(REMAP)
    (package / "launch" / "hello.launch.xml").write_text(
        '<launch><node pkg="tiny_pkg" exec="hello" output="screen"/></launch>'
    )
    setup = (package / "setup.py").read_text().replace("'hello = tiny_pkg.hello:main'", "")
    files = "('share/tiny_pkg/launch', ['launch/remap.launch.py', 'launch/hello.launch.xml']),"
    (package / "setup.py").write_text(setup.replace("data_files=[", f"data_files=[{files}"))
    plan = plan_for(LaunchesFromPackage("tiny_pkg", "remap.launch"))
    reports: list[str] = []
    ready = Preparation(builds, reports.append).workspace(plan, workspace)
    assert ready is not None, reports
    (tmp_path / "tree").mkdir()
    entries = {name: build.install.parent for name, build in ready.builds.items() if build.install}
    job = ProgramJob(ready.command, ready.environment, tmp_path / "tree", entries, hidden=())
    assert "hello from the workspace" in said(jobs.start(job))


def test_a_program_sees_nothing_that_the_notebook_has_written(supervisors: str, tmp_path: Path) -> None:
    (tmp_path / "tree").mkdir()
    with Enclosure(supervisors, tmp_path / "submission") as submission:
        write = "for folder in /home/student /tmp /dev/shm; do touch $folder/of-the-notebook; done; ls /tmp"
        assert b"of-the-notebook" in submission.run(["/bin/sh", "-c", write], limit=20.0).output
        jobs = BoxedJobs(supervisors, submission, tmp_path)
        look_for = ["/bin/sh", "-c", "ls -R /home/student /tmp /dev/shm; touch /home/student/notebook/x"]
        program = jobs.start(ProgramJob(look_for, jobs.environment, tmp_path / "tree", entries={}, hidden=()))
        output = said(program)
    assert "of-the-notebook" not in output
    assert "Read-only file system" in output


def test_ctrl_c_reaches_a_program_in_its_box(jobs: BoxedJobs, tmp_path: Path) -> None:
    (tmp_path / "tree").mkdir()
    wait = ["/bin/sh", "-c", "trap 'echo bye; exit 4' INT; echo ready; while :; do sleep 0.05; done"]
    program = jobs.start(ProgramJob(wait, jobs.environment, tmp_path / "tree", entries={}, hidden=()))
    assert program.read(60.0) == b"ready\n"
    program.interrupt()
    assert said(program) == "bye\n"
    assert program.exit_code() == 4


def _library() -> str:
    return f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"


def test_a_build_reaches_nothing_of_the_grader_s(
    builds: GradedBuilds, workspace: Path, tmp_path: Path
) -> None:
    """It looks for other processes, the cache, the sources' owner, the network and a pipe that is not its own."""
    secret = tmp_path / "builds" / "secret"
    secret.touch()
    looks = cases(__file__, "a_build_reaches_nothing_of_the_grader_s").replace("SECRET", str(secret))
    build = made(builds, workspace, f"\n{looks}")
    assert not build.ok
    assert "processes True; cache False; network 111; sources read-only; interfaces ['lo']" in build.log


def test_killing_everything_is_only_a_failed_build(builds: GradedBuilds, workspace: Path) -> None:
    build = made(builds, workspace, "\nimport os\nos.kill(-1, 9)\n")
    assert (build.ok, build.trouble) == (False, "build")


def test_nothing_that_a_build_starts_outlives_it(builds: GradedBuilds, workspace: Path) -> None:
    mark = f"sleep 1{os.getpid()}"
    assert made(
        builds,
        workspace,
        f"\nimport subprocess\nsubprocess.Popen({mark.split()!r}, start_new_session=True, stdout=-3, stderr=-3)\n",
    ).ok
    assert (
        mark not in subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
    )


def test_a_build_that_fills_its_disk_fails(builds: GradedBuilds, workspace: Path) -> None:
    build = made(
        builds,
        workspace,
        "\nfor number in range(6):\n"
        "    with open(f'/tmp/{number}', 'wb') as file:\n"
        "        for _ in range(90):\n"
        "            file.write(b'x' * 1_000_000)\n",
    )
    assert not build.ok
    assert "No space left" in build.log


def test_whoever_makes_interfaces_does_not_find_those_of_the_course(
    builds: GradedBuilds, workspace: Path
) -> None:
    libraries = [str(path) for path in course_interfaces() if path.suffix == ".so"]
    lines = f"""
sizes = [len(open(name, 'rb').read()) for name in {libraries}]
raise SystemExit('there are %d' % len([size for size in sizes if size]))
"""
    assert "there are 0" not in made(builds, workspace, lines).log
    definition = workspace / "src" / "tiny_pkg" / "srv" / "AddTwoInts.srv"
    definition.parent.mkdir()
    definition.write_text("int64 a\n---\nint64 b\n")
    assert "there are 0" in builds.build(describe_workspace(workspace), None, name="ros2_ws").log


def test_the_builds_of_one_notebook_have_so_much_room_and_no_more(
    jobs: BoxedJobs, workspace: Path, tmp_path: Path
) -> None:
    cache = tmp_path / "narrow"
    cache.mkdir(mode=0o700)
    (workspace / "src" / "tiny_pkg" / "tiny_pkg" / "fat.py").write_bytes(b"#" * 300_000)
    narrow = GradedBuilds(cache, jobs, room=1_200_000)  # for the build without texts, and one copy of it
    first = made(narrow, workspace)
    assert first.ok
    second = made(narrow, workspace, "# other sources\n")
    assert not second.ok
    assert "kB of space are left for it" in second.log
    assert sum(file.stat().st_size for file in cache.rglob("*") if file.is_file()) < 1_000_000
    assert made(GradedBuilds(cache, jobs), workspace).ok  # somebody else has room
    assert not made(narrow, workspace).ok  # and who has none gets no build from the cache, either


def test_a_big_build_that_nobody_waits_for_gives_up_its_turn(
    jobs: BoxedJobs, supervisors: str, builds: GradedBuilds, workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "_build", lambda *_: (BuildOutcome(1, b""), True))
    another = os.open(Path(supervisors).parent, os.O_RDONLY)
    fcntl.flock(another, fcntl.LOCK_EX)
    release = threading.Timer(60.0, os.close, [another])  # so that a defect fails, and does not hang
    release.start()
    assert not builds.build(describe_workspace(workspace), None, cancelled=lambda: True).ok
    assert release.is_alive(), "it waited for its turn"
    release.cancel()
    os.close(another)
