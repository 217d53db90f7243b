"""The interface package that was built into the environment."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from course_runtime.ros_report import INTERFACE_FIELDS, interface_fields
from tests.cases import cases

pytestmark = pytest.mark.ros

# A server whose answer has a text where a number belongs.
WRONG_TYPE = cases(__file__, "WRONG_TYPE")


def test_the_fields_are_those_of_the_course_text() -> None:
    assert interface_fields() == INTERFACE_FIELDS


def test_a_wrong_field_type_is_an_exception_and_does_not_end_the_process() -> None:
    # Other tests may have switched the checks of fields on, which a robot has not.
    usual = {name: value for name, value in os.environ.items() if name != "ROS_PYTHON_CHECK_FIELDS"}
    done = subprocess.run(
        [sys.executable, "-c", WRONG_TYPE], capture_output=True, text=True, check=False, env=usual
    )
    assert done.returncode == 0, (
        f"exit status {done.returncode}: was the package built without NDEBUG?\n{done.stderr}"
    )
    assert done.stdout.startswith("caught")
