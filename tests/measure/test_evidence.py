"""Evidence that is out of date, cut, or another answer's is noticed; what decides nothing of it makes no difference."""

from __future__ import annotations

import argparse
import json
import lzma
import subprocess
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from autograder.authoring.answer_bank import answers
from autograder.kit.recipes import publisher
from tests.measure import evidence, stimulus

if TYPE_CHECKING:
    from pathlib import Path


ID = "lab_1_2.talker"
FIRST, SECOND = list(answers([ID]))[:2]
FOLDER = evidence.FOLDER


@pytest.fixture
def keep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of the evidence of an exercise, to be changed."""
    file = tmp_path / f"{ID}.xz"
    file.write_bytes((FOLDER / file.name).read_bytes())
    monkeypatch.setattr(evidence, "FOLDER", tmp_path)
    monkeypatch.setattr(evidence, "kept", lambda exercise_id: evidence.lines(file))
    # Also while a change of the bench waits for its evidence.
    seen_by = json.loads(evidence.kept(ID)[FIRST.name])["stimulus"]
    monkeypatch.setattr(stimulus, "digest", lambda exercise_id: seen_by)
    assert evidence.objection(FIRST) == evidence.objection(SECOND) == ""
    return file


def change(file: Path, old: str, new: str) -> None:
    text = lzma.decompress(file.read_bytes()).decode()
    assert old in text
    file.write_bytes(lzma.compress(text.replace(old, new, 1).encode()))


def test_an_answer_without_evidence_is_named_with_the_command(keep: Path) -> None:
    keep.unlink()
    assert evidence.objection(FIRST).endswith(f"is missing: python -m tests.measure evidence {FIRST.name}")


@pytest.mark.parametrize("what", ["text", "command", "name"])
def test_an_answer_that_was_changed_needs_new_evidence(keep: Path, what: str, tmp_path: Path) -> None:
    changed_text, other_name = tmp_path / FIRST.file.name, tmp_path / "other.py"
    changed_text.write_text(f"{FIRST.text}# changed\n", encoding="utf-8")
    other_name.write_text(FIRST.text, encoding="utf-8")
    changed = {
        "text": replace(FIRST, edit=None, file=changed_text),
        "command": replace(FIRST, command=(*FIRST.command, "more")),
        "name": replace(FIRST, edit=None, file=other_name),
    }
    line = evidence.kept(ID)[FIRST.name]
    with pytest.raises(evidence.BadEvidence, match="of another program"):
        evidence.record_of(changed[what], line)


def test_evidence_of_another_answer_is_noticed(keep: Path) -> None:
    line = evidence.kept(ID)[SECOND.name]
    with pytest.raises(evidence.BadEvidence, match="of another program"):
        evidence.record_of(FIRST, line)
    with pytest.raises(evidence.BadEvidence, match="by hand"):
        evidence.record_of(FIRST, line.replace(SECOND.name, FIRST.name))


def test_what_was_seen_cannot_be_swapped_between_two_answers(keep: Path) -> None:
    first, second = (evidence.kept(ID)[one.name].partition('"seen"') for one in (FIRST, SECOND))
    swapped = "".join((*first[:2], second[2]))
    with pytest.raises(evidence.BadEvidence, match="by hand"):
        evidence.record_of(FIRST, swapped)


def test_a_file_that_is_cut_is_noticed(keep: Path) -> None:
    data = keep.read_bytes()
    keep.write_bytes(data[: len(data) // 2])
    assert "is damaged" in evidence.objection(FIRST)
    text = lzma.decompress(data)
    keep.write_bytes(lzma.compress(text[: len(text) // 2]))
    assert "is damaged" in evidence.objection(FIRST)


def test_evidence_of_another_bench_is_not_judged(keep: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert not evidence.is_of_another_bench(FIRST)
    monkeypatch.setattr(stimulus, "digest", lambda exercise_id: "another one")
    assert evidence.is_of_another_bench(FIRST)
    assert evidence.objection(FIRST) == ""


def test_a_verdict_that_changes_is_told(keep: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    exercise = exercises.get(ID)
    monkeypatch.setattr(exercises, "get", lambda _: replace(exercise, mistakes=()))
    wrong = next(one for one in answers([ID]) if one.diagnoses)
    assert "diagnosed as unknown" in evidence.objection(wrong)


def test_nothing_is_written_where_nothing_is_new(keep: Path) -> None:
    before = keep.stat().st_mtime_ns
    evidence.make([], jobs=1)
    assert keep.stat().st_mtime_ns == before


def test_evidence_depends_on_the_scenario_and_not_on_what_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    before = stimulus.new_digest(ID)
    exercise = exercises.get(ID)
    monkeypatch.setattr(exercises, "get", lambda _: replace(exercise, criteria=(), mistakes=(), title="?"))
    assert stimulus.new_digest(ID) == before
    monkeypatch.setattr(publisher, "PERSISTENT", publisher.PERSISTENT + 1)
    assert stimulus.new_digest(ID) != before


def test_the_digest_is_the_same_in_each_process() -> None:
    program = f"from tests.measure import stimulus; print(stimulus.digest({ID!r}))"
    said = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in "12"
    }
    assert len(said) == 1


def test_no_evidence_tells_where_the_clone_was_that_it_was_made_in() -> None:
    for file in sorted(FOLDER.glob("*.xz")):
        text = lzma.decompress(file.read_bytes()).decode()
        assert text.count("/.venv/") == text.count("/course/.venv/"), file.name


@pytest.mark.parametrize("is_recorded", [True, False])
def test_evidence_is_kept_anew_only_beside_a_recording_of_the_same_bench(
    keep: Path, monkeypatch: pytest.MonkeyPatch, is_recorded: bool
) -> None:
    """Otherwise nothing but the nightly tier would see that a recording is out of date."""
    options = argparse.Namespace(only=[FIRST.name], anew=False, jobs=1)
    monkeypatch.setattr(evidence, "RECORD", (sys.executable, "-c", f"raise SystemExit({not is_recorded:d})"))
    monkeypatch.setattr(evidence, "make", lambda *_, **__: [])
    monkeypatch.setattr(stimulus, "digest", lambda exercise_id: "another bench")
    assert evidence.main(options) == int(not is_recorded)
