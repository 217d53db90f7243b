"""Starting ROS in a kernel: once, on a domain of its own, with settings that suit a notebook."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable
    from pathlib import Path

    RunScript = Callable[..., subprocess.CompletedProcess[str]]

pytestmark = pytest.mark.ros


def test_a_domain_is_picked_exported_and_named(run_script: RunScript) -> None:
    script = """
import os, subprocess, sys
from autograder.notebook.nodes.ros_session import start_ros
session = start_ros()
child = subprocess.run([sys.executable, "-c", "import os; print(os.environ['ROS_DOMAIN_ID'])"],
                       capture_output=True, text=True)
assert session.picked and 1 <= session.domain <= 101, session
assert child.stdout.strip() == str(session.domain), child
assert start_ros() == session
print(session)
"""
    done = run_script(script, ROS_DOMAIN_ID=None)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("ROS 2 is up on domain ")
    assert "export ROS_DOMAIN_ID=" in done.stdout
    assert done.stdout.count("\n") == 1


def test_the_sessions_domain_is_taken(run_script: RunScript, domain: int) -> None:
    done = run_script("from autograder.notebook.nodes.ros_session import start_ros; print(start_ros())")
    assert done.stdout == f"ROS 2 is up on domain {domain}.\n"


@pytest.mark.parametrize("shutdown", ["rclpy.shutdown()", "rclpy.get_default_context().shutdown()"])
def test_ros_starts_again_after_a_shutdown(run_script: RunScript, shutdown: str) -> None:
    script = f"""
import rclpy
from autograder.notebook.nodes.ros_session import start_ros
start_ros()
{shutdown}
assert not rclpy.ok()
start_ros()
rclpy.create_node("alive")
print(rclpy.ok())
"""
    done = run_script(script)
    assert (done.stdout, done.stderr, done.returncode) == ("True\n", "", 0)


def test_logs_go_to_standard_output_without_colours(run_script: RunScript) -> None:
    script = """
import rclpy
from autograder.notebook.nodes.ros_session import start_ros
start_ros()
rclpy.create_node("speaker").get_logger().error("over here")
"""
    done = run_script(script, RCUTILS_LOGGING_USE_STDOUT=None, RCUTILS_COLORIZED_OUTPUT=None)
    assert "over here" in done.stdout
    assert "\x1b[" not in done.stdout
    assert done.stderr == ""


def test_what_a_program_prints_is_in_a_file_at_once(run_script: RunScript, tmp_path: Path) -> None:
    # A cell of Lab 1.1 waits until the line of a student's node is in a file, whether it is logged or printed.
    script = f"""
import subprocess
from autograder.notebook.nodes.ros_session import start_ros
start_ros()
ends_without_writing_its_buffer = "import os; print('Hello'); os._exit(0)"
with open({str(tmp_path / "hello.log")!r}, "w") as log:
    subprocess.run(["python3", "-c", ends_without_writing_its_buffer], stdout=log)
"""
    assert run_script(script, PYTHONUNBUFFERED=None).returncode == 0
    assert (tmp_path / "hello.log").read_text(encoding="utf-8") == "Hello\n"


@pytest.mark.parametrize("first", ["from std_msgs.msg import String", "pass"], ids=["before", "after"])
@pytest.mark.parametrize(
    ("mistake", "said"),
    [("String(data=42)", "The 'data' field must be of type 'str'"), ("String(dta='x')", "dta")],
)
def test_wrong_fields_are_named_even_when_the_message_was_imported_before(
    run_script: RunScript, first: str, mistake: str, said: str
) -> None:
    script = f"""
{first}
from autograder.notebook.nodes.ros_session import start_ros
start_ros()
from std_msgs.msg import String
{mistake}
"""
    done = run_script(script, ROS_PYTHON_CHECK_FIELDS=None)
    assert done.returncode == 1
    assert "AssertionError" in done.stderr
    assert said in done.stderr.splitlines()[-1]


@pytest.mark.parametrize(("chosen", "used"), [(None, "Release"), ("Debug", "Debug")])
def test_a_cell_builds_interfaces_as_a_check_does_so_that_the_check_can_use_them(
    run_script: RunScript, chosen: str | None, used: str
) -> None:
    script = "import autograder.notebook, os; print(os.environ['CMAKE_BUILD_TYPE'])"
    assert run_script(script, CMAKE_BUILD_TYPE=chosen).stdout == f"{used}\n"


def test_the_users_own_settings_stay(run_script: RunScript) -> None:
    script = """
import os
from autograder.notebook.nodes.ros_session import prepare_environment
prepare_environment()
from std_msgs.msg import String
String(data=42)
print(os.environ["RCUTILS_LOGGING_USE_STDOUT"], os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"])
"""
    done = run_script(
        script,
        RCUTILS_LOGGING_USE_STDOUT="0",
        ROS_PYTHON_CHECK_FIELDS="0",
        ROS_AUTOMATIC_DISCOVERY_RANGE="SUBNET",
    )
    assert done.stdout == "0 SUBNET\n"


def test_discovery_stays_on_this_host(run_script: RunScript) -> None:
    script = """
import os
from autograder.notebook.nodes.ros_session import prepare_environment
prepare_environment()
print(os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE"))
"""
    assert run_script(script, ROS_AUTOMATIC_DISCOVERY_RANGE=None).stdout == "LOCALHOST\n"
    older = run_script(script, ROS_AUTOMATIC_DISCOVERY_RANGE=None, ROS_LOCALHOST_ONLY="1")
    assert older.stdout == "None\n", "the older variable of the same meaning must not be contradicted"


def test_an_interrupt_leaves_ros_up_even_after_the_students_own_init(run_script: RunScript) -> None:
    script = """
import os, signal, time
import rclpy
from rclpy.signals import SignalHandlerOptions, get_current_signal_handlers_options
from autograder.notebook.nodes.ros_session import start_ros
{first}
start_ros()
assert get_current_signal_handlers_options() == SignalHandlerOptions.NO
try:
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(20)
except KeyboardInterrupt:
    print("interrupted, up:", rclpy.ok())
"""
    for first in ("pass", "rclpy.init()"):
        done = run_script(script.format(first=first))
        assert (done.stdout, done.returncode) == ("interrupted, up: True\n", 0), first
