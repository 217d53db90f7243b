"""Says for a card after which input something came: by its fields, not by its number."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import takewhile
from typing import TYPE_CHECKING, Any

from autograder.kit.rules import in_words

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.evidence import Event, Part

FIELDS = 3
"""The maximum number of fields of an input that a card names."""
WAITED = " s without an input"
"""The words that the judge notes behind the seconds for which it only lets time pass."""
FIRST = 3
"""The number of items of a long list that a card shows."""


def when(noted: Event, earlier: Sequence[Event], part: Part) -> str:
    """Return after which input a step was noted, in words.

    Args:
        noted: The event of the step.
        earlier: The events of the same output in the steps before.
        part: The run, in which the inputs are.
    """
    given = str(noted.data["given"])
    if not noted.data["step"]:
        return "at the start"
    waits = [*takewhile(_is_wait, [noted, *reversed(earlier)])]
    before = earlier[: 1 + len(earlier) - len(waits)] if waits else []
    if before and before[-1].data["step"]:
        seconds = sum(float(wait.data["given"].removesuffix(WAITED)) for wait in waits)
        return f"{when(before[-1], before[:-1], part)}, then {seconds:g}{WAITED}"
    name, _, rest = given.partition(", then ")
    sent = [event for event in part.events if event.kind in ("sent", "asked") and event.name == name]
    number = sum(str(event.data["given"]).partition(", then ")[0] == name for event in earlier)
    if number >= len(sent):
        return f"after {given}" if given else "at the start"
    fields = list(_named(sent[number].data["fields"]))
    told = ", ".join(f"{path} = {value}" if path != "data" else value for path, value in fields[:FIELDS])
    later = f", then {rest}" if rest else ""
    return f"after {name} with {told}{', …' * (len(fields) > FIELDS)}{later}" if told else f"after {given}"


def _is_wait(noted: Event) -> bool:
    return bool(noted.data["step"]) and str(noted.data["given"]).endswith(WAITED)


def _named(fields: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield the path and the value of each field; of a long list its first items."""
    if isinstance(fields, Mapping):
        for name, value in fields.items():
            yield from _named(value, f"{path}.{name}" if path else str(name))
    elif isinstance(fields, (list, tuple)):
        first = in_words([_rounded(one) for one in fields[:FIRST]])
        yield path, f"[{first}{', …' * (len(fields) > FIRST)}]"
    else:
        yield path, quoted(_rounded(fields))


def quoted(value: Any) -> str:
    """Return a value in words, with a text in quotation marks, so that “nothing” is not nothing."""
    return f"“{value}”" if isinstance(value, str) else in_words([value])


def _rounded(value: Any) -> Any:
    return round(value, 4) if isinstance(value, float) else value
