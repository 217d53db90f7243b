"""Runs a command line: finds the verb, and returns its exit code."""

from __future__ import annotations

import argparse
import difflib
import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from course_runtime.ros2_command.commands import COMMANDS, ELSEWHERE, TERMINATED, Command, Outcome, Verb

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

FULL = "the full ros2cli (a ROS 2 Jazzy installation)"
_EPILOG = (
    "This is the course's own ros2. It knows the words above as Jazzy's ros2cli does; everything else needs\n"
    f"{FULL}."
)
# The exit code of ros2cli after Ctrl-C, which is the number of the signal.
_INTERRUPTED = 2
_NEEDED = ("rclpy", "ament_index_python", "yaml")


class _Parser(argparse.ArgumentParser):
    """An argument parser whose errors first say what is wrong, and then what to write."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse a command line. If there are too many words, the error names them and says how to quote them."""
        words = list(args)
        found, extra = self.parse_known_args(words, namespace)
        if extra:
            self.error("\n".join(_about_extra(self.prog, words, extra)))
        return found

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: error: {message}\n\n{self.format_usage()}")


def _about_extra(prog: str, words: Sequence[str], extra: Sequence[str]) -> Iterator[str]:
    """Return what is wrong with words that no argument takes."""
    options = [word for word in extra if word.startswith("-")]
    rest = [word for word in extra if word not in options]
    if rest:
        yield f"too many words: {' '.join(rest)}"
        # A shell splits `{data: Hello you}` into three words.
        at = words.index(rest[0])
        whole = " ".join(words[max(at - 1, 0) : at + len(rest)])
        if ":" in whole or whole.startswith(("{", "[")):
            yield f"Put a value with spaces into quotes: {shlex.quote(whole)}"
    if options:
        yield f"unknown option: {' '.join(options)}"
        yield f"`{prog} -h` lists the options that the course's ros2 has; any other needs {FULL}."


def _parser(prog: str, description: str, epilog: str | None = None) -> _Parser:
    return _Parser(
        prog=prog,
        description=description,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )


def _listing(summaries: dict[str, str]) -> str:
    width = max(map(len, summaries))
    return "".join(f"{name.ljust(width)}  {summaries[name]}\n" for name in sorted(summaries))


def _needs_full(words: str, hint: str = "") -> int:
    print(f"ros2: `{words}` needs {FULL}.{' ' + hint if hint else ''}", file=sys.stderr)
    return 2


def _add_words(parser: argparse.ArgumentParser, summaries: dict[str, str], prog: str) -> None:
    """Add sub-commands to a parser, for its help and for the error about a wrong word."""
    words = parser.add_subparsers(
        title="Commands",
        description=_listing(summaries),
        metavar=f"Call `{prog} <command> -h` for more detailed usage.",
    )
    for name in sorted(summaries):
        words.add_parser(name)


def _parse(prog: str, summary: str, verb: Verb, argv: list[str]) -> argparse.Namespace:
    parser = _parser(prog, summary)
    verb.arguments(parser)
    return parser.parse_args(argv)


def _word_in(argv: list[str]) -> int:
    """Return the index of the first word that is not an option; the length of the list if there is none."""
    return next((i for i, word in enumerate(argv) if not word.startswith("-")), len(argv))


def _at(argv: list[str], position: int) -> str:
    """Return the word at an index; an empty word after the end."""
    return argv[position] if position < len(argv) else ""


def _group(prog: str, command: Command, argv: list[str]) -> Outcome:
    """Run a command that consists of verbs."""
    at = _word_in(argv)
    name = _at(argv, at)
    if name in command.elsewhere:
        return _needs_full(f"{prog} {name}")
    if name in command.verbs and not {"-h", "--help"} & set(argv[:at]):
        word = command.verbs[name]
        # Options may come before the verb (`ros2 topic --include-hidden-topics list`).
        args = _parse(f"{prog} {name}", word.summary, verb := word.load(name), argv[:at] + argv[at + 1 :])
        return verb.main(args)
    parser = _parser(prog, command.summary)
    if command.option:
        parser.add_argument(command.option[0], action="store_true", help=command.option[1])
    _add_words(parser, {name: word.summary for name, word in command.verbs.items()}, prog)
    _check_word(parser, name, command.verbs)
    parser.parse_args(argv)
    parser.print_help()
    return 0


def _check_word(parser: _Parser, name: str, known: Iterable[str]) -> None:
    """End with an error if a word is unknown. The error suggests a similar word."""
    if name and name not in known:
        close = difflib.get_close_matches(name, known, n=1)
        meant = f"Did you mean `{parser.prog} {close[0]}`? " if close else ""
        parser.error(f"the word '{name}' does not exist here. {meant}`{parser.prog} -h` lists all.")


def _dispatch(argv: list[str]) -> Outcome:
    at = _word_in(argv)
    name = _at(argv, at)
    if name in ELSEWHERE:
        return _needs_full(f"ros2 {name}", ELSEWHERE[name])
    if name not in COMMANDS or {"-h", "--help"} & set(argv[:at]):
        parser = _parser("ros2", "ros2 is an extensible command-line tool for ROS 2.", _EPILOG)
        parser.add_argument("--use-python-default-buffering", action="store_true", help=argparse.SUPPRESS)
        parser.add_argument("--version", action="store_true", help="Print the version and exit")
        if "--version" in argv[:at]:
            print(_version())
            return 0
        _add_words(parser, {name: command.summary for name, command in COMMANDS.items()}, "ros2")
        _check_word(parser, name, COMMANDS)
        parser.parse_args(argv)
        parser.print_help()
        return 0
    command, rest = COMMANDS[name], argv[at + 1 :]
    if "--use-python-default-buffering" not in argv[:at]:
        _line_buffered()
    if command.itself:
        verb = command.itself.load(name)
        return verb.main(_parse(f"ros2 {name}", command.summary, verb, rest))
    return _group(f"ros2 {name}", command, rest)


def _version() -> str:
    """Return which ros2 this is, with the version of rclpy that it uses."""
    from ament_index_python import get_resource

    _, prefix = get_resource("packages", "rclpy")
    manifest = Path(prefix, "share", "rclpy", "package.xml").read_text(encoding="utf-8")
    version = manifest.partition("<version>")[2].partition("</version>")[0]
    return f"ros2 of the course, for ROS 2 Jazzy (rclpy {version})"


def _line_buffered() -> None:
    """Write each line at once, even to a pipe or in a notebook's cell."""
    reconfigure = getattr(sys.stdout, "reconfigure", None)
    if reconfigure:
        reconfigure(line_buffering=True)


def _find_packages_here() -> None:
    """Add this environment's own packages, if missing, after those of the sourced workspaces."""
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    if sys.prefix not in prefixes:
        os.environ["AMENT_PREFIX_PATH"] = os.pathsep.join([*prefixes, sys.prefix])


def run(argv: list[str]) -> int:
    """Run one command, and return its exit code, which is that of ros2cli.

    Returns:
        0 for success; 1 for an error, which is printed on stderr; 2 for unknown words or options, and after Ctrl-C;
        15 after SIGTERM; or the exit code of the program that was run.
    """
    _find_packages_here()
    try:
        outcome = _dispatch(argv)
    except KeyboardInterrupt:
        return _INTERRUPTED
    except BrokenPipeError:
        # The reader has ended (`ros2 topic echo … | head`). End quietly, and keep Python from flushing again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except RuntimeError as error:
        outcome = str(error)
    except ModuleNotFoundError as error:
        if error.name not in _NEEDED:
            raise
        outcome = (
            f"ros2: {error.name} is not installed in this environment ({sys.prefix}): run ./course setup"
        )
    except Exception as error:
        # Not every command imports rclpy, so its exception is recognized by name.
        if type(error).__name__ != "ExternalShutdownException":
            raise
        return TERMINATED
    if isinstance(outcome, str):
        print(outcome, file=sys.stderr)
        return 1
    return outcome or 0


def main() -> int:
    """Run `ros2`: start the real one if it exists, else run the command here."""
    from course_runtime.ros2_command.real_installation import run_real_command

    run_real_command()
    if "_ARGCOMPLETE" in os.environ:
        from course_runtime.ros2_command.completion import complete

        _find_packages_here()
        complete()
    return run(sys.argv[1:])
