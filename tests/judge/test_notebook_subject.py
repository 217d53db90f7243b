"""A notebook's path is being built until its report says that the build has ended."""

from __future__ import annotations

from typing import Any, cast

import pytest

from autograder.judge.bench.recorder import Recorder
from autograder.judge.notebook_subject import NotebookPath
from autograder.kit.runners import WorkspaceReport, workspace_report_line
from autograder.messages.run_messages import Output


@pytest.mark.parametrize(
    ("line", "building"),
    [
        (workspace_report_line(WorkspaceReport("found", built=False)), True),
        ("built", True),
        (workspace_report_line(WorkspaceReport("built", built=True)), False),
        (workspace_report_line(WorkspaceReport("built", built=False, trouble="build")), False),
    ],
    ids=["the sources are found", "a word of a program", "built", "failed to build"],
)
def test_the_report_of_a_build_ends_it(line: str, building: bool) -> None:
    path = NotebookPath(cast("Any", None))
    assert path.is_building
    path._take_of_run(Output(1, line), Recorder())
    assert path.is_building is building
