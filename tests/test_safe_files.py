"""Temporary folders whose maker may be killed at any moment, and files that are written in one step."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import pytest

from autograder.safe_files import HeldFolder, UnsafeTemporaryFolder, fresh_folder, write_whole
from tests.cases import cases

MAKER = cases(__file__, "MAKER")


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_it_is_gone_afterwards_with_what_is_in_it(temporary: Path) -> None:
    with HeldFolder("held-") as folder:
        (folder.path / "sub").mkdir()
        assert [folder.path] == list(temporary.iterdir())
    folder.remove()
    assert not list(temporary.iterdir())


def test_the_next_one_removes_what_a_killed_maker_left_and_nothing_else(temporary: Path) -> None:
    command = [sys.executable, "-c", MAKER, str(temporary)]
    (temporary / "other-kind").mkdir()
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as maker:
        assert maker.stdout
        made = maker.stdout.readline().strip()
        with HeldFolder("held-") as second:
            both = {made, str(second.path), str(temporary / "other-kind")}
            assert {str(path) for path in temporary.iterdir()} == both, "its maker lives"
        maker.kill()
    with HeldFolder("held-") as third:
        assert {path.name for path in temporary.iterdir()} == {"other-kind", third.path.name}


def test_what_is_no_folder_is_left_alone(temporary: Path) -> None:
    (temporary / "held-link").symlink_to("/")
    (temporary / "held-file").touch()
    with HeldFolder("held-"):
        pass
    assert {path.name for path in temporary.iterdir()} == {"held-link", "held-file"}


def test_its_name_cannot_be_guessed_and_only_its_maker_can_look_into_it(temporary: Path) -> None:
    first, second = fresh_folder("held-"), fresh_folder("held-")
    assert first.name.removeprefix("held-") != second.name.removeprefix("held-")
    assert first.stat().st_mode & 0o777 == 0o700


def test_where_every_user_can_replace_what_is_made_another_folder_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    everybodys, session = tmp_path / "tmp", tmp_path / "session"
    for folder, mode in ((everybodys, 0o777), (session, 0o700)):
        folder.mkdir()
        folder.chmod(mode)
    monkeypatch.setattr(tempfile, "tempdir", str(everybodys))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(session))
    with HeldFolder("held-") as held:
        assert held.path.parent == session
    session.chmod(0o777)
    with pytest.raises(UnsafeTemporaryFolder, match="set TMPDIR to a folder of your own"):
        HeldFolder("held-")
    everybodys.chmod(0o1777)
    with HeldFolder("held-") as held:
        assert held.path.parent == everybodys


def test_one_that_another_process_removes_before_it_is_locked_is_made_again(
    temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual, made = tempfile.mkdtemp, list[str]()

    def removed_at_first(**how: Any) -> str:
        made.append(usual(**how))
        if len(made) == 1:
            Path(made[0]).rmdir()
        return made[-1]

    monkeypatch.setattr(tempfile, "mkdtemp", removed_at_first)
    with HeldFolder("held-") as held:
        assert [str(held.path)] == made[1:]
    temporary.rmdir()
    with pytest.raises(FileNotFoundError):
        HeldFolder("held-")


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
