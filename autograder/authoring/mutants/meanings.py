"""Says what a mutant does as data for a card: its operator, the task's sentence about the place, what is visible."""

from __future__ import annotations

import ast
import re  # noqa: TID251  (not what a student handed in)
from typing import TYPE_CHECKING

from autograder.kit.oracle.naming.deltas import Meaning

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from autograder.authoring.mutants.code import Code
    from autograder.authoring.mutants.engine import Mutant

_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?![\w]|\.\d)")
_BOUND = re.compile(
    r"\b(?:than|least|most|within|until|over|below|above|after|smaller|larger|between|from|to)\b"
)
"""Words before a number with which a task compares."""
_NAMES = re.compile(r"`([^`]*)`")
_WORD = re.compile(r"[A-Za-z_]{3,}")
_REACH = 30
"""The number of characters before a number in which such a word may stand."""


class Places:
    """Finds what the task and the notebook say of a place in the solution.

    Args:
        code: The solution.
        law: The sentences of the task that are judged.
        visible: Everything that a student reads and gets: texts and given code.
    """

    def __init__(self, code: Code, law: Iterable[str], visible: str) -> None:
        self._code, self._law = code, [" ".join(sentence.split()) for sentence in law]
        self._words = set(_WORD.findall(visible))
        self._numbers = {float(number) for number in _NUMBER.findall(visible)}

    def meaning(self, mutant: Mutant) -> Meaning:
        """Return what a mutant does, without a line of the solution."""
        right, value = _number(mutant.before), _number(mutant.after)
        statement = self._code.smallest(self._code.all(ast.stmt), mutant.start, mutant.start + 1)
        quote = self._quote(mutant, statement, right)
        is_shown = right in self._numbers or (right is not None and bool(quote))
        return Meaning(
            operator=mutant.operator,
            kind=self._kind(mutant),
            place=statement.lineno if statement is not None else mutant.line,
            spot=mutant.start,
            quote=quote,
            name=self._name(mutant),
            right=right if is_shown else None,
            value=value if is_shown and not (mutant.all_of == 1 and self._is_exchange(mutant)) else None,
        )

    def _is_exchange(self, mutant: Mutant) -> bool:
        """Return True if something is changed at another place, too."""
        text, end = self._code.text, mutant.start + len(mutant.before)
        return mutant.text != f"{text[: mutant.start]}{mutant.after}{text[end:]}"

    def _kind(self, mutant: Mutant) -> str:
        """Return the kind without words that the notebook does not show."""
        if mutant.operator == "comparison" and mutant.before == "==":
            return "equal"
        if mutant.operator == "other_word" and self._code.text[: mutant.start].endswith("parameter("):
            return "parameter"
        if mutant.operator == "number_of_another_place" and self._is_exchange(mutant):
            return "exchanged"
        words = mutant.kind.split()
        if "for" in words[1:-1]:
            return "for" if mutant.operator == "other_word" else ""
        return mutant.kind if mutant.operator != "other_word" or not mutant.kind.startswith("for ") else "for"

    def _name(self, mutant: Mutant) -> str:
        """Return a word that is meant to be said, or else the method around the place, if the notebook shows it."""
        if mutant.operator == "other_word":
            word = mutant.before.strip("'\"")
            return word if set(_WORD.findall(word)) <= self._words else ""
        method = mutant.where.rpartition(".")[2]
        return method if self.shows(method) else ""

    def shows(self, method: str) -> bool:
        """Return True if the notebook shows the name of a method."""
        return method in self._words and not method.startswith("__")

    def _quote(self, mutant: Mutant, statement: ast.stmt | None, right: float | None) -> str:
        """Return the only sentence of the task that is about a place; empty if none is, or if several may be."""
        test = self._test(mutant.start)
        shown = self._code.source(test) if test is not None else _head(self._code, statement)
        tokens = set(_WORD.findall(shown)) & self._words - {"self"}
        scores = {one: len(tokens & _code_words(one)) for one in self._law}
        best = max(scores.values(), default=0)
        nearest = [one for one, score in scores.items() if best and score == best]
        if mutant.operator == "other_word":
            word = mutant.before.strip("'\"")
            return _only(one for one in self._law if word in _code_words(one))
        if right is not None and test is None and nearest:
            return _only(
                one for one in nearest if right in {*_numbers_of(one, compares=True), *_numbers_of(one)}
            )
        if right is not None:
            return _only(one for one in self._law if right in _numbers_of(one, compares=test is not None))
        if test is not None:
            numbers = {float(number) for number in _NUMBER.findall(shown)}
            if numbers and (
                quote := _only(one for one in self._law if numbers <= {*_numbers_of(one, compares=True)})
            ):
                return quote
        return _only(iter(nearest))

    def _test(self, start: int) -> ast.expr | None:
        """Return the smallest condition around a place: the test of a branch, or a comparison."""
        tests = [node.test for node in self._code.all(ast.If, ast.IfExp, ast.While)]
        return self._code.smallest([*tests, *self._code.all(ast.Compare)], start, start + 1)


def _number(text: str) -> float | None:
    try:
        return float(text.strip("()"))
    except ValueError:
        return None


def _numbers_of(sentence: str, *, compares: bool = False) -> Iterator[float]:
    """Yield the numbers of a sentence that are limits, or those that are not."""
    for found in _NUMBER.finditer(sentence):
        before = sentence[max(0, found.start() - _REACH) : found.start()]
        if bool(_BOUND.search(before)) is compares:
            yield float(found[0])


def _code_words(sentence: str) -> set[str]:
    return {word for code in _NAMES.findall(sentence) for word in _WORD.findall(code)}


def _head(code: Code, statement: ast.stmt | None) -> str:
    return code.source(statement).partition("\n")[0] if statement is not None else ""


def _only(sentences: Iterator[str]) -> str:
    found = list(sentences)
    return found[0] if len(found) == 1 else ""
