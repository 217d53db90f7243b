"""Says what the values of the first step that differs show, for an unnamed mistake: a sentence, and the next step."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import re2

from autograder.kit.in_words import counted
from autograder.kit.model import card_words, filled_in
from autograder.kit.oracle.naming.deltas import alike, rows, steps_apart
from autograder.kit.oracle.naming.step_words import WAITED, input_in_words, input_of, inputs_of, is_wait
from autograder.kit.oracle.outputs import Kind
from autograder.kit.rules import same, value

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from autograder.kit.evidence import Event, Part
    from autograder.kit.model import Advice
    from autograder.kit.oracle.outputs import Output

_WORDS = card_words(__file__)
LONGEST_PIECE, ALIKE = 30, 4
"""The most letters that are missing in a text, or too many, for a card to say so; and how many have to follow alike."""
AT_ONCE, EARLY, LATE = 0.05, 0.06, 0.11
"""Seconds: between two messages of one callback, and by which a timer that looks ten times a second may be apart."""
ANSWERS = ("response", "goal_answered", "feedback", "result")
"""The kinds of events that a node may answer with a message at any time."""
LAST, MANY = 3, 3
"""The number of inputs that may have set a timer, and of messages from which on a number of them may be meant."""
_WHOLE_MESSAGE = re2.compile(r"\.(?:msg|srv|action)\.\w+\(")
_NUMBER = re2.compile(r"\d")


def hint(output: Output, run: Part, due: Part, seconds: Sequence[float] = ()) -> Advice | None:
    """Return what the first step shows in which an output is not the solution's; None if its values show nothing.

    Args:
        output: The output.
        run: The run of the subject.
        due: The run of the solution in the same drawing.
        seconds: The times that the task names.
    """
    if output.kind is not Kind.STEPS:
        return None
    mine, theirs = rows(output, run), rows(output, due)
    steps = steps_apart(mine, theirs, output.tolerance)
    if not steps:
        return None
    came, asked = mine[steps[0]], theirs[steps[0]]
    between, is_silent = _events(output, run, steps[0])
    said = _messages(output, between, len(came))
    if told := (
        _of_rejected(between)
        or _too_often(came, asked, said)
        or (None if asked else _late(output, run, came))
        or (_set_going(said, is_silent, run, seconds) if said and len(came) > len(asked) else None)
        or _too_few(output, came, asked, mine)
        or _too_late(output, run, came, asked, theirs, seconds)
        or (_not_set_going(output, run, steps[0], mine, seconds) if asked and not came else None)
        or _too_early(came, asked, mine, theirs)
    ):
        return told
    inputs = [event for event, step in _inputs(output, run) if step <= steps[0]]
    texts = [list(_texts(list(values.values()))) for values in (mine, theirs)]
    for path, one, other in _pairs(output, came, asked):
        if path == "success" and other is True and _is_copied(output, run, mine):
            return filled_in(_WORDS["copied"])
        are_texts = isinstance(one, str) and isinstance(other, str)
        if are_texts and (told := _of_a_text(one, other, inputs) or _a_piece(one, other, *texts)):
            return told
    falls = (
        filled_in(_WORDS["rises"], path=path, name=output.name)
        for step in steps
        for path, one, other in _pairs(output, mine[step], theirs[step])
        if _rises(one) and _rises(other, -1)
    )
    return next(falls, None)


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


def _events(output: Output, run: Part, step: int) -> tuple[Sequence[Event], bool]:
    """Return the events of a step, and whether the judge only let time pass in it."""
    noted = run.of("noted", output.name)
    place = next(n for n, one in enumerate(noted) if one.data["step"] == step)
    start = run.events.index(noted[place - 1]) if place else 0
    return run.events[start : run.events.index(noted[place])], is_wait(noted[place])


def _messages(output: Output, between: Sequence[Event], number: int) -> list[Event]:
    """Return the messages of an output in a step. There are none if they are not as many as the step has.

    A look in real time notes all steps at its end, so that the events do not show which message belongs to which step.
    """
    messages = [event for event in between if event.kind == "message" and event.name == output.name]
    return messages if len(messages) == number else []


def _of_rejected(between: Sequence[Event]) -> Advice | None:
    is_asked = any(event.kind == "result_request" and not event.data.get("known", True) for event in between)
    return filled_in(_WORDS["of_rejected"]) if is_asked else None


def _too_often(came: Sequence[Any], asked: Sequence[Any], said: Sequence[Event]) -> Advice | None:
    if len(asked) != 1 or len(came) < 2 or any(one != asked[0] for one in came):
        return None
    if said and said[-1].moment - said[0].moment > AT_ONCE:
        return None
    return filled_in(_WORDS["too_often"], times=len(came))


def _runs_since(
    moment: float, inputs: Sequence[Event], seconds: Sequence[float]
) -> Iterator[tuple[Event, str]]:
    """Yield the newest inputs of which a time that the task names is over at a moment, with the seconds since then."""
    for event in reversed(inputs[-LAST:]):
        passed = moment - event.moment
        if any(-EARLY <= passed - one <= LATE for one in seconds):
            yield event, f"{passed:.2g}"


def _set_going(said: Sequence[Event], is_silent: bool, run: Part, seconds: Sequence[float]) -> Advice | None:
    """Return after which input a message came that is not due, if the node's time runs since then."""
    moment = said[-1].moment
    inputs = [event for event in inputs_of(run) if event.moment < moment]
    for event, passed in _runs_since(moment, inputs[:-1], seconds):
        newer = input_in_words(inputs[inputs.index(event) + 1])
        return filled_in(_WORDS["not_set_back"], seconds=passed, given=input_in_words(event), newer=newer)
    comes_of_it = any(
        event.kind in ANSWERS and inputs and inputs[-1].moment < event.moment <= moment
        for event in run.events
    )
    if not is_silent or not inputs or comes_of_it:
        return None
    passed = f"{moment - inputs[-1].moment:.2g}"
    return filled_in(_WORDS["by_a_timer"], seconds=passed, given=input_in_words(inputs[-1]))


def _too_few(
    output: Output, came: Sequence[Any], asked: Sequence[Any], mine: Mapping[int, Any]
) -> Advice | None:
    if not MANY <= len(came) < len(asked) or len(came) < max(map(len, mine.values())):
        return None
    if not alike(came, asked[: len(came)], output.tolerance):
        return None
    return filled_in(_WORDS["too_few"], times=len(came), name=output.name, due=len(asked))


def _too_late(
    output: Output,
    run: Part,
    came: Sequence[Any],
    asked: Sequence[Any],
    theirs: Mapping[int, Any],
    seconds: Sequence[float],
) -> Advice | None:
    """Return after which input a message comes that is due once and earlier, if the node's time runs since then."""
    due = [one for values in theirs.values() for one in values]
    missing = next((one for one in asked if one not in came and due.count(one) == 1), None)
    if missing is None:
        return None
    for said in run.of("message", output.name):
        inputs = [event for event in inputs_of(run) if event.moment < said.moment]
        if output.values([said]) == [missing]:
            for event, passed in _runs_since(said.moment, inputs[1:], seconds):
                given = input_in_words(event)
                return filled_in(_WORDS["set_back"], said=missing[0], seconds=passed, given=given)
    return None


def _not_set_going(
    output: Output, run: Part, step: int, mine: Mapping[int, Any], seconds: Sequence[float]
) -> Advice | None:
    """Return after which input nothing comes when the time is over, if it comes after another one."""
    noted = [event for event in run.of("noted", output.name) if is_wait(event)]
    ends = next((event for event in noted if event.data["step"] == step), None)
    if ends is None or not any(mine[event.data["step"]] for event in noted):
        return None
    inputs = [event for event in inputs_of(run) if event.moment < ends.moment]
    begins = ends.moment - float(ends.data["given"].removesuffix(WAITED))
    one = next((one for one in seconds if inputs and begins < inputs[-1].moment + one < ends.moment), None)
    if one is None:
        return None
    return filled_in(_WORDS["not_set_going"], seconds=f"{one:g}", given=input_in_words(inputs[-1]))


def _too_early(
    came: Sequence[Any], asked: Sequence[Any], mine: Mapping[int, Any], theirs: Mapping[int, Any]
) -> Advice | None:
    """Return that a text comes when it is due, and at other times, too."""
    extra = next((one for one in came if one not in asked), None)
    if not asked or extra is None or len(extra) != 1 or not isinstance(extra[0], str):
        return None
    numbers = [
        (list(mine[step]).count(extra), list(due).count(extra))
        for step, due in theirs.items()
        if step in mine
    ]
    times, due_times = (counted(sum(column), "time") for column in zip(*numbers, strict=True))
    is_due_elsewhere = any(due for _, due in numbers) and all(often >= due for often, due in numbers)
    if not is_due_elsewhere or any(one not in came for one in asked):
        return None
    return filled_in(_WORDS["too_early"], said=extra[0], times=times, due=due_times)


def _late(output: Output, run: Part, came: Sequence[Any]) -> Advice | None:
    """Return that an answer was used after the subject had said something else instead, as that it gives up."""
    events = [event for event in run.events if event.kind in ("sent", "request", "response", "message")]
    told = [event for event in events if event.kind != "message" or event.name == output.name]
    for asks, gives_up, answer, uses in zip(told, told[1:], told[2:], told[3:], strict=False):
        kinds = tuple(event.kind for event in (asks, gives_up, answer, uses))
        is_late = kinds == ("request", "message", "response", "message") and asks.name == answer.name
        if is_late and [value(uses)] == came[0]:
            return filled_in(_WORDS["late"], said=value(gives_up), service=answer.name)
    return None


def _of_a_text(came: str, asked: str, inputs: Sequence[Event]) -> Advice | None:
    if came.startswith(f"{asked}, long after"):
        return filled_in(_WORDS["works_on"])
    if _WHOLE_MESSAGE.search(came) and not _WHOLE_MESSAGE.search(asked):
        return filled_in(_WORDS["whole_message"])
    return _of_another_input(came, asked, inputs)


def _of_another_input(came: str, asked: str, inputs: Sequence[Event]) -> Advice | None:
    told = [str(value(event)) for event in inputs]
    for older in told[:-1]:
        if older in asked and asked.replace(older, told[-1], 1) == came:
            return filled_in(_WORDS["another_input"], newest=told[-1], older=older)
    return None


def _a_piece(came: str, asked: str, all_came: Sequence[str], all_asked: Sequence[str]) -> Advice | None:
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
                return None if is_usual else filled_in(_WORDS["piece"], piece=piece, words=words)
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
