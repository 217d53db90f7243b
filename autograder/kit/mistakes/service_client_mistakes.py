"""Known mistakes of clients that call a service and report the answers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.model import mistake
from autograder.kit.reading.service_calls import (
    ClientSeen,
    answers,
    ended_before_its_answer,
    new_words,
    pair,
    reports,
    requests,
    returns_another,
)
from autograder.kit.reading.texts_said import mentions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from autograder.kit.evidence import Evidence, Part


def _does_not_wait_for_answers(evidence: Evidence) -> bool:
    served, calls = ClientSeen(evidence).served, ClientSeen(evidence.reference).calls
    # One of the answers comes late. A client that made all its calls nevertheless has waited for the late answer.
    waits = any(len(requests(part)) >= calls for part in served if part.of("response"))
    return any(
        ended_before_its_answer(part)
        or _gave_up_on_its_answer(part, served)
        or (((calls > 1 and not waits) or part.traceback) and _made_nothing_of_its_answer(part))
        for part in served
    )


def _gave_up_on_its_answer(part: Part, served: Sequence[Part]) -> bool:
    """Return True if the client printed something unusual before its answer came, such as a line about a timeout.

    A line is unusual if the client prints it in no run in which it reports the answer. The client may have given up
    although its process still existed when the answer was sent, because a process takes time to end.
    """
    asked, given = part.first("request"), part.first("response")
    quick = [other for other in served if other is not part and reports(other)]
    if not (part.ending and asked and given and quick) or reports(part):
        return False
    usual = {re2.sub(r"\d+", "#", line) for other in quick for line in other.said()}
    before = replace(part, events=part.events[: part.events.index(given)])
    return any(re2.sub(r"\d+", "#", line) not in usual for line in before.said(after=asked))


def _made_nothing_of_its_answer(part: Part) -> bool:
    """Return True if the subject ended at its first answer and did nothing that shows that it used the answer.

    A client uses the answer if it makes another call, or prints a number that is derived from the answer. If a task
    asks for only one call, use this function only after an exception: a client without an exception may have waited,
    and only not have reported the sum.
    """
    if part.ending is None or len(requests(part)) != 1 or len(part.of("response")) != 1:
        return False
    own = {str(abs(number)) for number in part.inputs.get("numbers", ())}
    told = (number for line in new_words(part) for number in re2.findall(r"\d{3,}", line))
    return answers(part)[0] != 0 and all(number in own for number in told)


ANSWER_NOT_AWAITED = mistake(
    "result_read_too_early",
    _does_not_wait_for_answers,
    "Your client called the service, but did not wait for the answer, which may take a second.",
    "Wait for the future that call_async returned, with rclpy.spin_until_future_complete(your_node, your_future, "
    "timeout_sec=5.0). Check its done() before you read its result().",
)


def _dislikes_zero(evidence: Evidence) -> bool:
    """Return True if the client fails to report the answer only in runs in which the last answer is 0."""
    served = ClientSeen(evidence).served
    wrong = [part for part in served if part.ending and not reports(part)]
    zero = all(answers(part)[-1:] == [0] and not ended_before_its_answer(part) for part in wrong)
    return bool(wrong) and zero and any(map(reports, served))


ZERO_TAKEN_FOR_FAILURE = mistake(
    "zero_taken_for_failure",
    _dislikes_zero,
    "The service answered 0, but your client treated 0 as a missing answer. 0 is a valid sum.",
    "An `if` that tests only the sum is False for 0, too. Test done() of the future that call_async returned, or "
    "compare the answer with `is not None`.",
    certain=True,
)


def _returns_another_each_time(evidence: Evidence) -> str | None:
    served = [part for part in ClientSeen(evidence).served if part.of("response")]
    wrong = bool(served) and all(returns_another(part) and _says_the_answer(part) for part in served)
    return served[0].returned if wrong else None


def _says_the_answer(part: Part) -> bool:
    return mentions(part.said(after=part.of("response")[-1]), answers(part)[-1])


NOT_RETURNED = mistake(
    "not_returned",
    _returns_another_each_time,
    "Your function prints the sum, but returns {}, so the code that calls your function cannot use the sum.",
    "End your function with `return` and the sum as a number: the field `sum` of the answer.",
    certain=True,
)


def _asks_for_nothing(evidence: Evidence) -> bool:
    made = [pair(event) for part in ClientSeen(evidence).served for event in requests(part)]
    return bool(made) and all(pair == [0, 0] for pair in made)


FIELDS_NEVER_FILLED = mistake(
    "field_typo",
    _asks_for_nothing,
    "Every call asks for 0 + 0: your code did not set the fields of the request.",
    "Set the fields a and b of the request. Check their spelling: AddTwoInts.Request(...) ignores a misspelled "
    "keyword silently.",
    certain=True,
)
