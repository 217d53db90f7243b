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


def when(noted: Event, earlier: Sequence[Event], part: Part, unheard: int = 0) -> str:
    """Return after which input a step was noted, in words.

    Args:
        noted: The event of the step.
        earlier: The events of the same output in the steps before.
        part: The run, in which the inputs are.
        unheard: The number of inputs that came before the judge listened.
    """
    given = str(noted.data["given"])
    inputs = inputs_of(part)
    if not noted.data["step"]:
        return (
            f"after {input_in_words(inputs[unheard - 1])}" if 0 < unheard <= len(inputs) else "at the start"
        )
    waits = [*takewhile(is_wait, [noted, *reversed(earlier)])]
    before = earlier[: 1 + len(earlier) - len(waits)] if waits else []
    if before and before[-1].data["step"]:
        seconds = sum(float(wait.data["given"].removesuffix(WAITED)) for wait in waits)
        return f"{when(before[-1], before[:-1], part, unheard)}, then {seconds:g}{WAITED}"
    name, _, rest = given.partition(", then ")
    event = input_of(noted, earlier, part, unheard)
    if event is None:
        return f"after {given}" if given else "at the start"
    told = input_in_words(event)
    return f"after {told}{f', then {rest}' * bool(rest)}" if told != name else f"after {given}"


def input_of(noted: Event, earlier: Sequence[Event], part: Part, unheard: int = 0) -> Event | None:
    """Return the input of a step; None if it has none. For the arguments see :func:`when`."""
    name = _name(noted)
    sent = [event for event in inputs_of(part)[unheard:] if event.name == name]
    number = sum(_name(event) == name for event in earlier)
    return sent[number] if number < len(sent) else None


def inputs_of(part: Part) -> list[Event]:
    """Return the inputs of a run, in order of time."""
    return [event for event in part.events if event.kind in ("sent", "asked")]


def _name(noted: Event) -> str:
    """Return the name of what was given in a step."""
    return str(noted.data["given"]).partition(", then ")[0]


def input_in_words(event: Event) -> str:
    """Return an input in words: its name, and its first fields."""
    fields = list(_named(event.data["fields"]))
    told = ", ".join(f"{path} = {value}" if path != "data" else value for path, value in fields[:FIELDS])
    return f"{event.name} with {told}{', …' * (len(fields) > FIELDS)}" if told else event.name


def is_wait(noted: Event) -> bool:
    """Return True for a step in which the judge only lets time pass."""
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
