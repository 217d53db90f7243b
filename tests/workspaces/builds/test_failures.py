"""The line that matters, out of logs as the tools write them."""

from __future__ import annotations

from pathlib import Path

import pytest

from autograder.workspaces.builds.colcon_build import Build, failed_build
from tests.cases import cases

LOGS = cases(__file__, "LOGS")


@pytest.mark.parametrize("name", LOGS)
def test_the_line_that_matters(name: str) -> None:
    log, expected = LOGS[name]
    assert failed_build(Build(Path(), ok=False), log).line == expected
