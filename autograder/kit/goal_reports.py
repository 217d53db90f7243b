"""An action client's reports of the judge's goals, and their faults.

Any human language is right. So that a goal was refused or aborted counts as said where the client says something that
it does not say of a goal that succeeds, whatever the words are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import re2

from autograder.kit import outcome_words as words
from autograder.kit.crashes import last_line_of, on_purpose
from autograder.kit.evidence import INTERRUPTED
from autograder.kit.giving_up import asks_nowhere, looks_elsewhere, objection, remark
from autograder.kit.model import Finding
from autograder.kit.texts_said import mentions, said_first_after

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from autograder.kit.evidence import Event, Evidence, Part

LATE = "the server comes late"
REFUSED = "the goal is refused"
ABORTED = "the goal is aborted"
ABSENT = "there is no server"
"""In this part nobody serves; in the first one of any exercise a goal is accepted."""
SERVED = (LATE, REFUSED, ABORTED)
"""The parts in which a goal is expected."""

FEEDBACKS = 14
"""Feedback messages of the goal that succeeds: enough for a client that goes deaf after a while to be found out."""
NO_GOAL = "no goal"
ABOUT_A_REFUSED_GOAL = " about a goal that was rejected"
CANCELED = "a request to cancel the goal"
NOT_AWAITED = "it ended without taking in the answer to its goal"
MANY_REQUESTS = 3
"""Requests for one result that may have a reason; what asks more often goes on asking."""

AT_ONCE = 3.6
"""Seconds after an answer in which a client ends that never meant to take it in. A process takes a tenth of a second to
end, and more than one on a crowded machine. A client that spins for 5 seconds, as many do, ends later than this by more
than half a second, though its answer was held back; one that spins for 3 ends a second before."""
STAYED = 1.5
"""Seconds after a request: of a client that is still there then, it did not go under with its process."""
_CANCELED = "cancel+ed"
"""In other languages one word may stand for canceled and for aborted."""
_FAILURES = (_CANCELED, words.ABORTED)
"""Words that nobody may say of a goal that succeeded or was refused."""
_WAYS = ("log", "output", "subject")
"""The kinds of events in which something is said: on /rosout, printed, returned."""
_ENDS = re2.compile(rf"(?i)\b(?:status_)?(?:{words.SUCCEEDED}|{'|'.join(_FAILURES)})\b")
"""The names of the ends that an accepted goal may have."""
_ACCEPTED = re2.compile(
    rf"(?i)(?:^\W*|\b(?:goal|it|ziel)\s+(?:is |was |has been |got |wurde )?){words.ACCEPTED}"
    r"(?:\s*[.,;!…]|\s*:[-']?\)|\s+\w|\s*$)"
)
"""Not a question, and no name of a value that follows."""
_TRACEBACK = "Traceback (most recent call last)"


def asked_for(part: Part) -> list[int]:
    """The orders of the goals, in order."""
    return [int(event.data["fields"]["order"]) for event in part.of("goal")]


def left_at_once(part: Part, answer: str = "goal_answered") -> bool:
    """True if the subject was about to end before the judge gave an answer that it holds back.

    A process that ends takes its last requests along, or it does not: nothing may depend on which of them arrived. Its
    traceback tells that it ends, before it has ended; and one that ends without a word may need a while for it.
    """
    if part.ending is None:
        return False
    for event in part.events:
        if event.kind == answer:
            # Who has failed only now has taken something in: the answer, or the feedback behind it.
            went_on = part.traceback or part.said(after=event) or _stayed_for_more(part, event)
            return not went_on and part.ending.t - event.t < AT_ONCE
        if event is part.ending or (event.kind == "output" and event.data["text"].startswith(_TRACEBACK)):
            return True
    return False


def _stayed_for_more(part: Part, answer: Event) -> bool:
    """True if it was there for its goal's result, or for a while after what it has asked for behind an answer."""
    assert part.ending is not None
    end, later = part.ending.t, part.events[part.events.index(answer) :]
    stayed = {"result": 0.0, "result_request": STAYED, "cancel": STAYED}
    return any(event.kind in stayed and end - event.t > stayed[event.kind] for event in later)


def goals_as_seen(evidence: Evidence) -> str:
    """The faults of the goals, in words."""
    if asked_for(evidence.part(LATE)) and left_at_once(evidence.part(LATE)):
        return NOT_AWAITED
    wanted = len(asked_for(evidence.reference.part(LATE)))
    parts = [evidence.part(name) for name in SERVED]
    for part in parts:
        orders = asked_for(part)
        if len(orders) > wanted:
            return f"{len(orders)} goals"
        if orders and orders[0] != part.inputs["order"]:
            return f"order {orders[0]} where {part.inputs['order']} was given"
        if part.name != REFUSED and cancels_unasked(part):
            return CANCELED
    missing = [part for part in parts if not asked_for(part)]
    if not missing or len(missing) == len(parts):
        return NO_GOAL if missing else ""
    tried = [part for part in missing if part.events]
    return (
        f"{NO_GOAL} where {tried[0].name}"
        if tried
        else f"{NO_GOAL} but the first: the other runs were left out"
    )


def cancels_unasked(part: Part) -> bool:
    """True if it asks to cancel its goal before that has ended; one that was interrupted may."""
    for event in part.events:
        if event.kind == "result" or event.name == INTERRUPTED:
            return False
        if event.kind == "cancel":
            return True
    return False


def unshown_feedback(part: Part) -> list[Event]:
    """The feedback messages whose newest number was not said after they were sent."""
    return [
        event for event in part.of("feedback") if not mentions(part.said(after=event), _sequence(event)[-1])
    ]


def _sequence(event: Event) -> list[int]:
    (numbers,) = event.data["fields"].values()
    return list(numbers)


def said_of_result(part: Part) -> list[str]:
    """The words after the result was sent, without late echoes of something said before."""
    return said_first_after(part.first("result"), part)


def reports_result(part: Part) -> bool:
    """Every number of the result was said after it was sent, in its order."""
    result = part.first("result")
    if result is None or part.first("result_request") is None:
        return False
    numbers = [str(number) for number in _sequence(result)]
    # A log line comes twice, as output and on /rosout: what is left out of one must not be found in the other.
    ways = ([event for event in part.events if event is result or event.kind == way] for way in _WAYS)
    return any(_are_in_order(numbers, replace(part, events=events).said(after=result)) for events in ways)


def _are_in_order(numbers: Sequence[str], lines: Sequence[str]) -> bool:
    # The numbers are long and random, so that their digits alone are told from whatever is between them.
    digits, place = re2.sub(r"\D", "", " ".join(lines)), 0
    for number in numbers:
        place = digits.find(number, place)
        if place < 0:
            return False
        place += len(number)
    return True


_SEQUENCE = re2.compile(r"[\[(]|[a-z.]+\((?:'\w', )?[\[(]|[a-z.]+\((?:'\w')?\)")
"""The beginning of a sequence's repr: ``[1``, ``(1``, ``array('i', [1``, ``array('i')``, ``deque([1``."""


def returned_instead(part: Part, wanted: Sequence[int]) -> str:
    """The value that a function returned in place of these numbers; empty where it is right, or no function.

    Any kind of sequence is taken for a list, such as a tuple or an array; a message that has one is none.
    """
    if part.returned is None:
        return ""
    # Beside the numbers may stand their type, as in np.int32(5), and how many there may be, as in deque([5], maxlen=9).
    numbers = re2.findall(r"\d+", re2.sub(r"int\d+|maxlen=\d+", "", part.returned))
    right = numbers == [str(number) for number in wanted]
    return "" if right and _SEQUENCE.match(part.returned) else part.returned


def miscalled(part: Part) -> str:
    """A line that calls a goal canceled or aborted that has succeeded; empty where there is none."""
    said = said_of_result(part)
    if any(re2.search(r"(?i)\bsucceeded\b", words.without_lists(line)) for line in said):
        # The other names may be in a table around the true one.
        return next((line for line in said for word in _FAILURES if words.flag(word, line)), "")
    for line in said:
        plain = words.without_lists(line)
        named = re2.search(r"(?i)\b(?:cancell?ed|aborted)\b", plain)
        if named and not re2.search(rf"(?i){words.DENIAL}|{words.SUCCESS}|\?|[=:] *0\b|\b4\b", plain):
            return line
    return ""


def shape(line: str) -> str:
    """A line without its numbers, however many there are in a list, so that two lines for two goals can be compared."""
    return re2.sub(r"\d+(?:[\s,;]+\d+)*", "#", line).strip()


def _new_words(lines: Sequence[str], *others: Part, reduced: Callable[[str], str] = shape) -> list[str]:
    """Those of the lines that were not said, with other numbers, in other runs; lines are compared as ``reduced``."""
    usual = {reduced(line) for part in others for line in part.said()}
    return [line for line in lines if reduced(line) not in usual]


def _waits(late: Part) -> bool:
    """True if it waits for a late server and a late answer; otherwise timing decides which runs it meets."""
    return bool(asked_for(late)) and not left_at_once(late)


def refused_as_seen(evidence: Evidence) -> str:
    """The fault in the report of a refused goal, in words.

    rclpy's blocking ``send_goal()`` asks for the result of a refused goal by itself. Who makes of its status 0 that the
    goal was refused has seen what there is to see; who says of it what it says of any status has not.
    """
    part = evidence.part(REFUSED)
    goal = part.first("goal")
    if not part.events:
        return "not reached"
    if goal is None or not _waits(evidence.main):
        return NOT_AWAITED if goal else NO_GOAL
    # An empty list, as a function may return one, is no word.
    lines = [line for line in part.said(after=goal) if re2.search(r"\pL", line)]
    if claim := called_accepted(evidence):
        return f"“{claim}”{ABOUT_A_REFUSED_GOAL}"
    said = [line for line in _new_words(lines, evidence.main) if not _tells_another(line, evidence)]
    raised = on_purpose(part.traceback) and not _tells_another(last_line_of(part.traceback), evidence)
    if part.first("result_request") is not None:
        accepted = [other for other in evidence if other.name not in (REFUSED, ABSENT)]
        new = _new_words(said, *accepted, reduced=_without_end)
        told = [line for line in new if not _names_unknown(line)]
        if not (told or raised):
            return "asked for the result of a goal that was rejected"
    if not (said or raised):
        other = [line for line in lines if _tells_another(line, evidence)]
        return f"“{other[-1]}”{ABOUT_A_REFUSED_GOAL}" if other else "nothing was said of it"
    # A client that goes on after a success, too, may go on here.
    if part.ending is None and evidence.main.ending is not None:
        return "said so, and did not end"
    return ""


def called_accepted(evidence: Evidence) -> str:
    """A line that calls the refused goal accepted, as it does where a goal was; empty where there is none."""
    part = evidence.part(REFUSED)
    goal = part.first("goal")
    of_accepted = {shape(line) for line in evidence.main.said()}
    said = part.said(after=goal) if goal is not None else []
    return next((line for line in said if shape(line) in of_accepted and _says_accepted(line)), "")


def _says_accepted(line: str) -> bool:
    return words.flag(words.ACCEPTED, line) is True or _ACCEPTED.search(line) is not None


def _tells_another(line: str, evidence: Evidence) -> bool:
    """True if a line tells of another end than a refusal: how an accepted goal ends, or that there is no server."""
    if re2.search(r"(?i)accept|reject|refus", line):
        return False
    if any(words.ends_as(word, line) for word in (words.SUCCEEDED, *_FAILURES)):
        return True
    absent = evidence.part(ABSENT)
    same = shape(line) in {shape(other) for other in (*absent.said(), last_line_of(absent.traceback))}
    return same and re2.search(r"(?i)\bserver\b|nobody|no one|time", line) is not None


def aborted_as_seen(evidence: Evidence) -> str:
    """The fault in the report of an aborted goal, in words. The goal's status is on a topic, too."""
    part = evidence.part(ABORTED)
    result = part.first("result")
    if not part.events:
        return "not reached"
    if result is None or not _waits(evidence.part(LATE)):
        return NOT_AWAITED if part.first("goal") else NO_GOAL
    said = said_of_result(part)
    late = {words.without_lists(line).strip() for line in evidence.part(LATE).said()}
    named = [line for line in said if _names_aborted(line) and words.without_lists(line).strip() not in late]
    if any("abort" in line.lower() for line in named):
        return ""
    for line in said:
        if any(words.ends_as(word, line) or words.flag(word, line) for word in (words.SUCCEEDED, _CANCELED)):
            return f"“{line}”"
    new = [line for line in _new_words(said, evidence.part(LATE)) if not _names_another(line)]
    raised = last_line_of(part.traceback)
    if (
        named
        or new
        or (on_purpose(part.traceback) and (_names_aborted(raised) or not _names_another(raised)))
    ):
        return ""
    if part.first("result_request") is None:
        return "never asked for the result"
    if raised and not said:
        return f"“{raised}”"
    return f"“{said[-1]}”" if said else "nothing was said after the result"


def _without_end(line: str) -> str:
    """A line without its numbers, its lists and the names of the ends that an accepted goal may have."""
    return shape(_ENDS.sub("#", words.without_lists(line)))


def _names_unknown(line: str) -> bool:
    return "unknown" in line.lower()


def _names_aborted(line: str) -> bool:
    plain = words.without_lists(line)
    return re2.search(r"(?i)abort|(?:^|[^\d.])6(?:[^\d.]|\.\D|\.?$)", plain) is not None


_ANOTHER = re2.compile(r"(?i)cancel|\brejected\b|\bsucce|\berfolg(?:reich)?\b")
_NO_OTHER = re2.compile(
    r"(?i)(?:\b(?:not?|n?or|neither|never|without|nicht|kein\w*|expect\w*|instead of|(?:rather|other) than)\b|n't)"
    r"[^.;!?]*"
)
"""Another end than the goal's, and a clause that denies one: "did not end with status SUCCEEDED"."""


def _names_another(line: str) -> bool:
    return _ANOTHER.search(_NO_OTHER.sub("", words.without_denied(line))) is not None


def given_up(evidence: Evidence) -> str:
    """The fault in its giving up without a server, in words."""
    part = evidence.part(ABSENT)
    # Who ends at once whether there is a server or not has not given up. But one that looks under another name has.
    # A client that hardly waits may or may not have asked in the other runs: timing decides.
    late = evidence.part(LATE)
    asked = (
        asked_for(late)
        or (late.traceback and not on_purpose(late.traceback) and any(map(asked_for, evidence)))
        or looks_elsewhere(evidence, part, "action_client")
    )
    if part.events and not asked and asks_nowhere(part, late, "action_client"):
        return "does the same, without a goal, where the server is only late"
    return objection(part, [other for other in (evidence.main, evidence.part(REFUSED)) if asked_for(other)])


# --- criteria -----------------------------------------------------------------------------------------------


def sends_the_goal(evidence: Evidence) -> Finding:
    """In each run one goal, of the order that it was given."""
    wrong = goals_as_seen(evidence)
    expected = "one goal of the given order, in each run"
    return Finding(not wrong, expected, wrong or expected)


def shows_feedback(evidence: Evidence) -> Finding:
    """Every feedback message is logged or printed."""
    part = evidence.part(LATE)
    sent, missing = part.of("feedback"), unshown_feedback(part)
    shown = len(sent) - len(missing)
    if sent and left_at_once(part, "result"):
        # How much came before it ended is the machine's doing.
        return Finding(False, f"all {FEEDBACKS} feedback messages", "it ended before its goal did")
    return Finding(
        bool(sent) and not missing,
        f"all {FEEDBACKS} feedback messages",
        f"{shown} of them" if sent else "none was sent",
    )


def reports_the_result(evidence: Evidence) -> Finding:
    """The sequence of the result is said or returned."""
    part = evidence.part(LATE)
    result = part.first("result")
    expected = f"{result.data['fields']['sequence']} said at the end" if result else "the result's sequence"
    if result is None:
        return Finding(False, expected, "no goal to give a result for")
    asked = len(part.of("result_request"))
    if asked == 0:
        return Finding(False, expected, "never asked for the result")
    if asked > MANY_REQUESTS:
        return Finding(False, expected, f"asked for the result {asked} times")
    said = part.said(after=result)
    if returned := returned_instead(part, result.data["fields"]["sequence"]):
        return Finding(False, f"{result.data['fields']['sequence']} returned", f"returned {returned}")
    if wrong := miscalled(part):
        return Finding(False, expected, f"“{wrong}” about a goal that succeeded")
    if not said and part.ending is not None and part.ending.t <= result.t:
        return Finding(False, expected, "it ended before the result came")
    return Finding(
        reports_result(part), expected, f"“{said[-1]}”" if said else "nothing was said after the result"
    )


def tells_of_refusal(evidence: Evidence) -> Finding:
    """A refused goal is told, no result is asked for, and the client ends."""
    wrong = refused_as_seen(evidence)
    return Finding(not wrong, "says that the goal was rejected, and ends", wrong or "it did")


def returns_nothing_of_a_refused_goal(evidence: Evidence) -> Finding:
    """As :func:`tells_of_refusal`; a function that returns has to return an empty list."""
    told = tells_of_refusal(evidence)
    returned = returned_instead(evidence.part(REFUSED), [])
    if not told.passed or not returned:
        return told
    return Finding(False, "an empty list is returned for a goal that was rejected", f"returned {returned}")


def tells_of_abort(evidence: Evidence) -> Finding:
    """An aborted goal is told, by the status or in words."""
    wrong = aborted_as_seen(evidence)
    return Finding(not wrong, "says that the goal was ABORTED (6)", wrong or "it did")


def waits_for_the_server(evidence: Evidence) -> Finding:
    """With a server that comes late it sends its goal all the same."""
    part = evidence.part(LATE)
    wrong = "" if asked_for(part) else "no goal came"
    if not wrong and left_at_once(part):
        wrong = NOT_AWAITED
    return Finding(not wrong, "waits, then sends its goal", wrong or "it did")


def ends_without_a_server(evidence: Evidence) -> Finding:
    """Without a server it ends by itself and says so, or says again and again that it waits."""
    wrong = given_up(evidence)
    return Finding(not wrong, "says so and ends by itself", wrong or "it says so")


may_wait_on = remark(ABSENT)
"""A word on limits for a client that waits on."""
