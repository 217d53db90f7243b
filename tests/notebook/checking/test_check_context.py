"""What a check's context leaves behind when it ends."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.cases import cases

pytestmark = pytest.mark.ros

LEFT_AND_MADE_AGAIN = cases(__file__, "LEFT_AND_MADE_AGAIN")


def test_a_node_that_was_left_does_not_spoil_the_log_of_a_later_one() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LEFT_AND_MADE_AGAIN], capture_output=True, text=True, check=False
    )
    said = done.stdout + done.stderr
    assert "after the check" in said
    assert "rosout" not in said
