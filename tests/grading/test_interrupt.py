"""Ctrl-C while a class is graded."""

from __future__ import annotations

from typing import TYPE_CHECKING

from click.testing import CliRunner

from autograder.cli import cli
from autograder.grading import batch

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_it_says_what_was_kept_and_how_to_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(batch, "grade", interrupted)
    result = CliRunner().invoke(cli, ["grade", str(tmp_path)])
    assert result.exit_code == 130
    assert "type the same command to grade the rest" in result.output
