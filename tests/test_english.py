"""Plain English: recurring faults in the prose of code and pages are counted, and must not become more.

A pattern finds what is worth a second look, and some places are right as they are. So a number is held, not each
place. If you get below it, lower it. If you get above it, the failure lists every place: rewrite yours from what the
code does, and never by replacing a word.
"""

from __future__ import annotations

import io
import tokenize
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pytest
import re2

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[1]
CODE = ("autograder", "environment")
CEILING = 161
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
)
_PATTERNS = [(fault, re2.compile(fault.found), re2.compile(fault.right)) for fault in FAULTS]


def faults_in(line: str) -> list[str]:
    """Return the names of the faults in a line of prose."""
    return [fault.name for fault, found, right in _PATTERNS if found.search(line) and not right.search(line)]


def prose_of(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of prose in a file with their numbers: all lines of a page; strings and comments of a module."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        yield from enumerate(text.splitlines(), 1)
        return
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        # Since Python 3.12 an f-string comes in pieces; before, it is one string.
        if (
            token.type in (tokenize.COMMENT, tokenize.STRING)
            or tokenize.tok_name[token.type] == "FSTRING_MIDDLE"
        ):
            for number, line in enumerate(token.string.splitlines(), token.start[0]):
                yield number, line.strip().lstrip("#bfruBFRU").lstrip("'\"").strip()


def _files() -> Iterator[Path]:
    for name in CODE:
        for ending in ("*.py", "*.j2"):
            yield from (ROOT / name).rglob(ending)
    yield from (ROOT / "docs").rglob("*.md")
    yield ROOT / "README.md"


def _places() -> Iterator[str]:
    for path in sorted(_files()):
        if not any(part.endswith(".answers") for part in path.parts):
            for number, line in prose_of(path):
                for name in faults_in(line):
                    yield f"{path.relative_to(ROOT)}:{number}: {name}: {line[:100]}"


def test_no_more_faults_than_before() -> None:
    places = list(_places())
    assert len(places) <= CEILING, "\n".join(["", *places, f"{len(places)} places; {CEILING} are allowed."])


@pytest.mark.parametrize(
    ("faulty", "plain"),
    [
        ("None where the name says none", "None if the name contains none"),
        ("The channel that nobody reads.", "The channel that no process reads."),
        ("The solution is no Python.", "The solution is not valid Python."),
        ("Who ends at once has not given up.", "A client that ends at once has not given up."),
        ("What the judge saw.", "The events that the judge saw."),
        ("Begin anew, also where it failed.", "Begin again, even if it failed."),
        ("It says something else than its name.", "The content of the file differs from its name."),
        ("A box that is there.", "A running sandbox."),
        ("Its outcome.", "The outcome of this file."),
    ],
)
def test_a_fault_is_found_and_its_plain_form_is_not(faulty: str, plain: str) -> None:
    assert faults_in(faulty)
    assert not faults_in(plain)


def test_prose_is_strings_and_comments(tmp_path: Path) -> None:
    module = tmp_path / "module.py"
    module.write_text('"""One.\n\nTwo."""\nnobody = 1  # three\nsaid = f"four {nobody} five"\n')
    lines = list(prose_of(module))
    assert lines[:4] == [(1, "One."), (2, ""), (3, 'Two."""'), (4, "three")]
    assert all(number == 5 for number, _ in lines[4:])
    assert "four" in "".join(line for _, line in lines[4:])


def test_there_is_no_is_english() -> None:
    assert not faults_in("There is no reply, and the reply is no longer needed.")
