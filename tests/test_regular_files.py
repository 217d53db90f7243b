"""Files that are written in one step."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from pathlib import Path


def test_a_link_that_another_user_has_put_there_is_not_written_through(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    victim, shared = tmp_path / "gradebook", tmp_path / "shared"
    shared.mkdir()
    victim.write_text("points")
    (shared / f".report.html.{os.getpid()}.new").symlink_to(victim)
    write_whole(shared / "report.html", b"a page")
    monkeypatch.setattr("secrets.randbelow", lambda _: 7)
    (shared / ".report.html.7.new").symlink_to(victim)
    with pytest.raises(FileExistsError):
        write_whole(shared / "report.html", b"another page")
    assert victim.read_text() == "points"
    assert (shared / "report.html").read_text() == "a page"
