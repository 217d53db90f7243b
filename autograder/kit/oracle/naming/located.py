"""Names the step at which a run leaves the solution's, for an unnamed mistake: sentence of the task, input, values."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import re2

from autograder.kit.model import Advice
from autograder.kit.oracle.naming.deltas import rows, steps_apart
from autograder.kit.oracle.naming.effects import effect
from autograder.kit.oracle.naming.first_values import hint
from autograder.kit.oracle.naming.whenever import whenever
from autograder.kit.oracle.outputs import Kind

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from autograder.kit.evidence import Part
    from autograder.kit.oracle.outputs import Output

ITEM, LONG = "; ", 60
"""The text between the items of a list in words; from so many letters on, a card leaves out those that are alike."""
_SECONDS = re2.compile(r"\b(\d+(?:\.\d+)?) ?s(?:econds?)?\b")
GO_THROUGH = "Go through your code with this input, step by step, and compare it with the task."


def located(
    outputs: Sequence[Output], run: Part, due: Part, law: Mapping[str, str], near: str = ""
) -> Advice | None:
    """Return the advice about the output that is the first to leave the solution's; None if all are the same.

    Args:
        outputs: The outputs that are compared.
        run: The run of the subject.
        due: The run of the solution in the same drawing.
        law: The sentences of the task, each with the names of the criteria that judge it.
        near: The sentence of the mutants that do the same; empty if there are none.
    """
    failed = _failed(outputs, run, due)
    seconds = [float(one) for sentence in law for one in _SECONDS.findall(sentence)]
    wholes = {output: effect(output, rows(output, run), rows(output, due)) for output in failed}
    for output in sorted(failed, key=lambda one: not wholes[one]):
        finding, whole = output.compared(run, due), wholes[output]
        judged = [sentence for sentence, names in law.items() if output.key in names.split()]
        sentence = near if near in judged else _about(judged, _texts_apart(output, run, due))
        says = f"The task says: “{sentence.rstrip('.')}”." if sentence else ""
        not_met = f"“{output.title}” is not met: {finding.seen}. Asked: {finding.expected}."
        what = _where_apart(output, run, due) or not_met
        # Of several lines that publish, the card could not say which one it is.
        uses = ("publish",) if [one.kind for one in outputs] in ([Kind.STEPS], [Kind.LIST]) else ()
        values = hint(output, run, due, seconds)
        # If the values show the cause, the word beside which it is wrong would only lead away.
        always = None if values or (whole and whole.is_twice) else whenever(output, run, due, outputs)
        shows = "" if values is None or (whole and whole.is_twice) else values.text
        next_step = next((one.next_step for one in (values, always) if one), GO_THROUGH)
        # The values show more than a sentence of the task does.
        words = (whole.text if whole else "", always.text if always else "", shows, what, says * (not shows))
        return Advice(" ".join(filter(None, words)), next_step, uses=always.uses if always else uses)
    return None


def first_apart(outputs: Sequence[Output], run: Part, due: Part) -> str:
    """Return in a sentence the input after which the run first leaves the solution's; empty if no step shows it."""
    told = (_where_apart(output, run, due) for output in _failed(outputs, run, due))
    return next(filter(None, told), "")


def _failed(outputs: Sequence[Output], run: Part, due: Part) -> list[Output]:
    """Return the outputs that are not the solution's. The one that is the first to leave it comes first."""

    def step(output: Output) -> float:
        first = output.parts_at(run, due)
        return first.data["step"] if first else inf

    return sorted((output for output in outputs if not output.compared(run, due).passed), key=step)


def _about(judged: Sequence[str], texts: Collection[str]) -> str:
    """Return the sentence that quotes one of the texts, or the only one; empty if several may be meant."""
    quoting = [one for one in judged if any(f"`{text}`" in one for text in texts)] or judged
    return quoting[0] if len(quoting) == 1 else ""


def _texts_apart(output: Output, run: Part, due: Part) -> list[str]:
    """Return the texts that are too much in the first step that differs, or else those that are missing."""
    mine, theirs = rows(output, run), rows(output, due)
    step = next(iter(steps_apart(mine, theirs, output.tolerance)), 0)
    came, asked = (values.get(step, ()) for values in (mine, theirs))
    rest = [one for one in came if one not in asked] or [one for one in asked if one not in came]
    return [one[0] for one in rest if isinstance(one, list) and isinstance(one[0], str)]


def _where_apart(output: Output, run: Part, due: Part) -> str:
    parting = output.parting_words(run, due)
    if parting is None:
        return ""
    when, came, asked = parting
    came, asked = _from(came, asked), _from(asked, came)
    return f"{_capital(when)}, your code {output.deed(came)}; the task asks for {asked}."


def _from(words: str, others: str) -> str:
    """Return words without the items of a list, if these are many letters, with which others begin in the same way."""
    letters = enumerate(zip(words, others, strict=False))
    alike = words[: next((number for number, (one, other) in letters if one != other), 0)]
    return f"… {words[alike.rfind(ITEM) + len(ITEM) :]}" if ITEM in alike[LONG:] else words


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
