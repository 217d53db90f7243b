"""Says with which word of an output, or of the input, another output is wrong each time, and only then."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import re2

from autograder.kit.model import Advice
from autograder.kit.oracle.naming.deltas import rows, steps_apart
from autograder.kit.oracle.naming.step_words import quoted
from autograder.kit.oracle.outputs import Kind

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from autograder.kit.evidence import Part
    from autograder.kit.oracle.outputs import Output

ENDINGS = {"ABORTED": "abort", "CANCELED": "canceled", "SUCCEEDED": "succeed"}
"""The word with which a status begins, and the method of a goal handle that sets it."""
_WORD = re2.compile(r"\b(None|True|False|nan|inf)\b")


def whenever(output: Output, run: Part, due: Part, others: Sequence[Output]) -> Advice | None:
    """Return with which word an output is wrong, each time and only then; None if there is none.

    Args:
        output: The output.
        run: The run of the subject.
        due: The run of the solution in the same drawing.
        others: All outputs, this one among them.
    """
    mine, theirs = rows(output, run), rows(output, due)
    apart = set(steps_apart(mine, theirs, output.tolerance))
    if len(apart) < 2 or apart == set(theirs):
        return None
    deed = _deed(output, [(mine[step], theirs[step]) for step in apart])
    for other in others:
        for where, word, steps in _said(other, run, due, apart if other is output else ()):
            if steps & set(theirs) == apart:
                return _advice(
                    f"{deed} each time that {where} is {quoted(word)}, and only then.", where, word
                )
    # What is due only after such an input is wrong only then: something has to be right after the others.
    if any(theirs[step] for step in set(theirs) - apart):
        for word, steps in _given(output, run).items():
            if steps & set(theirs) == apart:
                return _advice(
                    f"{deed} each time that {word} is in the input, and only then.", "the input", word
                )
    return None


def _deed(output: Output, pairs: Sequence[tuple[Any, Any]]) -> str:
    if output.kind is Kind.RETURNED:
        return "Your code returns what is wrong"
    if not any(asked for _, asked in pairs):
        return f"Your node says something on {output.name}, where nothing is due,"
    if not any(came for came, _ in pairs):
        return f"Your node says nothing on {output.name}"
    return f"Your node is wrong on {output.name}"


def _advice(text: str, where: str, word: Any) -> Advice:
    name = ENDINGS.get(str(word).partition(",")[0].partition(" ")[0])
    next_step = (
        f"Find what your code does when {where} is {quoted(word)}, and compare just this with the task."
    )
    return Advice(text, next_step, uses=(name,) if name else ())


def _said(
    other: Output, run: Part, due: Part, wrong: Sequence[int] | set[int]
) -> Iterator[tuple[str, Any, set[int]]]:
    """Yield each word of an output, with where it stands and the steps in which it is due there.

    In the steps that are wrong, a field of the same output says something only if it is right.
    """
    if other.kind is not Kind.STEPS:
        return
    for column, path in enumerate(other.paths):
        told, came = (_words(rows(other, part), column) for part in (due, run))
        if any(told[step] != came.get(step) for step in wrong):
            continue
        for word in sorted(set().union(*told.values())):
            yield f"{path} on {other.name}", word, {step for step, words in told.items() if word in words}


def _words(values: Mapping[int, Any], column: int) -> dict[int, set[str]]:
    """Return by step the texts in a field of the messages."""
    return {
        step: {
            one[column] for one in listed if isinstance(one, (list, tuple)) and isinstance(one[column], str)
        }
        for step, listed in values.items()
    }


def _given(output: Output, run: Part) -> dict[str, set[int]]:
    """Return the words that are in inputs, each with the steps."""
    found: dict[str, set[int]] = {}
    for event in run.of("noted", output.name):
        for word in _WORD.findall(str(event.data["given"])):
            found.setdefault(word, set()).add(event.data["step"])
    return found
