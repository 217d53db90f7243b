"""`ros2 interface show`: an interface file, with the definitions of its nested types below each field."""

from __future__ import annotations

import argparse
import re  # noqa: TID251  (not what a student handed in)
import sys
from typing import TYPE_CHECKING, Any

from course_runtime.ros2_command.commands import Outcome, Verb
from course_runtime.ros2_command.interface_types import interface_file

if TYPE_CHECKING:
    from collections.abc import Sequence

_SEPARATOR = "---"
_BASIC = frozenset(
    {"bool", "byte", "char", "string", "wstring", "float32", "float64"}
    | {f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}
)
_FIELD = re.compile(r"^(?P<type>[A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]\w*(?!\s*=)\b(?!\s*=)")
_QUOTED_OR_COMMENT = re.compile(r"""("(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')|(\s*#.*)$""")


def nested_type(line: str, package: str) -> str | None:
    """Return the interface type of the field on this line; None for a basic type or a line without a field."""
    match = _FIELD.match(line)
    if match is None or match["type"] in _BASIC:
        return None
    name = match["type"]
    if "/" not in name:
        name = f"std_msgs/{name}" if name == "Header" else f"{package}/{name}"
    package_name, _, last = name.partition("/")
    return f"{package_name}/msg/{last.rpartition('/')[2]}"


def without_comment(line: str) -> str:
    """Return a line without its comment. A `#` inside quotes does not begin a comment."""
    return _QUOTED_OR_COMMENT.sub(lambda match: match[1] or "", line).strip()


def definition(name: str, *, comments: bool, nested_comments: bool, level: int = 0) -> list[str]:
    """Return the lines of an interface and of its nested types, indented by tabs.

    Raises:
        ValueError, LookupError: The interface does not exist.
    """
    lines: list[str] = []
    for raw in interface_file(name).read_text(encoding="utf-8").splitlines():
        line = raw.rstrip()
        shown = line if comments else without_comment(line)
        if shown or comments:
            lines.append(f"{level * chr(9)}{shown}" if shown else "")
        nested = None if line == _SEPARATOR else nested_type(line, name.partition("/")[0])
        if nested:
            lines += definition(
                nested, comments=nested_comments, nested_comments=nested_comments, level=level + 1
            )
    return lines


class _TypeOrStdin(argparse.Action):
    """Reads the type from the command line or, if it is `-`, from a pipe."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,  # noqa: ARG002 (argparse's signature)
    ) -> None:
        if values == "-":
            if sys.stdin.isatty():
                parser.error("expected stdin pipe")
            values = sys.stdin.readline().strip()
        if not values:
            parser.error("the passed value is empty")
        setattr(namespace, self.dest, values)


def _arguments(parser: argparse.ArgumentParser) -> None:
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--all-comments",
        action="store_true",
        help="Show all comments, including for nested interface definitions",
    )
    group.add_argument("--no-comments", action="store_true", help="Show no comments or whitespace")
    parser.add_argument(
        "type",
        action=_TypeOrStdin,
        help="Show an interface definition (e.g. 'example_interfaces/msg/String'). Passing '-' reads the "
        "argument from stdin (e.g. 'ros2 topic type /chatter | ros2 interface show -').",
    )


def _show(args: argparse.Namespace) -> Outcome:
    try:
        lines = definition(args.type, comments=not args.no_comments, nested_comments=args.all_comments)
    except (ValueError, LookupError) as error:
        return str(error.args[0])
    print(*lines, sep="\n")
    return None


VERBS = {"show": Verb(_arguments, _show)}
