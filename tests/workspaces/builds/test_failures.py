"""The line that matters, out of logs as the tools write them."""

from __future__ import annotations

from pathlib import Path

import pytest

from autograder import interface_builder
from autograder.workspaces.builds.colcon_build import Build, failed_build
from tests.cases import cases

LOGS = cases(__file__, "LOGS")


@pytest.mark.parametrize("name", LOGS)
def test_the_line_that_matters(name: str) -> None:
    log, expected = LOGS[name]
    assert failed_build(Build(Path(), ok=False), log).line == expected


@pytest.mark.parametrize(
    ("build", "code", "said"),
    [
        (Build(Path(), ok=True), 0, "\n"),
        (Build(Path(), ok=False, package="own", line="no cmake"), 1, "own cannot be built: no cmake\n"),
        (Build(Path(), ok=False, line="no cmake"), 1, "a, b cannot be built: no cmake\n"),
    ],
)
def test_a_build_of_interfaces_says_by_its_exit_code_if_it_went_well(
    build: Build, code: int, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(interface_builder, "_build", lambda _: build)
    assert int(interface_builder.main(["of/a", "of/b"])) == code
    assert capsys.readouterr().out == said
