"""The commands that the pages tell people to type, and whether the real command lines understand them.

Nothing is run: the parsers of the programs themselves read the words, and stop there.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import re
import runpy
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import pytest
from traitlets import import_item

from autograder.cli import cli
from course_runtime.python_child import installed_program
from course_runtime.ros2_command.commands import COMMANDS, ELSEWHERE
from course_runtime.ros2_command.completion import parser_for

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

ROOT = Path(__file__).resolve().parents[1]
PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("docs/**/*.md")))
COURSE = "./course"
_FENCE = re.compile(r"^(`{3,})(\w*)\n(.*?)^\1`*[ \t]*$", re.MULTILINE | re.DOTALL)
_INLINE = re.compile(r"(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)", re.DOTALL)
_NEXT = re.compile(r"\s*(?:&&|;|\|)\s*(?:do\s+)?")
_PROGRAMS = re.compile(r"(?:\S*/course|autograder|pip|git|ros2|colcon|\S*python3? -m \S+)(?= |$)")
_SCRIPTS = {"setup": "environment.bootstrap", "benchmark": "benchmarks.__main__"}
"""The words of ``./course`` that are modules with a parser of their own."""
_WITHOUT_PARSER = {"autograder.workspaces": 2}
"""How many words a module takes that has no parser."""
_PLACEHOLDERS = {"…": "ANY", "WHAT": "--help"}
"""The words of the pages for what a reader fills in, if not every word would do."""

Words = tuple[str, ...]


@dataclass(frozen=True)
class Typed:
    """A command on a page.

    Attributes:
        page: The path of the page in the course.
        words: The words, as a shell splits them.
        in_block: Whether it stands in a block, for a reader to type it.
    """

    page: str
    words: Words
    in_block: bool

    @property
    def whole(self) -> bool:
        """Whether the arguments are there; a sentence may name a command without them."""
        return self.in_block or bool(split_command(self.words)[1])


class NotUnderstood(Exception):
    """A command line refuses the words. The message is what it says."""


def documented() -> list[Typed]:
    """Return the commands of all pages."""
    return [typed for page in PAGES for typed in commands_of(page.read_text(encoding="utf-8"), page)]


def commands_of(text: str, page: Path) -> Iterator[Typed]:
    """Find the commands of a page, in blocks and in sentences."""
    name = str(page.relative_to(ROOT))
    for block in _FENCE.finditer(text):
        for line in block[3].splitlines():
            if line.startswith("$ "):
                parts = _NEXT.split(line[2:])
            elif block[2]:
                continue  # a program, or what a command prints
            else:
                parts = re.split(r" {2,}", line)[:1]  # the description of a command stands beside it
            yield from (Typed(name, words, in_block=True) for part in parts if (words := _words(part)))
    for span in _INLINE.finditer(_FENCE.sub("", text)):
        if words := _words(" ".join(span[2].split())):
            yield Typed(name, words, in_block=False)


def _words(text: str) -> Words:
    if not _PROGRAMS.match(text):
        return ()
    typed = shlex.split(text, comments=True)
    first, *rest = (_PLACEHOLDERS.get(word, word) for word in typed)
    if first.endswith(("python", "python3")):
        first = "python"
    if rest[:2] == ["-m", "autograder"]:
        first, rest = COURSE, rest[2:]
    if first.endswith("/course") or first == "autograder":
        first = COURSE
    return (first, *rest)


def split_command(words: Words) -> tuple[Words, Words]:
    """Split the words of a command from those of its arguments."""
    length = 2
    if words[0] == "python":
        length = 4 if words[2:3] == ("tests.measure",) else 3
    elif words[0] == "ros2" and (command := COMMANDS.get(words[1] if len(words) > 1 else "")):
        length = 2 if command.itself else 3
    elif words[:2] == (COURSE, "nbgrader"):
        length = 2 + len(_nbgrader_command(words[2:])[0])
    elif words[:2] == (COURSE, "jupyter"):
        length = 3
    return words[:length], words[length:]


def why_not_understood(typed: Typed, pytest_parser: Any) -> str:
    """Return what a command line says against the words; empty if it understands them."""
    command, arguments = split_command(typed.words)
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(said):
            _parser_of(command, pytest_parser)(arguments if typed.whole else ("--help",))
    except NotUnderstood as error:
        return f"{typed.page}: {shlex.join(typed.words)}: {error}"
    except SystemExit as end:
        if end.code:
            return f"{typed.page}: {shlex.join(typed.words)}: {said.getvalue().strip()}"
    return ""


def _parser_of(command: Words, pytest_parser: Any) -> Callable[[Words], object]:
    """Return what reads the arguments of a command."""
    if len(command) == 1:  # a sentence names a program
        return lambda _: None
    program, name = command[:2]
    if program == "python":
        module = command[2]
        if module == "pytest":
            return lambda words: _pytest(words, pytest_parser)
        return lambda words: _module(module, (*command[3:], *words))
    if program == COURSE:
        special: dict[str, Callable[[Words], object]] = {
            "help": lambda _: None,
            "test": lambda words: _pytest(words, pytest_parser),
            "nbgrader": lambda words: _nbgrader((*command[2:], *words)),
            "jupyter": lambda _: _installed(f"jupyter-{command[-1]}"),
        }
        if name in _SCRIPTS:
            return lambda words: _module(_SCRIPTS[name], words)
        return special.get(name) or (lambda words: _click(name, words))
    others: dict[str, Callable[[Words], object]] = {
        "ros2": lambda words: _ros2((*command[1:], *words)),
        "pip": lambda words: _pip(name, words),
        "git": lambda words: _usage("git", name, "-h"),
        "colcon": lambda words: _usage(str(installed_program("colcon")), name, *words, "--help"),
    }
    return others[program]


def _click(name: str, words: Words) -> None:
    command, rest = (cli, [name, *words]) if name.startswith("-") else (cli.commands.get(name), list(words))
    if command is None:
        raise NotUnderstood(f"there is no command {name}")
    try:
        command.make_context(name, rest)
    except click.exceptions.Exit:
        pass  # --help
    except click.ClickException as error:
        raise NotUnderstood(error.format_message()) from error


def _module(name: str, words: Words) -> None:
    """Have the parser of a module read words; the module does nothing else."""
    if name in _WITHOUT_PARSER:
        if words != ("--help",) and len(words) != _WITHOUT_PARSER[name]:
            raise NotUnderstood(f"it takes {_WITHOUT_PARSER[name]} words")
        return
    real = argparse.ArgumentParser.parse_args

    def only_parse(self: argparse.ArgumentParser, args: Any = None, namespace: Any = None) -> None:
        real(self, args, namespace)
        raise SystemExit(0)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(argparse.ArgumentParser, "parse_args", only_parse)
        patched.setattr(sys, "argv", [name, *words])
        try:
            runpy.run_module(name, run_name="__main__")
        except ImportError as error:
            raise NotUnderstood(str(error)) from error


def _pytest(words: Words, parser: Any) -> None:
    found, unknown = parser.parse_known_and_unknown_args(list(words))
    missing = [file for file in found.file_or_dir if not (ROOT / file.partition("::")[0]).exists()]
    if unknown or missing:
        raise NotUnderstood(f"pytest does not know {[*unknown, *missing]}")


def _ros2(words: Words) -> None:
    verb = words[1] if len(words) > 1 else ""
    if words[0] in ELSEWHERE or (words[0] in COMMANDS and verb in COMMANDS[words[0]].elsewhere):
        return  # the pages name these as commands of a whole installation
    parser_for(list(words)).parse_args(list(words))


def _pip(name: str, words: Words) -> None:
    from pip._internal.commands import create_command
    from pip._internal.exceptions import CommandError

    try:
        create_command(name).parse_args(list(words))
    except CommandError as error:
        raise NotUnderstood(str(error)) from error
    except KeyError as error:
        raise NotUnderstood(f"pip has no command {name}") from error


def _nbgrader_command(words: Words) -> tuple[Words, Any]:
    """Return the words that are commands within commands of nbgrader, and the last one's application."""
    from nbgrader.apps import NbGraderApp

    application: Any = NbGraderApp
    names = []
    for word in words:
        if word not in (known := application().subcommands):
            break
        application = known[word][0]
        if isinstance(application, str):
            application = import_item(application)
        names.append(word)
    return tuple(names), application()


def _nbgrader(words: Words) -> None:
    names, application = _nbgrader_command(words)
    rest = [word for word in words[len(names) :] if word != "--help"]
    known = {*application.flags, *application.aliases}
    options = [word.lstrip("-").partition("=")[0] for word in rest if word.startswith("-")]
    unknown = [one for one in options if one not in known and "." not in one]
    if application.subcommands:
        unknown += rest
    if unknown:
        raise NotUnderstood(f"nbgrader does not know {unknown}")


def _installed(program: str) -> None:
    if not installed_program(program).exists():
        raise NotUnderstood(f"there is no program {program}")


def _usage(*words: str) -> None:
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if "usage:" not in done.stdout or done.returncode == 2:
        raise NotUnderstood(done.stderr.strip() or done.stdout.strip())
