"""Says what the values of the first step that differs show, for an unnamed mistake: a sentence, and the next step."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit.oracle.naming.deltas import rows, steps_apart
from autograder.kit.oracle.naming.step_words import input_of
from autograder.kit.oracle.outputs import Kind
from autograder.kit.rules import same, value

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from autograder.kit.evidence import Event, Part
    from autograder.kit.oracle.outputs import Output

Hint = tuple[str, str]
"""What is wrong, and the next step for the student."""
LONGEST_PIECE, ALIKE = 30, 4
"""The most letters that are missing in a text, or too many, for a card to say so; and how many have to follow alike."""
_WHOLE_MESSAGE = re2.compile(r"\.(?:msg|srv|action)\.\w+\(")
_NUMBER = re2.compile(r"\d")
COPIED = (
    "Your success is what the request asks for; it has to say whether the request was carried out.",
    "Set success as the task says, whatever the data of the request is.",
)
LETTER_BY_LETTER = "Compare the two texts letter by letter: each letter, sign and space counts."


def hint(output: Output, run: Part, due: Part) -> Hint | None:
    """Return what the first step shows in which an output is not the solution's; None if its values show nothing.

    Args:
        output: The output.
        run: The run of the subject.
        due: The run of the solution in the same drawing.
    """
    if output.kind is not Kind.STEPS:
        return None
    mine, theirs = rows(output, run), rows(output, due)
    steps = steps_apart(mine, theirs, output.tolerance)
    if not steps:
        return None
    came, asked = mine[steps[0]], theirs[steps[0]]
    if told := _too_often(came, asked) or (None if asked else _late(output, run, came)):
        return told
    inputs = [event for event, step in _inputs(output, run) if step <= steps[0]]
    texts = [list(_texts(list(values.values()))) for values in (mine, theirs)]
    for path, one, other in _pairs(output, came, asked):
        if path == "success" and other is True and _is_copied(output, run, mine):
            return COPIED
        are_texts = isinstance(one, str) and isinstance(other, str)
        if are_texts and (told := _of_a_text(one, other, inputs) or _a_piece(one, other, *texts)):
            return told
    falls = (
        f"The numbers of your {path} on {output.name} go up; the task asks for numbers that go down."
        for step in steps
        for path, one, other in _pairs(output, mine[step], theirs[step])
        if _rises(one) and _rises(other, -1)
    )
    counts = "Read which of the two the task asks for: what is done, or what is left."
    return next(((told, counts) for told in falls), None)


def _inputs(output: Output, run: Part) -> Iterator[tuple[Event, int]]:
    """Yield each input with the number of its step, in order."""
    noted = run.of("noted", output.name)
    for place, one in enumerate(noted):
        if event := input_of(one, noted[:place], run):
            yield event, one.data["step"]


def _is_copied(output: Output, run: Part, mine: Mapping[int, Any]) -> bool:
    """Return True if the field success of each answer is the data of its request."""
    column = output.paths.index("success")
    asked = [(value(event), mine[step]) for event, step in _inputs(output, run) if event.name == output.name]
    return bool(asked) and all(answer and answer[0][column] is data for data, answer in asked)


def _pairs(output: Output, came: Sequence[Any], asked: Sequence[Any]) -> Iterator[tuple[str, Any, Any]]:
    """Yield the fields that differ in the first message that does: the path, the subject's value and the solution's."""
    for mine, theirs in zip(came, asked, strict=False):
        if not same(mine, theirs, output.tolerance):
            fields = zip(output.paths, mine, theirs, strict=False)
            yield from (one for one in fields if not same(*one[1:], output.tolerance))
            return


def _too_often(came: Sequence[Any], asked: Sequence[Any]) -> Hint | None:
    if len(asked) != 1 or len(came) < 2 or any(one != asked[0] for one in came):
        return None
    return (
        f"Your node says the same {len(came)} times, and it is due once.",
        "Look at each line that says it, and at what comes before it: only one of them may run, once. Perhaps a return "
        "is missing, or the line is in a loop.",
    )


def _late(output: Output, run: Part, came: Sequence[Any]) -> Hint | None:
    """Return that an answer was used after the subject had said something else instead, as that it gives up."""
    events = [event for event in run.events if event.kind in ("sent", "request", "response", "message")]
    told = [event for event in events if event.kind != "message" or event.name == output.name]
    for asks, gives_up, answer, uses in zip(told, told[1:], told[2:], told[3:], strict=False):
        kinds = tuple(event.kind for event in (asks, gives_up, answer, uses))
        is_late = kinds == ("request", "message", "response", "message") and asks.name == answer.name
        if is_late and [value(uses)] == came[0]:
            return (
                f"Your node says “{value(gives_up)}”, and then uses the answer of {answer.name} all the same.",
                "Close a question when you give it up. An answer counts only if its question is still the open one.",
            )
    return None


def _of_a_text(came: str, asked: str, inputs: Sequence[Event]) -> Hint | None:
    if came.startswith(f"{asked}, long after"):
        return (
            "Your server agrees to cancel the goal, and works on for long before it ends it.",
            "Look at is_cancel_requested of the goal handle before each piece of the work, and end the goal at once.",
        )
    if _WHOLE_MESSAGE.search(came) and not _WHOLE_MESSAGE.search(asked):
        return (
            "Your text has a whole message in it, with its type, and only one field of it is due.",
            "Write the field into the text, as in message.data, and not the message.",
        )
    return _of_another_input(came, asked, inputs)


def _of_another_input(came: str, asked: str, inputs: Sequence[Event]) -> Hint | None:
    told = [str(value(event)) for event in inputs]
    for older in told[:-1]:
        if older in asked and asked.replace(older, told[-1], 1) == came:
            return (
                f"Your node says {told[-1]}, which came last, where {older} is due: what came before is lost.",
                "An attribute of self has only the newest value. Keep what belongs to one input in a variable of its "
                "callback, and hand it on, as with partial(...).",
            )
    return None


def _a_piece(came: str, asked: str, all_came: Sequence[str], all_asked: Sequence[str]) -> Hint | None:
    """Return that words or signs are missing in a text, or too much, each time; behind them the texts go on alike."""
    letters = zip(came, asked, strict=False)
    begin = next((n for n, (one, other) in enumerate(letters) if one != other), min(len(came), len(asked)))
    for words, shorter, longer, never in (
        ("is missing", came, asked, all_came),
        ("is too much", asked, came, all_asked),
    ):
        for place in range(begin + 1, min(begin + LONGEST_PIECE, len(longer)) + 1):
            piece, behind = longer[begin:place], min(ALIKE, len(shorter) - begin, len(longer) - place)
            goes_on = shorter[begin : begin + behind] == longer[place : place + behind]
            if (
                goes_on
                and (behind or place == len(longer))
                and not (piece[-1].isalnum() or _NUMBER.search(piece))
            ):
                # A sign alone stands elsewhere, too.
                usual = (
                    piece.strip()
                    if any(map(str.isalpha, piece))
                    else longer[max(0, begin - ALIKE) : place + behind]
                )
                is_usual = any(usual in one for one in never)
                return None if is_usual else (f"In your text, “{piece}” {words}.", LETTER_BY_LETTER)
    return None


def _texts(values: Any) -> Iterator[str]:
    """Yield all texts in the values of an output."""
    if isinstance(values, str):
        yield values
    elif isinstance(values, (list, tuple)):
        for one in values:
            yield from _texts(one)


def _rises(numbers: Any, sign: int = 1) -> bool:
    if not isinstance(numbers, (list, tuple)) or len(numbers) < 2:
        return False
    are_numbers = all(isinstance(one, (int, float)) for one in numbers)
    return are_numbers and all(sign * (b - a) > 0 for a, b in pairwise(numbers))
