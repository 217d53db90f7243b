"""A controlled judge answers the check that was opened, once, and nothing else."""

from __future__ import annotations

import json
import os
import signal
import socket
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import msgspec
import pytest

from autograder.judge import evidence_files
from autograder.judge.check_process import ChildResult
from autograder.judge.check_server import JudgeServer
from autograder.judge.controlled_judge import JudgeDied, JudgeProcess, _Child
from autograder.messages.judge_messages import Report

if TYPE_CHECKING:
    from collections.abc import Iterator

    from autograder.judge.check_process import Child

sys.path.insert(0, str(Path(__file__).parents[1] / "notebook"))
from checked import _Changed

pytestmark = pytest.mark.ros


@pytest.fixture(scope="module")
def _judge(tmp_path_factory: pytest.TempPathFactory) -> Iterator[JudgeProcess]:
    with JudgeProcess(tmp_path_factory.mktemp("judge") / "judge", seed="a seed") as process:
        yield process


@pytest.fixture
def judge(_judge: JudgeProcess) -> JudgeProcess:
    """A judge that was asked before, as a grader's is in a notebook with several checks."""
    _judge.keeps_evidence = _judge.is_boxed = False
    return _judge


class Kernel:
    """Plays a notebook's part of the conversation."""

    def __init__(self, judge: JudgeProcess) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(str(judge.socket_path))
        self._lines = self._socket.makefile("rb")

    def say(self, **words: Any) -> None:
        self._socket.sendall(json.dumps(words).encode() + b"\n")

    def hear(self) -> dict[str, Any]:
        heard: dict[str, Any] = json.loads(self._lines.readline() or b'{"say": "gone"}')
        return heard

    def hang_up(self) -> None:
        self._lines.close()
        self._socket.close()

    def fail_at_once(self, exercise: str, *, met: bool = True) -> dict[str, Any]:
        """Ask for a check whose subject raises whenever it is started; the last words of the judge."""
        self.say(say="check", exercise=exercise)
        while True:
            words = self.hear()
            if words["say"] == "begin":
                self.say(say="ready")
            elif words["say"] == "meet":
                self.say(say="met", seen=met)
            elif words["say"] == "start":
                self.say(say="raised", run=words["run"], traceback="Traceback\nRuntimeError: no")
            elif words["say"] == "stop":
                self.say(say="stopped", run=words["run"])
            elif words["say"] in ("verdict", "refused", "gone"):
                return words


def test_a_check_that_nobody_opened_is_refused(judge: JudgeProcess) -> None:
    kernel = Kernel(judge)
    kernel.say(say="check", exercise="lab_1_2.talker")
    assert kernel.hear()["say"] == "refused"
    assert judge.close().verdict is None


def test_the_evidence_comes_with_the_verdict_where_it_is_asked_for(judge: JudgeProcess) -> None:
    judge.open("lab_1_2.talker")
    Kernel(judge).fail_at_once("lab_1_2.talker")
    assert judge.close().evidence == b""
    judge.keeps_evidence = True
    judge.open("lab_1_2.talker")
    told = Kernel(judge).fail_at_once("lab_1_2.talker")
    report = judge.close()
    kept = evidence_files.unpack(report.evidence)
    assert "evidence" not in told
    assert report.verdict == replace(kept.verdict, timeline=report.verdict.timeline if report.verdict else ())
    (part,) = kept.looks[0].parts
    assert "RuntimeError: no" in str([event.data for event in part.events if event.name == "raised"])


def test_evidence_that_cannot_be_packed_costs_no_verdict(tmp_path: Path) -> None:
    change = "import autograder.judge.evidence_files as keeping; keeping.pack = lambda *_, **__: 1 / 0"
    start = partial(_Changed, change)
    with JudgeProcess(tmp_path / "judge", seed="s", start=start) as judge:
        judge.keeps_evidence = True
        judge.open("lab_1_2.talker")
        Kernel(judge).fail_at_once("lab_1_2.talker")
        report = judge.close()
    assert report.verdict is not None
    assert report.evidence == b""


def test_an_opened_check_counts_and_a_second_one_does_not(judge: JudgeProcess) -> None:
    judge.open("lab_1_2.talker")
    told = Kernel(judge).fail_at_once("lab_1_2.talker")
    assert Kernel(judge).fail_at_once("lab_1_2.talker")["say"] == "refused"
    verdict = judge.close().verdict
    assert verdict is not None
    assert verdict.score == 0
    assert verdict.diagnosis is not None
    assert verdict.diagnosis.key == "crashed"
    assert verdict.seed
    # A student sees it on the card, and must not learn what other checks draw from.
    assert "a seed" not in verdict.seed
    assert told["verdict"]["score"] == 0


def test_a_submission_in_its_box_hears_no_verdict(judge: JudgeProcess) -> None:
    judge.is_boxed = True
    judge.open("lab_1_2.talker")
    assert Kernel(judge).fail_at_once("lab_1_2.talker")["verdict"] is None
    assert judge.close().verdict is not None


def test_a_notebook_that_denies_to_have_met_the_judge_is_judged_all_the_same(judge: JudgeProcess) -> None:
    judge.open("inspecting_topics.mismatch")
    Kernel(judge).fail_at_once("inspecting_topics.mismatch", met=False)
    verdict = judge.close().verdict
    assert verdict is not None
    assert verdict.score == 0


def test_another_exercise_than_the_opened_one_is_refused(judge: JudgeProcess) -> None:
    judge.open("lab_1_2.talker")
    assert Kernel(judge).fail_at_once("lab_1_2.listener")["say"] == "refused"
    assert judge.close().verdict is None


def test_a_cell_that_never_asked_has_no_verdict(judge: JudgeProcess) -> None:
    judge.open("lab_1_2.talker")
    assert judge.close().verdict is None


def test_garbage_brings_no_verdict_and_no_harm(judge: JudgeProcess) -> None:
    judge.open("lab_1_2.talker")
    kernel = Kernel(judge)
    kernel._socket.sendall(b"\xff\xff garbage\n")
    kernel.hang_up()
    assert judge.close().verdict is None
    judge.open("lab_1_2.talker")
    assert Kernel(judge).fail_at_once("lab_1_2.talker")["say"] == "verdict"
    assert judge.close().verdict is not None


def test_a_kernel_that_goes_away_in_the_middle_gets_no_points(judge: JudgeProcess) -> None:
    judge.open("lab_1_2.talker")
    kernel = Kernel(judge)
    kernel.say(say="check", exercise="lab_1_2.talker")
    assert kernel.hear()["say"] == "begin"
    kernel.hang_up()
    verdict = judge.close().verdict
    assert verdict is None or verdict.score == 0


def test_a_judge_that_dies_is_reported_and_never_a_verdict(tmp_path: Path) -> None:
    with JudgeProcess(tmp_path / "judge", seed="a seed") as judge:
        judge.open("lab_1_2.talker")
        assert isinstance(judge._process, _Child)
        os.kill(judge._process._process.pid, signal.SIGKILL)
        with pytest.raises(JudgeDied):
            judge.close()


class EndedChild:
    """A check's child that has come to this end."""

    def __init__(self, outcome: ChildResult) -> None:
        self._outcome = outcome

    def result(self, *, within: float) -> ChildResult:
        del within
        return self._outcome


def report_on(outcome: ChildResult) -> Report:
    """What a controlled judge tells its grader of a check that ended so; in one line."""
    with socket.socket(socket.AF_UNIX) as listener:
        server = JudgeServer(listener, controlled=True)
        server._child = cast("Child", EndedChild(outcome))
        line = server._close()
    assert b"\n" not in line
    return msgspec.json.decode(line, type=Report)


@pytest.mark.parametrize("data", [b'{"verdict":null}\n{"verdict":null}', b'\n{"verdict":null}'])
def test_a_child_that_says_more_than_one_line_has_no_verdict(data: bytes) -> None:
    # The rest of it would be taken for the report of the next check.
    assert report_on(ChildResult(data)).trouble


def test_a_check_that_was_not_seen_to_its_end_earns_nothing_and_one_whose_time_was_over_says_so() -> None:
    late = "the judge did not finish in time"
    assert report_on(ChildResult(None, late, hurried=True, unfinished=True)) == Report()
    assert report_on(ChildResult(None, late, unfinished=True)) == Report(trouble=late, unfinished=True)


def test_a_judge_that_says_no_report_has_died(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    process = JudgeProcess(tmp_path / "judge", seed="a seed")
    monkeypatch.setattr(process, "_order", lambda _: b'{"verdict": 10}\n')
    with pytest.raises(JudgeDied, match="is not a report"):
        process.close()
