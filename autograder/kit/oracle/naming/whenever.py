"""Says with which word of an output, or of the input, another output is wrong each time, and only then."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit.model import Advice
from autograder.kit.oracle.naming.deltas import rows, steps_apart
from autograder.kit.oracle.naming.step_words import quoted
from autograder.kit.oracle.outputs import Kind

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from autograder.kit.evidence import Part
    from autograder.kit.oracle.outputs import Output

ENDINGS = {"ABORTED": "abort", "CANCELED": "canceled", "SUCCEEDED": "succeed"}
"""The word with which a status begins, and the method of a goal handle that sets it."""
INPUT = "a value of the input"
"""The words for where such a word stands that no output has said."""
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
    if not 1 < len(apart) < len(theirs):
        return None
    # What is due only after an input with a word is wrong only then: something has to be right after the others.
    is_due_elsewhere = any(theirs[step] for step in theirs if step not in apart)
    given = _given(output, run) if is_due_elsewhere else ()
    said = (_said(other, run, due, apart if other is output else ()) for other in others)
    for where, word, steps in chain(*said, given):
        if steps & theirs.keys() == apart:
            when = f"{where} is {quoted(word) if where != INPUT else word}"
            deed = _deed(output, [(mine[step], theirs[step]) for step in apart])
            sets = ENDINGS.get(word.partition(",")[0].partition(" ")[0])
            return Advice(
                f"{deed} each time that {when}, and only then.",
                f"Find what your code does when {when}, and compare just this with the task.",
                uses=(sets,) if sets else (),
            )
    return None


def _deed(output: Output, pairs: Sequence[tuple[Any, Any]]) -> str:
    if output.kind is Kind.RETURNED:
        return "Your code returns what is wrong"
    if not any(asked for _, asked in pairs):
        return f"Your node says something on {output.name}, although nothing is due,"
    if not any(came for came, _ in pairs):
        return f"Your node says nothing on {output.name}"
    return f"Your node is wrong on {output.name}"


def _said(other: Output, run: Part, due: Part, wrong: Collection[int]) -> Iterator[tuple[str, str, set[int]]]:
    """Yield each text in a field of an output, with the words for the field, and the steps in which it is due there.

    In the steps that are wrong, a field of the same output says something only if it is right.
    """
    for column, path in enumerate(other.paths if other.kind is Kind.STEPS else ()):
        told, came = (_texts(rows(other, part), column) for part in (due, run))
        if all(told[step] == came.get(step) for step in wrong):
            for word in sorted(set().union(*told.values())):
                yield f"{path} on {other.name}", word, {step for step, texts in told.items() if word in texts}


def _texts(values: Mapping[int, Any], column: int) -> dict[int, set[str]]:
    """Return by step the texts in a field of the messages."""
    fields = {
        step: [one[column] for one in listed if isinstance(one, list)] for step, listed in values.items()
    }
    return {step: {one for one in listed if isinstance(one, str)} for step, listed in fields.items()}


def _given(output: Output, run: Part) -> Iterator[tuple[str, str, set[int]]]:
    """Yield each word that is in inputs, with the steps."""
    words = {
        event.data["step"]: _WORD.findall(str(event.data["given"])) for event in run.of("noted", output.name)
    }
    for word in sorted(set().union(*words.values())):
        yield INPUT, word, {step for step, found in words.items() if word in found}
