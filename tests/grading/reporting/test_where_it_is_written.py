"""What stands in the way of a file that was asked for, or cannot be read, is said in a line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from autograder.cli import cli
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import FakeEngine, TinyClass


@pytest.mark.parametrize(("command", "output", "said"), cases(__file__, "what_stands_in_the_way_is_named"))
def test_what_stands_in_the_way_is_named(
    tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path, command: tuple[str, ...], output: str, said: str
) -> None:
    for student in ("ada", "ben"):
        tiny.submit(student)
    tiny.grade()
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    (tmp_path / "with" / "students.csv").mkdir(parents=True)
    name, *options = command
    result = CliRunner().invoke(cli, [name, str(tiny.path), *options, "--output", str(tmp_path / output)])
    assert result.exit_code == 2, result.output
    assert str(tmp_path) in result.output
    assert said in result.output
    assert "--output" in result.output
    assert (tmp_path / "file").read_text() == "mine"
    assert not list((tmp_path / "folder").iterdir())


def test_a_list_that_is_no_gradebook_is_refused(
    tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path
) -> None:
    tiny.submit("ada")
    tiny.grade()
    into = tmp_path / "list.csv"
    into.write_bytes(b"PK\x03\x04 a workbook, renamed\xff\0")
    result = CliRunner().invoke(cli, ["export", str(tiny.path), "--to", "canvas", "--into", str(into)])
    assert result.exit_code == 2, result.output
    assert "Download it from the LMS again" in result.output.replace("\n", " ")
