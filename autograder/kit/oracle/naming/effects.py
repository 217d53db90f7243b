"""Says in one sentence how an output differs from the solution's as a whole, whatever the cause in the code is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from autograder.kit.oracle.naming.deltas import alike, steps_apart
from autograder.kit.oracle.naming.step_words import quoted
from autograder.kit.oracle.outputs import NUMBER, Kind
from autograder.kit.rules import same

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from autograder.kit.oracle.outputs import Output

FEW = 6
"""The greatest number of values of a field that are told apart as words are."""
LARGEST = 1e15
"""A number that is larger is shown, and not computed with: Python's integers have no end."""
Pairs = list[tuple[Any, Any]]
"""The values of one field in the order of the steps: the subject's, and the solution's."""


class Effect(NamedTuple):
    """What is wrong with an output as a whole.

    Attributes:
        text: The sentence for the card.
        is_twice: True if each message comes twice, which the values of a single step show as well.
        is_once: True if no message comes a second time.
    """

    text: str
    is_twice: bool = False
    is_once: bool = False


def effect(output: Output, mine: Mapping[int, Any], theirs: Mapping[int, Any]) -> Effect | None:
    """Return how all steps of an output differ; None if no single sentence is true of them.

    Args:
        output: The output.
        mine: The subject's values by step.
        theirs: The solution's values by step.
    """
    if output.kind not in (Kind.STEPS, Kind.RETURNED):
        return None
    steps = [step for step in theirs if step in mine]
    wrong = steps_apart(mine, theirs, output.tolerance)
    if len(wrong) < 2:
        return None
    name = "" if output.kind is Kind.RETURNED else f" on {output.name}"
    if _come_twice([(mine[step], theirs[step]) for step in wrong], output.tolerance):
        is_whole = len(wrong) == sum(bool(theirs[step]) for step in steps)
        return Effect(f"Your node says everything{name} twice.", is_twice=True) if is_whole else None
    if any(len(mine[step]) != len(theirs[step]) for step in steps):
        once = _only_once(name, [(mine[step], theirs[step]) for step in steps], output.tolerance)
        return Effect(once, is_once=True) if once else None
    fields = _fields(output, name, [(mine[step], theirs[step]) for step in steps])
    told = (_values(what, pairs, output.tolerance) for what, pairs in fields)
    return next((Effect(text) for text in told if text), None)


def _fields(output: Output, name: str, listed: Pairs) -> Iterator[tuple[str, Pairs]]:
    """Yield the words for each field, and its values in the order of the steps; of a list each item by itself."""
    for column, path in enumerate(output.paths):
        if path == NUMBER:
            continue
        pairs: Pairs = [
            (one[column], other[column])
            for mine, theirs in listed
            for one, other in zip(mine, theirs, strict=True)
            if isinstance(one, (list, tuple)) and len(one) == len(other) == len(output.paths)
        ]
        usual = f"What your {'node says' if name else 'code returns'}{name}"
        what = usual if path == "data" else f"Your {path.removesuffix('?')}{name}"
        widths = {len(value) if isinstance(value, (list, tuple)) else 0 for pair in pairs for value in pair}
        if len(widths) == 1 and (width := widths.pop()):
            for item in range(width if width <= FEW else 0):
                yield f"{what}, as item {item + 1},", [(one[item], other[item]) for one, other in pairs]
        else:
            yield what, pairs


def _come_twice(pairs: Pairs, tolerance: float) -> bool:
    """Return True if each message comes twice, and nothing else differs."""
    return all(due and alike(came, [one for one in due for _ in range(2)], tolerance) for came, due in pairs)


def _only_once(name: str, pairs: Pairs, tolerance: float) -> str:
    """Return that each value comes the first time that it is due, and never again, if that is so."""
    said: list[Any] = []
    is_left_out = False
    for came, due in pairs:
        new = [one for number, one in enumerate(due) if one not in [*said, *due[:number]]]
        if not alike(came, new, tolerance):
            return ""
        # A node that says only changes leaves out a value only if it is also the last one.
        is_left_out = is_left_out or any(one in said[:-1] for one in due)
        said += new
    return f"A message that your node has said{name} once, it never says again." if is_left_out else ""


def _values(what: str, pairs: Pairs, tolerance: float) -> str:
    apart = [(one, other) for one, other in pairs if not same(one, other, tolerance)]
    if len(apart) < 2:
        return ""
    kinds = (_not_called, _constant, _never, _exchanged, _scaled, _late, _stuck)
    return next(filter(None, (kind(what, pairs, apart, tolerance) for kind in kinds)), "")


def _not_called(what: str, _: Pairs, apart: Pairs, __: float) -> str:
    is_method = any(str(one).startswith(("<bound method ", "<function ")) for one, _ in apart)
    return (
        f"{what} is a method itself, and not what it returns: its parentheses () are missing."
        if is_method
        else ""
    )


def _constant(what: str, pairs: Pairs, _: Pairs, tolerance: float) -> str:
    first = pairs[0][0]
    is_constant = all(same(one, first, tolerance) for one, _ in pairs)
    return f"{what} is always {_word(first)}." if is_constant and len(pairs) > 2 else ""


def _never(what: str, pairs: Pairs, apart: Pairs, tolerance: float) -> str:
    """A value that is due, and never comes; or one that comes, and is never due."""
    due = _few(other for _, other in pairs)
    wrong = _few(other for _, other in apart)
    came = _few(one for one, _ in apart)
    if due is None or wrong is None or len(wrong) != 1:
        return ""
    if any(same(one, wrong[0], tolerance) for one, _ in pairs):
        return ""
    instead = f", but {_word(came[0])}" if came is not None and len(came) == 1 else ""
    return f"{what} is never {_word(wrong[0])}{instead}."


def _exchanged(what: str, pairs: Pairs, _: Pairs, __: float) -> str:
    due = _few(other for _, other in pairs)
    if due is None or len(due) < 2:
        return ""
    stands: dict[str, str] = {}
    for one, other in pairs:
        if stands.setdefault(repr(_plain(other)), repr(_plain(one))) != repr(_plain(one)):
            return ""
    swapped = [a for a, b in stands.items() if a != b and stands.get(b) == a]
    moved = [a for a, b in stands.items() if a != b]
    if len(swapped) == len(moved) == 2:
        first, second = (next(value for value in due if repr(_plain(value)) == one) for one in swapped)
        return f"{what} is {_word(first)} where {_word(second)} is due, and the other way round."
    return ""


def _scaled(what: str, pairs: Pairs, apart: Pairs, tolerance: float) -> str:
    numbers = [(one, other) for one, other in pairs if _is_number(one) and _is_number(other)]
    if len(numbers) < len(pairs) or len({other for _, other in apart}) < 2:
        return ""
    if all(same(one, abs(other), tolerance) for one, other in numbers):
        return f"{what} has lost its sign."
    if all(same(one, -other, tolerance) for one, other in numbers):
        return f"{what} has the wrong sign."
    nonzero = [(one, other) for one, other in numbers if other]
    factor = nonzero[0][0] / nonzero[0][1] if nonzero else 0.0
    if (
        factor
        and len({other for _, other in nonzero}) > 1
        and all(same(one, other * factor, tolerance) for one, other in numbers)
    ):
        return f"{what} is {factor:.4g} times what is due."
    return ""


def _late(what: str, pairs: Pairs, _: Pairs, tolerance: float) -> str:
    later = zip(pairs[1:], pairs, strict=False)
    if len(pairs) > 3 and all(same(one, before, tolerance) for (one, _), (_, before) in later):
        return f"{what} comes one step late: it is what was due before."
    return ""


def _stuck(what: str, pairs: Pairs, _: Pairs, tolerance: float) -> str:
    start = next(n for n, (one, other) in enumerate(pairs) if not same(one, other, tolerance))
    rest = pairs[start:]
    is_stuck = all(same(one, rest[0][0], tolerance) for one, _ in rest)
    if (
        start
        and len(rest) > 2
        and is_stuck
        and any(not same(other, rest[0][1], tolerance) for _, other in rest)
    ):
        return f"{what} is right at first, and then always {_word(rest[0][0])}."
    return ""


def _few(values: Iterator[Any]) -> list[Any] | None:
    """Return the different values in their order; None if there are too many of them."""
    found = {repr(_plain(value)): value for value in values}
    return list(found.values()) if len(found) <= FEW else None


def _plain(value: Any) -> Any:
    return round(float(value), 3) if _is_number(value) else value


def _is_number(value: Any) -> bool:
    """Return True for a number that can be computed with: neither a truth value, nor endless, nor too large."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and -LARGEST < value < LARGEST


def _word(value: Any) -> str:
    return quoted(round(value, 4) if isinstance(value, float) else value)
