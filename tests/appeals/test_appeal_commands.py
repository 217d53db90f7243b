"""``./course replay``: what it prints, and with which exit code it ends."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner

from autograder.cli import cli

if TYPE_CHECKING:
    from pathlib import Path


Rows = list[Any]
"""The lines of the evidence: the verdict first, then looks, parts and events, and what was left out at the end."""
Edit = Callable[[str, Callable[[bytes], bytes]], None]


def about(**fields: object) -> tuple[str, Callable[[bytes], bytes]]:
    """What changes fields of check.json."""
    return "check.json", lambda data: json.dumps({**json.loads(data), **fields}).encode()


def seen(change: Callable[[Rows], object]) -> tuple[str, Callable[[bytes], bytes]]:
    """What changes the evidence."""

    def changed(data: bytes) -> bytes:
        rows = [json.loads(line) for line in data.splitlines()]
        change(rows)
        return "\n".join(map(json.dumps, rows)).encode()

    return "evidence.jsonl", changed


def run(*words: object) -> tuple[int, str]:
    result = CliRunner().invoke(cli, [str(word) for word in words])
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.output


FORGED = "ada\x1b[2J\nthe same verdict, points and diagnosis, forged\u202e"


def test_the_same_verdict_ends_with_0(file: Path) -> None:
    code, said = run("replay", file)
    assert code == 0
    assert said.splitlines() == [
        "lab_1_2.talker by ada, checked 2027-01-15 08:00:00 UTC with course 01234567",
        "then: passed, 10 of 10 points",
        "now:  passed, 10 of 10 points",
        "the same verdict, points and diagnosis",
        "note: any person can write such a file; for proof, have `./course appeal` write it from the class",
    ]


def test_a_replay_as_json_has_both_verdicts(file: Path) -> None:
    code, said = run("replay", file, "--json")
    replay = json.loads(said)["replay"]
    assert (code, replay["differences"]) == (0, [])
    assert replay["then"]["score"] == replay["now"]["score"] == 10


def test_an_edited_verdict_is_not_the_one_that_follows(file: Path, edit: Edit) -> None:
    edit(*seen(lambda rows: rows[0]["verdict"].update(score=3.0, state="failed")))
    code, said = run("replay", file)
    assert code == 1
    assert "state: was failed, is passed" in said
    assert "points: was 3 of 10, is 10 of 10" in said
    assert "any person can write such a file" in said


def test_edited_evidence_is_judged_as_what_it_says(file: Path, edit: Edit) -> None:
    edit("evidence.jsonl", lambda data: data.replace(b'"Hello, world! 3"', b'"Hello, world! 7"'))
    code, said = run("replay", file)
    assert code == 1
    assert "now:  failed" in said
    assert "diagnosis: was none, is" in said


@pytest.mark.parametrize(
    "change",
    [
        about(student=FORGED),
        about(course=FORGED),
        seen(lambda rows: rows[0]["verdict"].update(exercise=FORGED)),
        seen(lambda rows: rows[0]["verdict"]["criteria"][0].update(name=FORGED)),
        seen(lambda rows: rows[-1].update(cut=FORGED)),
    ],
)
def test_a_forged_name_neither_begins_a_line_nor_reaches_the_terminal(
    file: Path, edit: Edit, change: tuple[str, Callable[[bytes], bytes]]
) -> None:
    edit(*change)
    _, said = run("replay", file)
    assert "\x1b" not in said
    assert not any(
        line.startswith("the same verdict, points") and "forged" in line for line in said.splitlines()
    )
    assert "\u202e" not in said


def test_what_is_printed_of_an_honest_file_with_a_forged_name_is_escaped(file: Path, edit: Edit) -> None:
    edit(*about(student=FORGED))
    assert "ada\\x1b[2J\\nthe same verdict, points and diagnosis, forged\\u202e" in run("replay", file)[1]


@pytest.mark.parametrize(
    "change",
    [
        about(student="ada" * 1_000_000),
        seen(lambda rows: rows[-1].update(cut="cut" * 1_000_000)),
        seen(
            lambda rows: rows[0]["verdict"]["criteria"].extend(
                {**rows[0]["verdict"]["criteria"][0], "name": f"criterion {number}"}
                for number in range(10_000)
            )
        ),
    ],
)
def test_a_forged_file_does_not_flood_the_terminal(
    file: Path, edit: Edit, change: tuple[str, Callable[[bytes], bytes]]
) -> None:
    edit(*change)
    _, said = run("replay", file)
    assert len(said) < 10_000


def test_another_reference_output_is_told(file: Path, edit: Edit) -> None:
    edit(*seen(lambda rows: rows[0].update(reference="of long ago")))
    assert "the reference output of this exercise has changed since" in run("replay", file)[1]


def _empty(rows: Rows) -> None:
    for row in rows:
        if isinstance(row, list):
            row[3] = {}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            seen(lambda rows: rows[-1].update(cut="the last 9 lines are missing")),
            "no verdict follows from it",
        ),
        (seen(lambda rows: rows.__delitem__(slice(1, -1))), "the judge saw nothing in this check"),
        (
            seen(lambda rows: rows[0]["verdict"].update(exercise="lab_1_2.talkr")),
            "did you mean lab_1_2.talker",
        ),
        (seen(_empty), "cannot be decided from this evidence"),
    ],
)
def test_what_cannot_be_judged_again_ends_with_2(
    file: Path, edit: Edit, change: tuple[str, Callable[[bytes], bytes]], words: str
) -> None:
    edit(*change)
    code, said = run("replay", file)
    assert code == 2
    assert words in said
    assert "Traceback" not in said


@pytest.mark.parametrize("at", ["NaN", "1e308", "-1000000000000000000"])
def test_a_time_that_none_can_be_ends_with_2(file: Path, edit: Edit, at: str) -> None:
    edit("evidence.jsonl", lambda data: data.replace(b'{"at": 1800000000.0', f'{{"at": {at}'.encode()))
    code, said = run("replay", file)
    assert code == 2
    assert "is not a valid appeal file" in said


def test_a_file_that_is_none_ends_with_2(tmp_path: Path) -> None:
    code, said = run("replay", tmp_path / "none.json")
    assert code == 2
    assert said.startswith("autograder: ")
