"""Makes small texts for cards: counts, lists, the first difference of two texts, and advice for one kind of answer."""

from __future__ import annotations

from string import Formatter

import re2

SHOWN = 16
"""The maximum number of characters to quote from the place where two texts differ."""
_LONG_LIST = re2.compile(r"\[(-?\d+(?:, -?\d+){4}), (?:-?\d+, ){6,}(-?\d+, -?\d+)\]")
"""Matches a list of more than a dozen numbers. The groups contain the first five and the last two numbers."""
_OF_ITS_KIND = {
    kind: re2.compile(rf"(^|[.?!] )(?:In a {kind}, .*?[.?!](?: |$))+") for kind in ("notebook", "program")
}


def counted(number: int, thing: str) -> str:
    """Return the number with its noun: ``"1 message"``, ``"2 messages"``."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def first_difference(said: str, wanted: str) -> str:
    """Return a sentence that shows the first difference of a text from the expected one; empty if they are equal."""
    if said == wanted:
        return ""
    same = said[
        : next((n for n, (a, b) in enumerate(zip(said, wanted, strict=False)) if a != b), len(wanted))
    ]
    place = f"After “{same[-SHOWN:]}”" if same else "At the beginning"
    return f"{place} the task has {_next(wanted, same)}, and yours has {_next(said, same)}."


def _next(text: str, same: str) -> str:
    rest = text[len(same) :]
    return f"“{rest[:SHOWN]}{'…' if rest[SHOWN:] else ''}”" if rest else "nothing more"


def shortened(text: str) -> str:
    """Return the text with ``…`` instead of the middle of each long list of numbers."""
    return str(_LONG_LIST.sub(lambda found: f"[{found[1]}, …, {found[2]}]", text))


def with_placeholders(text: str, *views: str) -> str:
    """Return a text with placeholders unchanged, if it can be filled in with one value and the named views.

    Raises:
        ValueError: The text has a single brace, or a placeholder with another name. The message says what to write.
    """
    known = ("", "0", *views)
    try:
        names = [name for _, name, _, _ in Formatter().parse(text) if name is not None]
        unknown = [f"{{{name}}}" for name in names if re2.split(r"[.\[]", name)[0] not in known]
    except ValueError as error:
        unknown = [f"a brace: {error}"]
    if unknown:
        placeholders = " or ".join(f"{{{name}}}" for name in ("", *views))
        raise ValueError(
            f"the text “{text}” has {' and '.join(unknown)}: write {placeholders} for a value, and {{{{ and }}}} for "
            "braces"
        )
    return text


def visible(text: str) -> str:
    """Return the text with each whitespace character, except a space, written as a Python escape."""
    return "".join(
        character.encode("unicode_escape").decode() if character.isspace() and character != " " else character
        for character in text
    )


def of_its_kind(text: str, in_a_notebook: bool) -> str:
    """Return the advice without sentences for the other kind of answer: notebook or program.

    Args:
        text: The advice. A sentence that begins with ``In a notebook,`` is only for answers in a notebook; a sentence
            that begins with ``In a program,`` is only for programs.
        in_a_notebook: True if the answer is a class or a function of a notebook.
    """
    other = _OF_ITS_KIND["program" if in_a_notebook else "notebook"]
    return str(other.sub(r"\1", text)).strip()
