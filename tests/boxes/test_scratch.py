"""A temporary folder whose maker may be killed at any moment."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from typing import TYPE_CHECKING

import pytest

from autograder.boxes.scratch import HeldFolder

if TYPE_CHECKING:
    from pathlib import Path

MAKER = """
import sys, tempfile
tempfile.tempdir = sys.argv[1]
from autograder.boxes.scratch import HeldFolder
folder = HeldFolder("held-")
(folder.path / "socket").touch()
print(folder.path, flush=True)
sys.stdin.read()
"""


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
