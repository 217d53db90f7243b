"""Plain English: recurring faults in the prose of code and pages, listed by ``python -m tests.english``.

A pattern finds what is worth a second look, and some places are right as they are. So the number of places is held: it
must not become larger, and if you get below it, lower it. Rewrite your places from what the code does, and never by
replacing a word. ``./course test`` runs this beside ruff.
"""

from __future__ import annotations

import io
import sys
import tokenize
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import re2

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[1]
CODE = ("autograder", "course_runtime", "environment")
TEXTS = {
    *("about", "card", "cause", "choices", "do", "means", "next", "next_step", "purpose"),
    *("question", "right", "seen", "sooner", "task", "text", "title"),
}
"""The keys of the TOML files with texts that people read: cards, known errors, tickets.

The ``why`` of an answer is often the first line of its program, whose evidence is kept: a new word makes it stale.
"""
CEILING = 21
"""The number of places that there were when this was last lowered."""


class Fault(NamedTuple):
    """A fault, with the pattern that finds it, and one for what only looks like it."""

    name: str
    found: str
    right: str = r"[^\s\S]"


_PLACE = r"\b[Ww]here (?:an?|it|no|nothing|one|she|he|the|they|this|there) "
_NOT_A = r"\b(?:is|are|was|were|be) no [A-Za-z]"
_THERE_IS_NO = r"\b[Tt]here (?:is|are|was|were) no |no (?:longer|more)\b"
_ASKS = r"^What (?:an?|are|can|did|do|does|happened|happens|is|to|was|were) |\?|\|"
_OLD = r"\banew\b|\b[Aa]lso (?:if|where) |\bin place of\b|\bmend(?:s|ed|ing)?\b"
_BRITISH = (
    r"(?i)colour|behaviour|neighbour|favour|honour|artefact|catalogue|licence|judgement|\bgrey\b|\bcentre"
    r"|(?:recogn|organ|serial|initial|normal|summar|minim|maxim|optim|visual)is(?:e|ing|ation)"
    r"|(?:cancel|label|signal|model|travel)l(?:ed\b|ing)"
)
_NO_SUBJECT = r"^After a block of code: [a-z]"
_THAN = r"\b(?:any|no|some)thing else than\b|\b[Aa]nother(?: \w+)? than\b"
FAULTS = (
    Fault("'where' is a place: write if or when", _PLACE),
    Fault("name the role, such as student or process", r"\b(?:any|every|no|some)body\b", r"nobody@"),
    Fault("write 'is not a'", _NOT_A, _THERE_IS_NO),
    Fault("give 'who' a noun", r"(?:^|[.:;] )[Ww]ho(?:ever)? [a-z]", r"\?"),
    Fault("give 'what' a noun", r"^What [a-z]+", _ASKS),
    Fault("write again, even if, instead of, fix", _OLD),
    Fault("write 'different from'", _THAN),
    Fault("write 'exists'", r"\b(?:that|what|which) (?:is|are|was|were) there\b"),
    Fault("name the subject", r"^(?:Its|Those|These) [a-z]"),
    Fault("begin a paragraph with its subject", _NO_SUBJECT),
    Fault("write American English", _BRITISH, r"aria-labelledby|`cancelled`|\"cancelled\""),
)
_PATTERNS = [(fault, re2.compile(fault.found), re2.compile(fault.right)) for fault in FAULTS]


def faults_in(line: str) -> list[str]:
    """Return the names of the faults in a line of prose."""
    return [fault.name for fault, found, right in _PATTERNS if found.search(line) and not right.search(line)]


def prose_of(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of prose in a file with their numbers.

    These are all lines of a page, the texts of a TOML file, and the strings and comments of a module.
    """
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".toml":
        yield from _texts(text)
    elif path.suffix == ".md":
        yield from _lines_of_page(text)
    elif path.suffix != ".py":
        yield from enumerate(text.splitlines(), 1)
    else:
        yield from _strings_and_comments(text)


def _texts(text: str) -> Iterator[tuple[int, str]]:
    values = sorted({line for line in _values(tomllib.loads(text)) if line.strip()}, key=len)
    lines = text.splitlines()
    for value in values:
        # A text that TOML writes with escapes has no line of its own.
        number = next((number for number, line in enumerate(lines, 1) if value in line), 0)
        yield number, value


def _values(data: object, key: str = "") -> Iterator[str]:
    if isinstance(data, dict):
        for name, value in data.items():
            yield from _values(value, name)
    elif isinstance(data, list):
        for value in data:
            yield from _values(value, key)
    elif isinstance(data, str) and key in TEXTS:
        yield from data.splitlines()


def _lines_of_page(text: str) -> Iterator[tuple[int, str]]:
    """Yield the lines of a page; the first one below a block of code says so, since it may continue its sentence."""
    fence, below = "", False
    for number, line in enumerate(text.splitlines(), 1):
        marks = re2.search(r"^ {0,2}(`{3,})", line)
        if marks and fence in ("", marks[1]):
            fence, below = ("" if fence else marks[1]), bool(fence)
        elif below and line.strip():
            yield number, f"After a block of code: {line}"
            below = False
            continue
        yield number, line


def _strings_and_comments(text: str) -> Iterator[tuple[int, str]]:
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        # Since Python 3.12 an f-string comes in pieces; before, it is one string.
        if (
            token.type in (tokenize.COMMENT, tokenize.STRING)
            or tokenize.tok_name[token.type] == "FSTRING_MIDDLE"
        ):
            for number, line in enumerate(token.string.splitlines(), token.start[0]):
                yield number, re2.sub(r"^(#+|[bfruBFRU]*['\"]+)", "", line.strip()).strip()


def _files() -> Iterator[Path]:
    for name in CODE:
        for ending in ("*.py", "*.j2", "*.toml"):
            yield from (ROOT / name).rglob(ending)
    yield from (ROOT / "solutions").rglob("*.toml")
    yield from (ROOT / "docs").rglob("*.md")
    yield ROOT / "README.md"


def _places() -> Iterator[str]:
    for path in sorted(_files()):
        if path.suffix == ".toml" or not any(part.endswith(".answers") for part in path.parts):
            for number, line in prose_of(path):
                for name in faults_in(line):
                    yield f"{path.relative_to(ROOT)}:{number}: {name}: {line[:100]}"


def main() -> int:
    """Print the places if there are more than before; say so if there are fewer. Return the exit code."""
    places = list(_places())
    if len(places) < CEILING:
        print(f"{len(places)} places; lower the CEILING of {CEILING} in tests/english.py.")
    if len(places) <= CEILING:
        return 0
    print(*places, sep="\n")
    print(f"{len(places)} places; tests/english.py allows {CEILING}.")
    return 1


if __name__ == "__main__":
    sys.exit(main())
