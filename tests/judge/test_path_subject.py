"""A graded check of a workspace: only its sources count, whatever the notebook says besides."""

from __future__ import annotations

import json
import socket
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from autograder.judge.bench.recorder import Recorder
from autograder.judge.path_subject import PathSubject, as_words
from autograder.kit.output.spoken_lines import REPORTS
from autograder.messages.json_lines import Hangup, Lines
from autograder.messages.judge_messages import Check, Collect, Constructed, Judged, Sources
from autograder.messages.run_messages import Exited, Output
from autograder.messages.workspace_messages import Source

sys.path.insert(0, str(Path(__file__).parents[1] / "workspaces"))
from graded import graders_judge, judged

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.judge.controlled_judge import JudgeProcess
    from autograder.verdict import Verdict

pytestmark = pytest.mark.ros
FORGED = f"{REPORTS[0]}{json.dumps({'phase': 'built', 'built': True, 'packages': []})}"


@pytest.fixture(scope="module")
def judge(tmp_path_factory: pytest.TempPathFactory) -> Iterator[JudgeProcess]:
    with graders_judge(tmp_path_factory.mktemp("grader")) as judge:
        yield judge


def kernel_of(judge: JudgeProcess, kind: str = "function") -> Lines:
    """A notebook that has asked for the check of lab 1.1."""
    judge.open("lab_1_1.hello")
    connection = socket.socket(socket.AF_UNIX)
    connection.connect(str(judge.socket_path))
    kernel = Lines(connection)
    kernel.say(Check("lab_1_1.hello", kind))
    return kernel


def verdict_of(judge: JudgeProcess) -> Verdict:
    report = judge.close()
    assert report.verdict is not None, report.trouble
    return report.verdict


@pytest.mark.parametrize("kind", ["class", "function", "path", ""])
def test_what_a_notebook_says_besides_its_sources_is_not_heard(judge: JudgeProcess, kind: str) -> None:
    kernel = kernel_of(judge, kind)
    kernel.hear(Collect)
    for run in (0, 1):
        kernel.say(Output(run, FORGED))
        kernel.say(Output(run, "Hello, ROS 2! From SimpleNode."))
        kernel.say(Constructed(run, "/x"))
    kernel.say(Sources("ros2_ws"))
    told = kernel.hear(Judged).verdict
    assert told is not None
    assert told.score == 0
    verdict = verdict_of(judge)
    assert verdict.score == 0
    assert verdict.diagnosis is not None
    assert verdict.diagnosis.key == "no_workspace"


@pytest.mark.parametrize(
    "words",
    [
        {"path": "../evil", "data": ""},
        {"path": ["x"], "data": {"a": 1}},
        {"path": "\ud800", "data": ""},
        {"path": "ros2_ws/src", "data": "not base64"},
    ],
)
def test_sources_that_could_do_harm_are_a_failure(judge: JudgeProcess, words: dict[str, Any]) -> None:
    kernel = kernel_of(judge)
    kernel.hear(Collect)
    kernel.say(Source(**words))  # whatever the types are
    with suppress(Hangup):  # a judge that has read the first message already has ended the check
        kernel.say(Sources("ros2_ws", "\ud800\0" * 500))
    assert verdict_of(judge).score == 0


def test_a_notebook_that_goes_away_has_no_verdict(judge: JudgeProcess) -> None:
    kernel = kernel_of(judge)
    kernel.say(Source("ros2_ws"))
    kernel.close()
    assert judge.close().verdict is None


def test_a_subject_that_is_no_path_is_told_so(judge: JudgeProcess) -> None:
    verdict = judged(judge, "lab_1_1.hello", lambda: None)
    assert verdict.score == 0
    assert verdict.diagnosis is not None
    assert "path" in verdict.diagnosis.text


def test_a_grader_s_side_that_is_gone_is_no_verdict(judge: JudgeProcess) -> None:
    path, judge.workspaces = judge.workspaces, f"{judge.workspaces}-gone"
    try:
        kernel = kernel_of(judge)
        kernel.hear(Collect)
        kernel.say(Sources("ros2_ws"))
        report = judge.close()
        assert report.verdict is None
        assert "gone" in report.trouble
    finally:
        judge.workspaces = path


@pytest.mark.parametrize("mark", REPORTS)
def test_a_program_s_words_are_never_a_report(mark: str) -> None:
    assert not as_words(f"{mark}[]").startswith(REPORTS)
    assert as_words("hello") == "hello"


def test_the_end_of_a_run_is_known_behind_all_that_was_sent_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(PathSubject, "_say", lambda *_: None)
    nobody: Any = None
    subject, recorder = PathSubject(nobody, "lab_1_1.hello", ""), Recorder()
    recorder.take_in = lambda: recorder.record("log", "/rosout", text="hello")
    subject.start(recorder, (), {})
    subject._take(Exited(run=1, code=0))
    assert [event.kind for event in recorder.part().events] == ["log", "subject"]
    assert subject.ended
