"""``%%program`` writes a file with the student's newest definitions."""

from __future__ import annotations

import ast
import errno
import os
from typing import TYPE_CHECKING, Any

import pytest
from jupyter_client.manager import start_new_kernel

from autograder.masters.code_cells import COPIED
from autograder.notebook import program_magic
from autograder.notebook.program_magic import NotRunError, NotWrittenError, with_definitions
from tests.cases import named_cases

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

OLD = "class Talker(Node):\n    pass"
NEW = "class Talker(Node):\n    TOPIC = 'chatter'"
PROGRAM = f"import rclpy\nfrom rclpy.node import Node\n\n\n{COPIED}Talker\n\n\nrclpy.spin(Talker())\n"


def test_the_newest_definition_takes_the_place_of_the_comment() -> None:
    text = with_definitions(PROGRAM, ["", OLD, "Talker = None", NEW, "x = 1"])
    assert text == PROGRAM.replace(f"{COPIED}Talker", NEW)


@pytest.mark.parametrize("cell", named_cases(__file__, "other_cells_give_only_helpers"))
def test_other_cells_give_only_helpers(cell: str) -> None:
    own = "class Talker(Node):\n    def say(self, text):\n        return node, text"
    assert with_definitions(PROGRAM, [cell, own]) == PROGRAM.replace(f"{COPIED}Talker", own)


@pytest.mark.parametrize(("cells", "has"), named_cases(__file__, "what_the_definition_uses_comes_along"))
def test_what_the_definition_uses_comes_along(cells: list[str], has: str) -> None:
    text = with_definitions(PROGRAM, cells)
    assert has in text
    ast.parse(text)
    assert text.count("import Node") == 1


@pytest.mark.parametrize("cells", [[], ["from there import Talker"], ["talker = 1"]])
def test_a_definition_that_has_not_run_is_asked_for(cells: list[str]) -> None:
    with pytest.raises(NotRunError, match="Run the cell that defines Talker first"):
        with_definitions(PROGRAM, cells)


def test_a_text_without_the_comment_is_written_as_it_is() -> None:
    assert with_definitions("print('my own')\n", [NEW]) == "print('my own')\n"
    assert with_definitions(PROGRAM.replace(f"{COPIED}Talker", OLD), [NEW]).count("chatter") == 0


@pytest.fixture
def kernel(tmp_path: Path) -> Iterator[Any]:
    manager, client = start_new_kernel(kernel_name="python3", cwd=str(tmp_path))
    yield client
    client.stop_channels()
    manager.shutdown_kernel(now=True)


def run(client: Any, code: str) -> str:
    words: list[str] = []
    client.execute_interactive(
        code,
        timeout=60,
        output_hook=lambda message: words.append(
            message["content"].get("text") or "".join(message["content"].get("traceback", ()))
        ),
    )
    return "".join(words)


@pytest.mark.slow
def test_a_student_runs_two_cells_and_copies_nothing(kernel: Any, tmp_path: Path) -> None:
    run(kernel, "import autograder.notebook")
    cell = f"%%program hello.py\n{COPIED}hello\nprint(hello())"
    assert "Nothing was written. Run the cell that defines hello first" in run(kernel, cell)
    assert not (tmp_path / "hello.py").exists()
    for word, said in (("hello", "Writing"), ("good bye", "Overwriting")):
        run(kernel, f"def hello():\n    return {word!r}")
        assert said in run(kernel, cell)
        assert run(kernel, "!python3 hello.py").strip() == word


@pytest.mark.slow
def test_a_file_that_has_the_text_is_not_written_again(kernel: Any, tmp_path: Path) -> None:
    run(kernel, "import autograder.notebook")
    file = tmp_path / "CMakeLists.txt"
    assert run(kernel, "%%writefile CMakeLists.txt\none\n").strip() == "Writing CMakeLists.txt"
    file.chmod(0o755)
    before = file.stat().st_ctime_ns
    assert run(kernel, "%%writefile CMakeLists.txt\none\n").strip() == "Unchanged CMakeLists.txt"
    assert file.stat().st_ctime_ns == before
    assert run(kernel, "%%writefile CMakeLists.txt\ntwo\n").strip() == "Overwriting CMakeLists.txt"
    assert run(kernel, "%%writefile -a CMakeLists.txt\nthree\n").strip() == "Overwriting CMakeLists.txt"
    assert (file.read_text(), file.stat().st_mode & 0o777) == ("two\nthree\n", 0o755)


def test_a_full_disk_leaves_the_file_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    file = tmp_path / "package.xml"
    file.write_text("<package/>")
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(NotWrittenError, match="cannot be written: No space left on device"):
        program_magic._write(file, "<package></package>")
    assert file.read_text() == "<package/>"
    assert list(tmp_path.iterdir()) == [file]
