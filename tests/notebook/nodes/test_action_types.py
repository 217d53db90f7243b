"""A wrong type of an action server or client is an error, and does not end the kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.cases import cases

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable

    RunScript = Callable[..., subprocess.CompletedProcess[str]]

pytestmark = pytest.mark.ros

MADE = cases(__file__, "MADE")
WRONG = cases(__file__, "WRONG")
RIGHT = cases(__file__, "RIGHT")


def test_what_is_not_the_type_of_an_action_is_an_error_that_names_it(run_script: RunScript) -> None:
    done = run_script(MADE + WRONG)
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert len(lines) == 7 * 4
    assert (
        lines[0]
        == "rclpy needs the type of an action here, such as Fibonacci, and Fibonacci.Goal is not an action"
    )


def test_an_action_is_made_as_before(run_script: RunScript) -> None:
    done = run_script(MADE + RIGHT)
    assert (done.returncode, done.stdout) == (0, "made\n")
