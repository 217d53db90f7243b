"""The autograder command: what it prints and with which exit code it ends."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

BANK = Path(__file__).parent / "submissions"
TALKER = BANK / "lab_1_2.talker"


def _run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "autograder", *words], capture_output=True, text=True, check=False, timeout=120
    )


def test_check_alone_lists_the_exercises() -> None:
    done = _run("check")
    assert done.returncode == 0
    assert "lab_1_2.talker" in done.stdout


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        pytest.param(
            ("check", "lab_1_2.talkr", "--", "true"), "did you mean lab_1_2.talker", id="unknown exercise"
        ),
        pytest.param(("check", "lab_1_2.talker"), "two dashes", id="no command"),
        pytest.param(
            ("check", "lab_1_2.talker", "--", "no-such-program"), "no-such-program", id="no such program"
        ),
        pytest.param(("check", "lab_1_2.talker", "--", "/etc/passwd"), "/etc/passwd", id="not executable"),
        pytest.param(("record", "lab_9"), "did you mean", id="record something unknown"),
    ],
)
def test_bad_input_is_named_and_ends_with_2(words: tuple[str, ...], hint: str) -> None:
    done = _run(*words)
    assert done.returncode == 2
    assert hint in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.ros
def test_a_right_answer_ends_with_0_and_a_wrong_one_with_1() -> None:
    right = _run(
        "check", "lab_1_2.talker", "--", sys.executable, str(TALKER / "correct" / "text_as_it_stands.py")
    )
    wrong = _run("check", "lab_1_2.talker", "--", sys.executable, str(TALKER / "wrong" / "topic_name.py"))
    assert (right.returncode, wrong.returncode) == (0, 1)
    assert "/chater" in wrong.stdout


@pytest.mark.ros
def test_json_is_one_object_with_the_promised_names() -> None:
    done = _run(
        "check", "lab_1_2.talker", "--json", "--", sys.executable, str(TALKER / "wrong" / "wrong_text.py")
    )
    verdict = json.loads(done.stdout)
    assert verdict["exercise"] == "lab_1_2.talker"
    assert verdict["max_score"] == 10
    assert 0 < verdict["score"] < 10
    assert set(verdict["criteria"][0]) >= {"name", "passed", "expected", "seen"}
    assert verdict["diagnosis"]["key"] == "wrong_text"
    assert verdict["diagnosis"]["text"]


@pytest.mark.ros
def test_the_same_seed_gives_the_same_inputs() -> None:
    program = str(BANK / "lab_1_2.listener" / "correct" / "text_as_it_stands.py")
    words = ("check", "lab_1_2.listener", "--json", "--seed", "s", "--", sys.executable, program)
    sent = [
        [m["label"] for m in json.loads(_run(*words).stdout)["timeline"] if m["direction"] == "to_subject"]
        for _ in range(2)
    ]
    assert sent[0] == sent[1]
    assert len(sent[0]) > 3


@pytest.mark.ros
def test_a_judge_that_cannot_judge_ends_with_2_and_accuses_nobody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "solutions").mkdir()
    monkeypatch.setenv("AUTOGRADER_COURSE", str(tmp_path))
    done = _run(
        "check", "lab_1_2.talker", "--", sys.executable, str(TALKER / "correct" / "text_as_it_stands.py")
    )
    assert done.returncode == 2
    assert "COULD NOT BE CHECKED" in done.stdout
    assert "autograder record lab_1_2.talker" in " ".join(done.stdout.split())
