"""A name that a student has chosen reaches no terminal as it is, whatever command an instructor types."""

from __future__ import annotations

import contextlib
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from rich.text import Text

from autograder import standard_output
from autograder.__main__ import main
from autograder.cli import GROUPS
from autograder.grading.cluster import dask_worker
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

    from tiny_class import TinyClass

PLANTED = (
    "\x1b]0;pwn\x07",  # a title for the window
    "\x9b31mred",  # a color, by a control character of eight bits
    "\u202eada",  # reversed
    "a\nPASSED: ben",  # another line
    "b\rPASSED: ben",  # the same line again
    "\udcffc",  # no text
    "\u2066d\u2069 \u2028e",  # isolated, and a line end of Unicode
)
RAW = re.compile(
    "[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\u2028\u2029]|^PASSED", re.M
)
NAME = "".join(PLANTED)
SERVERS = {"lab", "demo", "site", "build"}  # with a name as an argument they would begin something long


@pytest.fixture
def typed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., str]:
    """What a terminal gets of a command, which runs in this process."""

    def run(*words: str) -> str:
        terminal = tmp_path / "terminal"
        with monkeypatch.context() as patch, terminal.open("w") as out, terminal.open("a") as err:
            patch.setattr(sys, "argv", ["autograder", *words])
            patch.setattr(sys, "stdout", out)
            patch.setattr(sys, "stderr", err)
            with contextlib.suppress(SystemExit):
                main()
            for stream in (sys.stdout, sys.stderr):
                stream.flush()
            return terminal.read_bytes().decode("utf-8", "surrogateescape")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    return run


@pytest.fixture
def planted(tiny: TinyClass) -> TinyClass:
    """A class in which students' folders and files have such names."""
    for name in PLANTED:
        folder = tiny.path / "submitted" / name / "lab_1_2"
        folder.mkdir(parents=True)
        (folder / "lab_1_2.ipynb").write_text("{}")
        (tiny.path / "submitted" / "ada" / name).mkdir(parents=True)
    return tiny


COMMANDS = [str(command.name) for commands in GROUPS.values() for command in commands]


FIRST = {"new-class": [NAME, "--assignment", NAME]}
"""What is typed in place of the name alone, which would make a whole class."""


@pytest.mark.parametrize("command", [name for name in COMMANDS if name not in SERVERS])
def test_a_name_that_is_typed_or_completed_is_escaped(
    typed: Callable[..., str], monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.setattr(dask_worker, "_CONNECT_SECONDS", 0.1)
    for words in (FIRST.get(command, [NAME]), [NAME, NAME, NAME], [f"--{NAME}"]):
        shown = typed(command, *words)
        assert not RAW.search(shown), shown


@pytest.mark.parametrize(
    "words",
    [
        ["grade", "--student", "nobody"],
        ["grade", "--dry-run"],
        ["report"],
        ["export", "--to", "csv"],
        ["attempts", NAME],
        ["appeal", NAME, "lab_1_2.talker"],
    ],
    ids=lambda words: " ".join(words[:2]).partition("\x1b")[0],
)
def test_names_in_a_class_are_escaped(
    planted: TinyClass, typed: Callable[..., str], words: list[str]
) -> None:
    shown = typed(words[0], str(planted.path), *words[1:])
    assert not RAW.search(shown), shown
    if words[0] == "grade":
        assert "a\\nPASSED: ben" in shown


def test_names_in_a_download_are_escaped(
    planted: TinyClass, typed: Callable[..., str], tmp_path: Path
) -> None:
    download = tmp_path / "download"
    for name in PLANTED:
        (download / name).mkdir(parents=True)
        shutil.copy(planted.path / "release/lab_1_2/lab_1_2.ipynb", download / name / f"{name}.ipynb")
    shown = typed("collect", str(planted.path), str(download))
    assert "PASSED: ben" in shown
    assert not RAW.search(shown), shown


def test_whatever_prints_goes_through_the_same_exit(tmp_path: Path) -> None:
    program = tmp_path / "prints.py"
    program.write_text(f"NAME = {NAME!r}\n{cases(__file__, 'PRINTS')}")
    done = subprocess.run([sys.executable, str(program)], capture_output=True, check=False)
    shown = (done.stdout + done.stderr).decode("utf-8", "surrogateescape")
    assert shown.count("\\x1b]0;pwn") >= 6
    assert not re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e\u2066]", shown), shown


def test_a_table_keeps_its_own_styles_and_lines(capsys: pytest.CaptureFixture[str]) -> None:
    console = standard_output.console()
    console._color_system = None
    console.print(Text("bold\x1b[2J", style="bold"))
    assert capsys.readouterr().out == "bold\\x1b[2J\n"


def test_no_console_is_made_elsewhere() -> None:
    root = Path(standard_output.__file__).parent
    made = [
        f"{file.relative_to(root)}:{number}"
        for file in root.rglob("*.py")
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1)
        if re.search(r"(?<!Guarded)\bConsole\((?!quiet=True)", line) and file.name != "standard_output.py"
    ]
    assert made == []
