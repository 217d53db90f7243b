"""What ``grade --json`` prints."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner

from autograder.cli import cli
from autograder.grading.running import execution_backends

if TYPE_CHECKING:
    from tiny_class import FakeEngine, TinyClass


@pytest.fixture(autouse=True)
def _unboxed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(execution_backends, "require_sandbox", lambda _: None)


def said(tiny: TinyClass, *options: str) -> dict[str, Any]:
    result = CliRunner().invoke(cli, ["grade", str(tiny.path), "--json", *options])
    printed: dict[str, Any] = json.loads(result.stdout)
    return printed


def test_names_that_are_no_text_break_no_json(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    beside = tiny.submit("ada", 10, 4).with_name(os.fsdecode(b"old\xff.ipynb"))
    beside.write_text("{}")
    (tiny.path / "submitted" / os.fsdecode(b"M\xfcller") / "lab_1_2").mkdir(parents=True)
    found = said(tiny)
    assert [one["student"] for one in found["submissions"]] == ["ada"]
    assert any("M?ller" in one["path"] for one in found["refused"])


def test_it_is_one_object_with_submissions_and_totals(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada", 10, 4)
    tiny.submit("ben", "'die'")
    first = said(tiny)
    assert [(one["student"], one["score"], one["max_score"]) for one in first["submissions"]] == [
        ("ada", 14.0, 20.0),
        ("ben", 10.0, 20.0),
    ]
    exercise = first["submissions"][0]["exercises"][1]
    assert (exercise["exercise"], exercise["score"], exercise["state"]) == ("lab_1_2.listener", 4.0, "failed")
    assert first["exit_code"] == 2
    assert len(first["problems"]) == 1
    totals = first["totals"]
    assert (totals["executed"], totals["reused"], totals["written"], totals["score"]) == (2, 0, 2, 24.0)
    assert first["timings"].keys() == {"first_started", "last_ended"}
    assert said(tiny)["totals"]["reused"] == 1


def test_a_dry_run_says_who_would_get_other_points(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada", 10, 4)
    assert said(tiny)["would_change"] is None
    tiny.submit("ada", 10, 7)
    (change,) = said(tiny, "--dry-run")["would_change"]
    assert (change["student"], change["exercise"], change["before"], change["after"]) == (
        "ada",
        "lab_1_2.listener",
        4.0,
        7.0,
    )
