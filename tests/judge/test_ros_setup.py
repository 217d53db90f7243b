"""The environment of a judge's process; what killed programs have left in shared memory is removed, nothing else."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from autograder.judge import ros_setup
from autograder.judge.ros_setup import provide_log_folder, subject_environment


def test_the_folder_of_ros_logs_is_this_processs_own_whatever_another_user_has_put_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    (tmp_path / f"autograder-ros-logs-{os.getuid()}").touch()
    monkeypatch.setenv("ROS_LOG_DIR", "")
    provide_log_folder()
    made = Path(os.environ["ROS_LOG_DIR"])
    assert made.parent == tmp_path
    assert made.stat().st_mode & 0o777 == 0o700
    provide_log_folder()
    assert os.environ["ROS_LOG_DIR"] == str(made)


SEGMENT = "fastrtps_0123456789abcdef"
MAKES_A_NODE = (
    "import rclpy\nrclpy.init()\nnode = rclpy.create_node('simple_node')\nprint(flush=True)\ninput()\n"
)


@pytest.fixture
def segment(tmp_path: Path) -> Path:
    for name in (SEGMENT, f"{SEGMENT}_el"):
        (tmp_path / name).write_bytes(b"")
    return tmp_path / SEGMENT


def test_a_segment_without_an_owner_is_removed(segment: Path) -> None:
    other = segment.with_name("lttng-ust-wait-6")
    other.write_bytes(b"")
    ros_setup.remove_abandoned_memory(segment.parent, age=0.0)
    assert list(segment.parent.iterdir()) == [other]


def test_a_young_one_stays(segment: Path) -> None:
    ros_setup.remove_abandoned_memory(segment.parent)
    assert segment.exists()


def test_one_whose_owner_lives_stays(segment: Path) -> None:
    with segment.with_name(f"{SEGMENT}_el").open("rb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        ros_setup.remove_abandoned_memory(segment.parent, age=0.0)
    assert segment.exists()


def test_a_lock_that_leads_elsewhere_is_left_alone(segment: Path, tmp_path: Path) -> None:
    lock = segment.with_name(f"{SEGMENT}_el")
    lock.unlink()
    lock.symlink_to(tmp_path / "elsewhere")
    ros_setup.remove_abandoned_memory(segment.parent, age=0.0)
    assert segment.exists()


def test_without_shared_memory_there_is_nothing_to_do(tmp_path: Path) -> None:
    ros_setup.remove_abandoned_memory(tmp_path / "missing")


@pytest.mark.ros
def test_a_program_that_is_killed_leaves_what_is_then_removed() -> None:
    with ros_setup.lease_domain() as domain_id:
        program = [sys.executable, "-c", MAKES_A_NODE]
        environment = subject_environment(domain_id)
        with subprocess.Popen(
            program, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        ) as process:
            assert process.stdout
            process.stdout.readline()
            segment = _segment_of(process.pid)
            lock = segment.with_name(f"{segment.name}_el")
            with pytest.raises(BlockingIOError):
                ros_setup.remove_memory_if_abandoned(lock, time.time() + 1.0)
            process.kill()
        assert segment.exists()
        ros_setup.remove_memory_if_abandoned(lock, time.time() + 1.0)
        assert not segment.exists()
        assert not lock.exists()


def _segment_of(process: int) -> Path:
    lines = Path(f"/proc/{process}/maps").read_text(encoding="ascii").splitlines()
    mapped = {Path(line.split()[-1]) for line in lines if f"{ros_setup.SHARED_MEMORY}/fastrtps_" in line}
    (segment,) = (path for path in mapped if not path.name.startswith("fastrtps_port"))
    return segment
