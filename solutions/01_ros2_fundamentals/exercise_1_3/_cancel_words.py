"""What a client says of how its goal ended, in the run in which it was canceled and in the one in which it succeeded.

Any human language is right, and a number is as good as a name. But a word that names one outcome must not be said of
the other, whatever number stands beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2
from exercise_1_3._cancel_evidence import after_result

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Part

_NUMBER = re2.compile(r"\d+(?:\.\d+)*")
CANCELED = "was canceled"
SUCCEEDED = "succeeded in spite of the cancel request"
"""How the two goals end."""
_CANCELED = r"(?:cancel+ed|abgebrochen|annul\w*)"
_SUCCEEDED = r"(?:succeeded|success)"
_ABORTED = "aborted"
_YES, _NO = r"(?:true|yes|ja|oui|sí|si)", r"(?:false|no|nein|non)"
_IS = r"\w*[\"']?\s*(?:=|:|->|is|was|ist|\?)+\s*"
_DOUBTFUL = r"not |n't|refus|reject|fail|nicht|unable|could|instead|denied|unknown|expect|want|but|should"
"""Words of who says that something is otherwise than it was meant to be."""


def says_canceled(lines: Sequence[str], elsewhere: Sequence[str] = (), otherwise: Sequence[str] = ()) -> bool:
    """Whether a line names the status CANCELED, by its name or by its number 5 (action_msgs/msg/GoalStatus).

    Args:
        lines: What was said.
        elsewhere: What was said in the run with a goal that was not canceled: a 5 in the same place of a line there is
            no status.
        otherwise: What was said there of how the goal ended: a name that is in the same line there tells nothing.
    """
    ends = {_shape(line) for line in otherwise}
    return any(
        (_names_canceled(line) and _shape(line) not in ends) or _has_the_number(line, elsewhere)
        for line in lines
    )


def _has_the_number(line: str, elsewhere: Sequence[str]) -> bool:
    twins = [_numbers(other) for other in elsewhere if _shape(other) == _shape(line)]
    return any(
        number == "5" and all(twin[place] != "5" for twin in twins)
        for place, number in enumerate(_numbers(line))
    )


def _numbers(line: str) -> list[str]:
    return _NUMBER.findall(_without_lists(line))


def _shape(line: str) -> str:
    """A line with a place for each number, so that two lines for two goals can be compared."""
    return _NUMBER.sub("#", _without_lists(line))


def _names_canceled(line: str) -> bool:
    return re2.search(r"(?i)cancel|abgebrochen|annul", _without_lists(line)) is not None


def _without_lists(line: str) -> str:
    # The numbers of a sequence are not a status.
    return re2.sub(r"\[[^\]]*\]|\([\d, ]*\)", "", line)


def false_claim(honoured: Part, refused: Part) -> tuple[str, str] | None:
    """What it says of one of the two goals and is true of the other only, and how the goal that it says it of ended.

    None where it says nothing of the kind.
    """
    if refused.first("result") is None:
        return None
    of_canceled, of_succeeded = after_result(honoured), after_result(refused)
    for said, ended, is_false in (
        (
            of_succeeded,
            SUCCEEDED,
            lambda line: _flag(_CANCELED, line) is True or _flag(_SUCCEEDED, line) is False,
        ),
        (
            of_canceled,
            CANCELED,
            lambda line: _flag(_CANCELED, line) is False or _flag(_SUCCEEDED, line) is True,
        ),
        (of_succeeded, SUCCEEDED, lambda line: _is_the_goal_s_end(_CANCELED, line)),
        (of_canceled, CANCELED, lambda line: _is_the_goal_s_end(_SUCCEEDED, line)),
        (of_succeeded, SUCCEEDED, _says_aborted),
    ):
        false = next(filter(is_false, said), None)
        if false is not None:
            return false, ended
    claimed = _claimed(refused)
    return None if claimed is None else (claimed, SUCCEEDED)


def _says_aborted(line: str) -> bool:
    """Whether a line says of a goal that it was aborted, and does not speak of success."""
    return _is_the_goal_s_end(_ABORTED, line) and not re2.search(r"(?i)succe|erfolg", _without_lists(line))


def _flag(word: str, line: str) -> bool | None:
    """What a line says behind the word, as ``canceled=True`` does; None where it says neither yes nor no."""
    found = re2.search(rf"(?i)\b(?:\w+_)?{word}{_IS}(?P<flag>{_YES}|{_NO})\b", line)
    return None if found is None else re2.fullmatch(f"(?i){_YES}", found["flag"]) is not None


def _is_the_goal_s_end(word: str, line: str) -> bool:
    """Whether the word is what became of the goal, as in "the goal was canceled" or "status: CANCELED"."""
    plain = _without_lists(line)
    if re2.search(f"(?i){_DOUBTFUL}", plain) or (word == _SUCCEEDED and _names_canceled(line)):
        return False
    of_the_goal = r"\b(?:goal|it|ziel)\s+(?:is |was |has been |got |wurde |ended as |ended )?"
    of_its_status = r"\b(?:status|state|zustand|outcome)\s*(?:is|was|=|:)?[\s\d()\[\]'\"=:-]*"
    return any(
        not re2.match(r"(?i)\s+after\b|\s*(?:=|:|->|\?)", plain[found.end() :])
        for found in re2.finditer(rf"(?i)(?:{of_the_goal}|{of_its_status}){word}\b", plain)
    )


def _claimed(refused: Part) -> str | None:
    """What it says that amounts to "the goal was canceled" although the goal succeeded, without a word of doubt."""
    # An exception that ends the program says something, too.
    raised = [line for line in refused.traceback.splitlines() if line.strip()][-1:]
    said = [*after_result(refused), *raised] or (refused.said() if refused.first("result_request") else [])
    claims = [line for line in said if _names_canceled(line) and _flag(_CANCELED, line) is not False]
    doubts = f"(?i){_DOUBTFUL}|succe|erfolg|4"
    if not claims or any(re2.search(doubts, _without_lists(line)) for line in said):
        return None
    return claims[-1]
