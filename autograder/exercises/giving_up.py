"""Clients that end before they have met a server that is there, told from clients that never meant to ask.

On the wire both only end. What tells them apart is that the first says of a server that is there what it says of one
that is not.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.exercises.evidence import Part


def gave_up(served: Sequence[Part], absent: Part, asked: Callable[[Part], bool]) -> bool:
    """Whether the subject ended before it had met a server that was there.

    In which of the runs it ends too early depends on the machine: who looks once may find the server in some of them,
    in all or in none.

    Args:
        served: The runs with a server; in the first one the server comes late.
        absent: The run without one.
        asked: Whether the subject asked the server for something in a run.
    """
    ended = [part for part in served if part.ending and not asked(part)]
    if served[0] in ended and any(asked(part) for part in served):
        return True
    told = _parting_words(absent)
    return bool(absent.ending and told) and any(_parting_words(part) == told for part in ended)


def _parting_words(part: Part) -> set[str]:
    """What it said, with a place for each of the run's own numbers; once each, for a log line may come on two ways."""
    said = filter(str.strip, [*part.said(), *part.traceback.splitlines()[-1:]])
    numbers = "|".join(re.findall(r"\d+", str(list(part.inputs.values()))))
    return {re.sub(rf"(?<!\d)-?(?:{numbers})(?!\d)", "…", line) if numbers else line for line in said}
