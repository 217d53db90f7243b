"""Texts that contain substitutions, such as `$(var name)`."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Any

from .. import substitutions
from ..substitution import Substitution, TextSubstitution
from .entity import FrontendError

if TYPE_CHECKING:
    from collections.abc import Callable

Parts = list[Substitution]

# The class of each substitution and its number of arguments, by its name in XML and YAML.
_KNOWN: dict[str, tuple[Callable[..., Substitution], int, int]] = {
    "and": (substitutions.AndSubstitution, 2, 2),
    "anon": (substitutions.AnonName, 1, 1),
    "command": (lambda c, e="fail": substitutions.Command(c, on_stderr=e), 1, 2),
    "dirname": (substitutions.ThisLaunchFileDir, 0, 0),
    "env": (lambda n, d=None: substitutions.EnvironmentVariable(n, default_value=d), 1, 2),
    "equals": (substitutions.EqualsSubstitution, 2, 2),
    "eval": (lambda *words: substitutions.PythonExpression(_joined(words)), 1, 1000),
    "file-content": (substitutions.FileContent, 1, 1),
    "filename": (substitutions.ThisLaunchFile, 0, 0),
    "find-exec": (lambda n: substitutions.FindExecutable(name=n), 1, 1),
    "if": (substitutions.IfElseSubstitution, 1, 3),
    "not": (substitutions.NotSubstitution, 1, 1),
    "not-equals": (substitutions.NotEqualsSubstitution, 2, 2),
    "or": (substitutions.OrSubstitution, 2, 2),
    "var": (lambda n, d=None: substitutions.LaunchConfiguration(n, default=d), 1, 2),
}


def expose_substitution(name: str, kind: Callable[..., Substitution], fewest: int, most: int) -> None:
    """Add a substitution of another package, such as `find-pkg-share`."""
    _KNOWN[name] = (kind, fewest, most)


def _joined(words: tuple[Parts, ...]) -> Parts:
    """Join the words of an expression again."""
    joined: Parts = []
    for word in words:
        joined += [TextSubstitution(text=" "), *word] if joined else word
    return joined


def parse_text(text: str) -> Parts:
    """Return the parts of a text, at least one.

    Raises:
        FrontendError: A substitution is not closed, is unknown, or has a wrong number of arguments.
    """
    reader = _Reader(text)
    return reader.parts(end="") or [TextSubstitution(text="")]


def parse_value(value: Any) -> Any:
    """Return a text with substitutions as a list of its parts; any other value unchanged."""
    if isinstance(value, list):
        return [parse_value(item) for item in value]
    if not isinstance(value, str):
        return value
    parts = parse_text(value)
    if len(parts) == 1 and isinstance(parts[0], TextSubstitution):
        return parts[0].text
    return parts


def parse_command(text: str) -> list[Parts]:
    """Return the words of a command line; a substitution is never split."""
    words: list[Parts] = []
    current: Parts = []
    for part in parse_text(text):
        if not isinstance(part, TextSubstitution):
            current.append(part)
            continue
        if part.text[:1].isspace() and current:
            words.append(current)
            current = []
        for position, word in enumerate(shlex.split(part.text)):
            if position and current:
                words.append(current)
                current = []
            current.append(TextSubstitution(text=word))
        if part.text[-1:].isspace() and current:
            words.append(current)
            current = []
    return [*words, current] if current else words


class _Reader:
    """Reads a text from left to right."""

    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0

    def _next(self) -> str:
        return self._text[self._at : self._at + 1]

    def parts(self, end: str) -> Parts:
        """Read up to one of the characters in `end`, or to the end of the text."""
        found: Parts = []
        plain = ""
        while (character := self._next()) and character not in end:
            if self._text.startswith("$(", self._at):
                found += [TextSubstitution(text=plain)] if plain else []
                plain = ""
                found.append(self._substitution())
                continue
            if character == "\\" and self._at + 1 < len(self._text):
                self._at += 1
                character = self._next()
            plain += character
            self._at += 1
        return [*found, TextSubstitution(text=plain)] if plain else found

    def _substitution(self) -> Substitution:
        start = self._at
        self._at += 2
        name = ""
        while (character := self._next()) and (character.isalnum() or character in "_-"):
            name += character
            self._at += 1
        arguments: list[Parts] = []
        while self._next() == " ":
            while self._next() == " ":
                self._at += 1
            if self._next() != ")":
                arguments.append(self._argument(keep_quotes=name == "eval" and len(arguments) > 0))
        if self._next() != ")":
            raise FrontendError(f"the substitution '{self._text[start:]}' is not closed by a ')'")
        self._at += 1
        return _make(name, arguments)

    def _argument(self, *, keep_quotes: bool) -> Parts:
        quote = self._next()
        if quote not in ("'", '"') or keep_quotes:
            return self.parts(end=" )")
        self._at += 1
        parts = self.parts(end=quote)
        if self._next() != quote:
            raise FrontendError(f"a {quote} is missing in '{self._text}'")
        self._at += 1
        return parts or [TextSubstitution(text="")]


def _make(name: str, arguments: list[Parts]) -> Substitution:
    if name not in _KNOWN:
        raise FrontendError(f"Unknown substitution: {name}")
    kind, fewest, most = _KNOWN[name]
    if not fewest <= len(arguments) <= most:
        wanted = str(fewest) if fewest == most else f"{fewest} to {most}"
        raise FrontendError(f"{name} substitution expects {wanted} argument(s), got {len(arguments)}")
    return kind(*arguments)
