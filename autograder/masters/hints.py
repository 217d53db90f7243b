"""Hints that open one at a time.

An author writes one block after the other::

    :::{hint} Where do I begin?
    With the publisher.
    :::

    :::{hint} And then?
    With the timer.
    :::

JupyterLab knows no such blocks, but it shows ``<details>``. Each hint is put inside the one before it, so
that a student cannot see the second before opening the first.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from autograder.masters.master_errors import CellError

OPENING = re.compile(r":::\{hint\}\s*(?P<question>.*?)\s*")
CLOSING = ":::"


@dataclass(frozen=True)
class Hint:
    """One hint: the question it answers, and the Markdown that answers it."""

    question: str
    answer: str


def nest_hints(markdown: str) -> str:
    """``markdown`` with every run of hint blocks as nested ``<details>``.

    Raises:
        CellError: A hint has no question, holds another hint, or is never closed.
    """
    lines = markdown.split("\n")
    result: list[str] = []
    run: list[Hint] = []
    offset = 0
    while offset < len(lines):
        opening = OPENING.fullmatch(lines[offset])
        if opening:
            end = _closing(lines, offset)
            run.append(_hint(opening["question"], lines[offset + 1 : end], offset))
            offset = end + 1
            continue
        # Blank lines between two hints do not end their run.
        if run and lines[offset].strip():
            result.extend([_nested(run), ""])
            run = []
        if not run:
            result.append(lines[offset])
        offset += 1
    if run:
        result.append(_nested(run))
    return "\n".join(result)


def _closing(lines: list[str], opening: int) -> int:
    for offset in range(opening + 1, len(lines)):
        if OPENING.fullmatch(lines[offset]):
            break
        if lines[offset].strip() == CLOSING:
            return offset
    raise CellError(
        opening, "A hint that is not closed.", f"End it with a line '{CLOSING}' in the same text cell."
    )


def _hint(question: str, answer: list[str], offset: int) -> Hint:
    text = "\n".join(answer).strip("\n")
    if not question or not text.strip():
        raise CellError(
            offset, "A hint without its question or its answer.", "Write ':::{hint} What is asked?'."
        )
    return Hint(question, text)


def _nested(hints: list[Hint]) -> str:
    text = ""
    for number in range(len(hints), 0, -1):
        hint = hints[number - 1]
        inner = f"{hint.answer}\n\n{text}" if text else f"{hint.answer}\n"
        text = (
            f"<details>\n<summary><b>Hint {number} of {len(hints)}.</b> {hint.question}</summary>\n"
            # The blank lines make JupyterLab read what is inside as Markdown.
            f"<blockquote>\n\n{inner}\n</blockquote>\n</details>\n"
        )
    return text.rstrip("\n")
