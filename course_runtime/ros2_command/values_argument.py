"""The values of a message, request or goal on the command line: YAML, or read from standard input."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse


def add_values_argument(parser: argparse.ArgumentParser, name: str, text: str, stdin_text: str) -> None:
    """Add a positional argument for the values and `--stdin`, which exclude each other."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument(name, nargs="?", default="{}", help=text)
    group.add_argument("--stdin", action="store_true", help=stdin_text)


def given_values(args: argparse.Namespace, name: str) -> str | bytes:
    """Return the text of the values, from the command line or from standard input."""
    return sys.stdin.buffer.read() if args.stdin else str(getattr(args, name))
