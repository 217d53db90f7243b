"""Starting ROS in a kernel: once, on a domain of its own, with settings that suit a notebook."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest

from tests.cases import named_cases

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable
    from pathlib import Path

    RunScript = Callable[..., subprocess.CompletedProcess[str]]

pytestmark = pytest.mark.ros


@pytest.mark.parametrize("runs", named_cases(__file__, "what_a_program_that_starts_ros_prints"))
def test_what_a_program_that_starts_ros_prints(
    run_script: RunScript, domain: int, runs: tuple[dict[str, Any], ...]
) -> None:
    for one in runs:
        done = run_script(one["script"], **{name: value or None for name, value in one["variables"].items()})
        assert (done.stderr, done.returncode) == ("", 0)
        assert re.fullmatch(one["prints"].replace("{domain}", str(domain)), done.stdout), done.stdout


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
