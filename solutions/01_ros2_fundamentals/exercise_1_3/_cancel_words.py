"""A client's words on how its goal ended, in the runs in which it was canceled, in which it succeeded, was aborted.

Any human language is right, and a number is as good as a name. But a word that names one outcome must not be said of
the other, whatever number stands beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2
from exercise_1_3._cancel_evidence import after_result

from autograder.kit.outcome_words import (
    ABORTED,
    CANCELED,
    DOUBTFUL,
    SUCCEEDED,
    SUCCESS,
    ends_as,
    flag,
    names_canceled,
    without_lists,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Part

_NUMBER = re2.compile(r"\d+(?:\.\d+)*")
_ROW = re2.compile(r"\b\d{1,18}(?:[ ,;]+\d{1,18}\b)+")
"""Whole numbers in a row."""
WAS_CANCELED, WAS_ABORTED = "was canceled", "was aborted, though the server had agreed to cancel it"
HAS_SUCCEEDED = "succeeded in spite of the cancel request"
"""The ends of the goals."""
_OF_EITHER = "abgebrochen|annul"
"""Words that stand for both a canceled and an aborted goal in some languages."""
_NOT_SO = re2.compile(
    r"(?i)\b(?:pas|niet|non|no|não|nao|nie|не|inte|ikke|ei)\b|[不没沒非]|ない|(?:rather|other) than|[!≠]=?|\bun"
)
"""Words of who denies what follows, in some languages."""
_ENGLISH = "cancel+ed"
"""Words that nobody may say of a goal that was aborted. In other languages one word may stand for both."""


def says_canceled(
    lines: Sequence[str],
    elsewhere: Sequence[str] = (),
    refused: Part | None = None,
    aborted: Part | None = None,
) -> bool:
    """True if a line names the status CANCELED, by its name or by its number 5 (action_msgs/msg/GoalStatus).

    Args:
        lines: What was said.
        elsewhere: What was said in the run with a goal that was not canceled: a 5 in the same place of a line there is
            no status.
        refused: That run, where what it says of its end counts: a name that is in the same line there tells nothing.
        aborted: The same of the run in which the goal was aborted.
    """
    ends = {_shape(line) for line in (after_result(refused) if refused else ())}
    ends |= {
        _shape(line)
        for line in (after_result(aborted) if aborted else ())
        if not re2.search(f"(?i){_OF_EITHER}", line)
    }
    return any(
        (names_canceled(line) and _shape(line) not in ends) or _has_the_number(line, elsewhere)
        for line in lines
    )


def _has_the_number(line: str, elsewhere: Sequence[str]) -> bool:
    twins = [_numbers(other) for other in elsewhere if _shape(other) == _shape(line)]
    return any(
        number == "5" and all(twin[place] != "5" for twin in twins)
        for place, number in enumerate(_numbers(line))
    )


def _numbers(line: str) -> list[str]:
    return _NUMBER.findall(_without_sequences(line))


def _shape(line: str) -> str:
    """A line with a place for each number, so that two lines for two goals can be compared."""
    return _NUMBER.sub("#", _without_sequences(line))


def _without_sequences(line: str) -> str:
    """A line without the numbers of its goal, in a list or in a row as print(*numbers) says them."""
    return _ROW.sub(lambda row: " ".join(_other_numbers(row[0])), without_lists(line))


def _other_numbers(row: str) -> list[str]:
    numbers = list(map(int, _NUMBER.findall(row)))
    begins = next((place for place in range(len(numbers)) if numbers[place : place + 3] == [0, 1, 1]), None)
    if begins is None:
        return _NUMBER.findall(row)
    ends = begins + 3
    while ends < len(numbers) and numbers[ends] == numbers[ends - 1] + numbers[ends - 2]:
        ends += 1
    return [str(number) for number in numbers[:begins] + numbers[ends:]]


def false_claim(honoured: Part, refused: Part, aborted: Part | None = None) -> tuple[str, str] | None:
    """A line about one of its goals that is true of another only, and how the goal that it says it of ended.

    None where it says nothing of the kind.

    Args:
        honoured: The run in which the goal was canceled.
        refused: The run in which it succeeded.
        aborted: The run in which it was aborted, where there was one.
    """
    if refused.first("result") is None:
        return None
    of_canceled, of_succeeded = after_result(honoured), after_result(refused)
    of_aborted = after_result(aborted) if aborted else []
    for said, ended, is_false in (
        (
            of_succeeded,
            HAS_SUCCEEDED,
            lambda line: flag(CANCELED, line) is True or flag(SUCCEEDED, line) is False,
        ),
        (
            of_canceled,
            WAS_CANCELED,
            lambda line: flag(CANCELED, line) is False or flag(SUCCEEDED, line) is True,
        ),
        (of_aborted, WAS_ABORTED, lambda line: True in (flag(_ENGLISH, line), flag(SUCCEEDED, line))),
        (of_succeeded, HAS_SUCCEEDED, lambda line: ends_as(CANCELED, line)),
        (of_canceled, WAS_CANCELED, lambda line: ends_as(SUCCEEDED, line)),
        (of_succeeded, HAS_SUCCEEDED, lambda line: ends_as(ABORTED, line)),
        (of_aborted, WAS_ABORTED, lambda line: ends_as(_ENGLISH, line) or ends_as(SUCCEEDED, line)),
    ):
        false = next(filter(is_false, said), None)
        if false is not None:
            return false, ended
    if claimed := _claimed(refused, honoured, f"{SUCCESS}|4"):
        return claimed, HAS_SUCCEEDED
    if aborted and (claimed := _claimed(aborted, honoured, "abort|6", _ENGLISH)):
        return claimed, WAS_ABORTED
    return None


def _claimed(part: Part, honoured: Part, truth: str, word: str = CANCELED) -> str | None:
    """A line that amounts to "the goal was canceled" where it was not.

    It says so in plain English, or it is said of the canceled goal, too: whose words differ there has told the two ends
    apart, in any language.

    Args:
        part: The run.
        honoured: The run in which the goal was canceled.
        truth: The words and the number for how the goal of ``part`` ended.
        word: The words that claim it.
    """
    said, of_canceled = _told(part), {_shape(line) for line in _told(honoured)}
    in_english = [line for line in said if re2.search(f"(?i){_ENGLISH}", line) and not _NOT_SO.search(line)]
    claims = [
        line
        for line in said
        if re2.search(f"(?i){word}", without_lists(line))
        and flag(CANCELED, line) is not False
        and (line in in_english or _shape(line) in of_canceled)
    ]
    if not claims or any(re2.search(f"(?i){DOUBTFUL}|{truth}", without_lists(line)) for line in said):
        return None
    return claims[-1]


def _told(part: Part) -> list[str]:
    """What was said of how a goal ended; an exception that ends the program says something, too."""
    raised = [line for line in part.traceback.splitlines() if line.strip()][-1:]
    return [*after_result(part), *raised] or (part.said() if part.first("result_request") else [])
