"""What the judge learns of a notebook's subject: whether it is being built, and whether it is in a loop."""

from __future__ import annotations

from typing import Any, cast

import pytest

from autograder.judge import notebook_subject
from autograder.judge.bench.recorder import Recorder
from autograder.judge.notebook_subject import NotebookPath, NotebookSubject
from autograder.kit.mistakes.hangs import LOOPS
from autograder.kit.output.workspace_reports import WorkspaceReport, workspace_report_line
from autograder.messages.judge_messages import Stacks
from autograder.messages.run_messages import Output
from tests.cases import named_cases


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


@pytest.mark.parametrize(
    ("used", "asked", "busy"),
    named_cases(__file__, "a_loop_is_told_by_the_processor_time_that_the_subject_uses"),
)
def test_a_loop_is_told_by_the_processor_time_that_the_subject_uses(
    monkeypatch: pytest.MonkeyPatch, used: list[float], asked: int, busy: float
) -> None:
    monkeypatch.setattr(notebook_subject, "ASK_AGAIN", 0.0)
    subject = NotebookSubject(cast("Any", None))
    recorder, answers = Recorder(), [Stacks(0, f"stack {n}", one) for n, one in enumerate(used, 1)]
    monkeypatch.setattr(subject, "_tell", lambda _: subject._take_of_run(answers.pop(0), recorder))
    assert subject.stack() == f"stack {asked}"
    assert subject.busy == pytest.approx(busy)
    assert (subject.busy >= LOOPS) is (busy >= LOOPS)
