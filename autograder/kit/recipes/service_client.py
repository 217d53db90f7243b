"""A recipe for a client that lets a service add numbers, with the mistakes of such clients.

For the runs of the client see :mod:`.service_runs`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.lateness import stays_for_an_answer
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, OTHER_SLIPS
from autograder.kit.mistakes.hangs import HANGS
from autograder.kit.mistakes.role_mistakes import BY_ROLE, Stage
from autograder.kit.model import Advice, Finding, Mistake, card_words, filled_in, mistake
from autograder.kit.recipes.service_runs import drawn_runs, extreme, negative, scenario
from autograder.kit.reported_texts import mentions
from autograder.kit.service_calls import (
    WAIT,
    ClientSeen,
    answers,
    braces_left,
    cut_short,
    ended_before_its_answer,
    how_it_went,
    new_words,
    pair,
    reports,
    requests,
    returns_another,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence, Part

_WORDS = card_words(__file__)


class Calls:
    """The recipe for a client that lets a service add numbers.

    The recipe recognizes the mistakes ``service_name``, ``message_type``, ``called_too_early``, ``usage_message``,
    ``waits_forever``, ``await_in_same_group``, ``too_many_calls``, ``wrong_arguments``, ``no_call``,
    ``wrong_sum_reported``, ``sum_not_reported``, ``zero_taken_for_failure``, ``not_returned``,
    ``gave_up_too_early``, ``silent_end``, ``patience_not_kept``.

    Args:
        calls: The number of calls of a client that has finished its work.
            The first call adds the first two numbers, each later one the answer before and the next number.
        wanted: The right calls in words, for the card.

    Example::

        recipe = Calls(1, wanted="one call with the two numbers, in each run")
    """

    roles = ("client",)

    def __init__(self, calls: int, *, wanted: str) -> None:
        self._calls, self._wanted = calls, wanted

    def scenario(self, bench: Bench) -> None:
        """Make four runs: a late service, hidden numbers in the answers, large numbers, and no service."""
        runs = drawn_runs(bench.random, self._calls)
        # Not of the everyday kind: with zeros the sum is one of the numbers, and a client may say what it will ask.
        numbers = bench.random.choice((negative, extreme))(bench.random, self._calls + 1)
        scenario(bench, runs, numbers, calls=self._calls)

    def seen(self, evidence: Evidence) -> ClientSeen:
        """Return the subject's client, as the judge saw it."""
        return ClientSeen(evidence)

    def expected(self, evidence: Evidence) -> ClientSeen:
        """Return the client of the reference solution, as it was recorded."""
        return ClientSeen(evidence.reference)

    def _is_right(self, part: Part) -> bool:
        """Return True if a run has the right number of calls, with the right numbers, and stays for the answers."""
        as_many = len(requests(part)) == self._calls and not ended_before_its_answer(part)
        return as_many and self._is_right_so_far(part)

    def _is_right_so_far(self, part: Part) -> bool:
        made = list(map(pair, requests(part)))
        first, *later = part.inputs["numbers"]
        right = zip([first, *answers(part)], later, strict=False)
        return made == list(map(sorted, right))[: len(made)]

    def calls_right(self, evidence: Evidence) -> Finding:
        """Decide whether each run has the right calls."""
        seen, wanted = self.seen(evidence), self._wanted
        wrong = next((part for part in seen.served if not self._is_right(part)), None)
        if wrong is None:
            return Finding(True, wanted, wanted)
        if not wrong.events and (hung := cut_short(seen)):
            return Finding(False, wanted, hung)
        if ended_before_its_answer(wrong):
            return Finding(False, wanted, f"it ended before its answer came ({wrong.name})")
        return Finding(False, wanted, _calls_in_words(wrong))

    def waits(self, evidence: Evidence) -> Finding:
        """Decide whether the client calls even if the service comes late; another criterion judges the result.

        Of a client that stays for no answer, chance decides whether its request arrives.
        """
        seen = self.seen(evidence)
        hasty = next(filter(_stays_for_no_answer, seen.served), None)
        if hasty and not any(map(reports, seen.served)):
            return Finding(False, "waits, then calls", f"it ended before its answer came ({hasty.name})")
        called = bool(requests(seen.late))
        return Finding(called, "waits, then calls", "it did" if called else how_it_went(seen.late))

    def _too_many_calls(self, evidence: Evidence) -> int:
        """Return the number of calls in a run with more calls than the reference solution makes; 0 if there is none."""
        counts = (len(requests(part)) for part in self.seen(evidence).served)
        return next((count for count in counts if count > self.expected(evidence).calls), 0)

    def _wrong_numbers(self, evidence: Evidence) -> str:
        """Return in words the calls of a run with wrong numbers; empty if there is none.

        The text is also empty if a run has too few or too many calls, because that is another mistake.
        """
        as_many = self.seen(evidence).called(self.expected(evidence).calls)
        wrong = (part for part in self.seen(evidence).served if not self._is_right_so_far(part))
        return next(map(_calls_in_words, wrong), "") if as_many else ""

    def _dislikes_zero(self, evidence: Evidence) -> bool:
        """Return True if the client is wrong only in runs in which it took an answer of 0 for a missing answer."""
        served = self.seen(evidence).served
        wrong = [part for part in served if part.ending and not (self._is_right(part) and reports(part))]
        misread = all(
            _own_sum_for_zero(part)
            or (
                answers(part)[-1:] == [0]
                and not reports(part)
                and not ended_before_its_answer(part)
                and self._is_right_so_far(part)
            )
            for part in wrong
        )
        return bool(wrong) and misread and any(map(reports, served))

    def _no_call(self, evidence: Evidence) -> bool:
        """Return True if the subject has a client and ends by itself, but makes no call."""
        seen = self.seen(evidence)
        return seen.had_client and any(part.ending and not requests(part) for part in seen.served)

    def _unreported(self, evidence: Evidence) -> Part | None:
        """Return a run with the right calls whose last answer is not reported; None if there is none."""
        answered = (part for part in self.seen(evidence).served if part.of("response"))
        return next((part for part in answered if self._is_right(part) and not reports(part)), None)

    def _another_sum(self, evidence: Evidence) -> tuple[int, str] | None:
        """Return the last answer to the client in a run, and the line with another number that it printed instead.

        None if the client reported the last answer in each run, or printed no other number.
        """
        part = self._unreported(evidence)
        if part is None:
            return None
        answer = answers(part)[-1]
        said = reversed(part.said(after=part.of("response")[-1]))
        line = next((line for line in said if re2.search(r"\d", line) and not mentions([line], answer)), None)
        return None if line is None else (answer, line)

    def _sum_not_said(self, evidence: Evidence) -> Advice | None:
        part = self._unreported(evidence)
        return (braces_left(part) or _SUM_NOT_SAID) if part else None

    def _about_the_sum(self) -> Iterator[Mistake]:
        """Yield the mistakes of a client with right calls that does not report the sum."""
        another = mistake("wrong_sum_reported", self._another_sum, *_WORDS["wrong_sum_reported"])
        for one in (another, Mistake("sum_not_reported", self._sum_not_said)):
            yield common.only_if_ended(one)
            yield one

    @property
    def ladder(self) -> tuple[Mistake, ...]:
        """The common mistakes, most specific first."""
        return (
            WAIT.the_wrong_way_round(),
            *CRASHES,
            *BY_ROLE["client"][Stage.FIRST],
            *BY_ROLE["client"][Stage.NAMED],
            *OTHER_SLIPS,
            unfinished.NOT_BEGUN,
            unfinished.USAGE_MESSAGE,
            WAIT.for_nobody(),
            WAIT.for_ever(),
            *(replace(hang, certain=True) for hang in (*HANGS, common.AWAITS_IN_VAIN)),
            FIELDS_NEVER_FILLED,
            mistake("too_many_calls", self._too_many_calls, *_WORDS["too_many_calls"], certain=True),
            OWN,
            mistake(
                "zero_taken_for_failure", self._dislikes_zero, *_WORDS["zero_taken_for_failure"], certain=True
            ),
            mistake(
                "wrong_arguments",
                self._wrong_numbers,
                f"A call has wrong numbers ({{}}); the task asks for {self._wanted}.",
                "The first call has the first two numbers, each later one the answer before and the next number. Use "
                "the numbers that your code was given, with their minus signs. On a command line, they begin "
                "with sys.argv[1]; sys.argv[0] is the program's name. If you use the same request object twice, set "
                "both fields again.",
                certain=True,
            ),
            NOT_RETURNED,
            WAIT.too_short(),
            ANSWER_NOT_AWAITED,
            ANSWER_NOT_USED,
            OWN_LATE,
            mistake("no_call", self._no_call, *_WORDS["no_call"], uses=("wait_for_service", "call_async")),
            *self._about_the_sum(),
            WAIT.silent_end(certain=True),
            WAIT.patience_not_kept(),
            *OTHER_CRASHES,
            *unfinished.NOTHING_THERE,
        )


def _calls_in_words(part: Part) -> str:
    """Return the first calls of a run, and the numbers that the client was given, such as "for 1, 2: 1 + 1"."""
    made = [f"{e.data['fields']['a']} + {e.data['fields']['b']}" for e in requests(part)[:3]]
    numbers = ", ".join(map(str, part.inputs.get("numbers", ())))
    given = f"for {numbers}: " if numbers else ""
    return given + (", then ".join(made) or "no call")


def _stays_for_no_answer(part: Part) -> bool:
    return ended_before_its_answer(part) and not stays_for_an_answer(part, "request")


def _does_not_wait_for_answers(evidence: Evidence) -> bool:
    served = ClientSeen(evidence).served
    return any(ended_before_its_answer(part) or _gave_up_on_its_answer(part, served) for part in served)


def _uses_no_answer(evidence: Evidence) -> int | None:
    """Return an answer with which the client did nothing; None if it used all of them.

    The client may not have waited for the answer, or may have waited for it and then refused it.
    """
    served, calls = ClientSeen(evidence).served, ClientSeen(evidence.reference).calls
    # One of the answers comes late. A client that made all its calls nevertheless has waited for the late answer.
    waits = any(len(requests(part)) >= calls for part in served if part.of("response"))
    unused = (
        part
        for part in served
        if ((calls > 1 and not waits) or part.traceback) and _made_nothing_of_its_answer(part)
    )
    return next((answers(part)[0] for part in unused), None)


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
    """Return True if the subject ended when it got its first answer, and nothing shows that it used the answer.

    A client uses the answer if it makes another call, or prints a number that is derived from the answer. If a task
    asks for only one call, use this function only after an exception: a client that ended without one may have waited
    for the answer and just not have printed the sum.
    """
    if part.ending is None or len(requests(part)) != 1 or len(part.of("response")) != 1:
        return False
    own = {str(abs(number)) for number in part.inputs.get("numbers", ())}
    told = (number for line in new_words(part) for number in re2.findall(r"\d{3,}", line))
    return answers(part)[0] != 0 and all(number in own for number in told)


_WAIT_FOR_THE_ANSWER = (
    "Wait for the future that call_async returned, with rclpy.spin_until_future_complete(your_node, your_future, "
    "timeout_sec=5.0). Check its done() before you read its result()."
)
ANSWER_NOT_AWAITED = mistake(
    "result_read_too_early",
    _does_not_wait_for_answers,
    "Your client called the service, but did not wait for the answer, which may take a second.",
    _WAIT_FOR_THE_ANSWER,
)
ANSWER_NOT_USED = mistake(
    "result_read_too_early",
    _uses_no_answer,
    "The service answered {}, and your client ended without using this answer.",
    f"{_WAIT_FOR_THE_ANSWER} If your client waits, look at the condition after that: a sum may be 0 or negative.",
)


def _own_sum_for_zero(part: Part) -> bool:
    """Return True if a call that follows an answer of 0 has the client's own sum instead of this answer."""
    made = list(map(pair, requests(part)))
    return any(
        answer == 0 and sum(before) in after
        for before, after, answer in zip(made, made[1:], answers(part), strict=False)
    )


def _returns_another_each_time(evidence: Evidence) -> str | None:
    served = [part for part in ClientSeen(evidence).served if part.of("response")]
    wrong = bool(served) and all(map(_says_the_answer_but_returns_another, served))
    return served[0].returned if wrong else None


def _says_the_answer_but_returns_another(part: Part) -> bool:
    return returns_another(part) and mentions(part.said(after=part.of("response")[-1]), answers(part)[-1])


NOT_RETURNED = mistake("not_returned", _returns_another_each_time, *_WORDS["not_returned"], certain=True)


def _asks_for_nothing(evidence: Evidence) -> bool:
    made = [pair(event) for part in ClientSeen(evidence).served for event in requests(part)]
    return bool(made) and all(pair == [0, 0] for pair in made)


FIELDS_NEVER_FILLED = mistake("field_typo", _asks_for_nothing, *_WORDS["field_typo"], certain=True)


_SUM_NOT_SAID = filled_in(_WORDS["sum_not_said"])
