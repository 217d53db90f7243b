"""A service client as it was seen in its runs, the questions about it, and the common mistakes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import re2

from autograder.kit import giving_up
from autograder.kit.hangs import stacks
from autograder.kit.in_words import counted
from autograder.kit.model import Advice, Finding
from autograder.kit.texts_said import mentions

if TYPE_CHECKING:
    from autograder.kit.evidence import Event, Evidence, Part, Reference

LATE = "the service comes late"
BIASED = "the answers are surprising"
EXTREME = "64-bit numbers"
ABSENT = "there is no service"
CALLED = (LATE, BIASED, EXTREME)
"""The parts in which the service answers."""

_BRACES = re2.compile(r"\{[\pL_][^{}]*\}")
"""The part of a text that an f-string would have filled in."""
HANGS_AFTER = 8.0
"""Seconds without any event after which a client that has its answer is taken to hang."""


@dataclass(frozen=True)
class Client:
    """A service client, as it was seen, or recorded of the reference solution.

    Attributes:
        evidence: All of its runs.
    """

    evidence: Evidence | Reference

    @cached_property
    def served(self) -> list[Part]:
        """The runs in which the service answers."""
        return [self.evidence.part(name) for name in CALLED]

    @property
    def late(self) -> Part:
        """The run in which the service comes late."""
        return self.evidence.part(LATE)

    @property
    def calls(self) -> int:
        """The number of calls where the service comes late."""
        return len(requests(self.late))

    def called_each_time(self) -> bool:
        """True if each run with a service came to a call: time had no part in the number of calls then."""
        return all(map(requests, self.served))

    def ended_each_time(self) -> bool:
        """True if each run came to its own end: time had no part in it then."""
        return all(part.ending for part in self.evidence.parts)

    def called(self, wanted: int) -> bool:
        """True if it called so many times in each run with a service."""
        return all(len(requests(part)) == wanted for part in self.served)


def requests(part: Part) -> list[Event]:
    """The calls, in order."""
    return part.of("request")


def answers(part: Part) -> list[int]:
    """The answers, in order."""
    return [int(event.data["fields"]["sum"]) for event in part.of("response")]


def pair(event: Event) -> list[int]:
    """The two numbers of a call, the smaller first."""
    # The sum does not care which number is a and which is b.
    return sorted((int(event.data["fields"]["a"]), int(event.data["fields"]["b"])))


def reports(part: Part) -> bool:
    """The last answer is said after it was given, and a function that returns something returns that."""
    given = part.of("response")
    said = bool(given) and mentions(part.said(after=given[-1]), answers(part)[-1])
    return said and not says_otherwise(part)


def returns_another(part: Part) -> bool:
    """True if a notebook's function returned anything but the last answer, whatever it logged."""
    given = answers(part)
    return bool(given) and part.returned not in (None, str(given[-1]))


def says_otherwise(part: Part) -> bool:
    """True if one of its reports of the last answer is wrong, whatever another one says.

    A function that raised has returned nothing to whoever called it. A line that has the answer with the other sign
    tells its reader a wrong sum.
    """
    if returns_another(part) or (part.ending is not None and part.ending.name == "raised"):
        return True
    return any(
        mentions([line], -answer) and not mentions([line], answer)
        for answer in answers(part)[-1:]
        if answer
        for line in new_words(part)
    )


def has_reported(part: Part, calls: int) -> bool:
    """An answer is said after it was given, the one to the call of that number (from 1 on) or to a later one.

    Who goes on calling is stopped at some moment, and what was said before must not depend on which.
    """
    return any(
        mentions(part.said(after=given), int(given.data["fields"]["sum"]))
        for given in part.of("response")[calls - 1 :]
    )


def new_words(part: Part, given: Event | None = None) -> list[str]:
    """The words after an answer, the last one if none is named, without late echoes.

    A log line comes twice, as output and on /rosout, and the second of the two may be slow.
    """
    given = given or next(reversed(part.of("response")), None)
    if given is None:
        return []
    later, everything = part.said(after=given), part.said()
    before = everything[: len(everything) - len(later)]
    return [line for line in later if line.strip() and line not in before]


def braces_left(part: Part) -> Advice | None:
    """It said the name of a variable in braces where the sum was to be: Python fills them only in an f-string."""
    line = next((line for line in new_words(part) if _BRACES.search(line)), None)
    if line is None:
        return None
    return Advice(
        f"Your program said “{line}”: Python did not fill in the braces, because there is no f in front of the string.",
        'Write f directly before the quotation mark: f"...". Python then puts the number where the braces are.',
    )


def reports_the_sum(evidence: Evidence) -> Finding:
    """The last answer is logged, printed or returned."""
    calls = max(1, Client(evidence.reference).calls)
    silent = next(
        (
            p
            for p in Client(evidence).served
            if says_otherwise(p) or not (reports(p) or has_reported(p, calls))
        ),
        None,
    )
    if silent is None:
        return Finding(True, "the final sum, in each run", "the final sum, in each run")
    given = answers(silent)
    if returns_another(silent):
        return Finding(False, f"{given[-1]} said and returned", f"it returned {silent.returned}")
    wanted = f"{given[-1]} said at the end" if given else "the final sum, in each run"
    lines = silent.said(after=silent.of("response")[-1]) if given else silent.said()
    wrong = [line for line in lines if given and not mentions([line], given[-1])] or lines
    return Finding(False, wanted, f"“{wrong[-1]}”" if wrong else "nothing was said")


def gives_up_in_time(evidence: Evidence) -> Finding:
    """Without a service it gives up, or goes on, as the one rule for all clients says."""
    part = evidence.part(ABSENT)
    # Who ends at once whether there is a service or not has not given up. But one that looks under another name has.
    # A client that gives up at once may or may not have called in the other runs: timing decides.
    asked = bool(requests(evidence.part(LATE)) or giving_up.looks_elsewhere(evidence, part, "client"))
    numbers = part.inputs.get("numbers", ())
    # Who names the sum has not given up, but added up by itself; a sum that is one of the numbers shows nothing.
    if numbers and sum(numbers) not in numbers and mentions(part.said(), sum(numbers)):
        wrong = "named a sum that no service gave"
    elif part.events and not asked:
        wrong = "does the same, without a call, where the service is only late"
    else:
        usual = [other for other in Client(evidence).served if other.name != LATE and reports(other)]
        reported = {giving_up.shape(line) for other in usual for line in _reporting(other)}
        wrong = giving_up.objection(part, usual, is_report=lambda line: giving_up.shape(line) in reported)
    seen = "says again and again that it waits" if giving_up.goes_on_waiting(part) else "it did"
    return Finding(not wrong, "says so and ends by itself", wrong or seen)


def _reporting(part: Part) -> list[str]:
    return [line for line in new_words(part) if mentions([line], answers(part)[-1])]


def no_limit(evidence: Evidence) -> str:
    """A remark for a client that waits without end, and says so."""
    return giving_up.remark(evidence.part(ABSENT))


def how_it_went(part: Part) -> str:
    """The end of a part, in words."""
    if not part.events:
        return "not reached"
    ending = part.ending
    if ending is None:
        return f"neither done nor ended, and silent for {HANGS_AFTER:g} s"
    return f"it {ending.name} after {counted(len(requests(part)), 'call')}"


def call_never_spun(evidence: Evidence) -> Advice | None:
    """It called, was answered and hangs."""
    for part in Client(evidence).served:
        if (
            part.ending is None
            and part.of("response")
            and not new_words(part)
            and len(requests(part)) <= Client(evidence.reference).calls
        ):
            return Advice(
                "The service answered, but your client never took the answer: nothing spins it while it "
                "waits. "
                "call() blocks for ever then, and so does any wait inside a callback of the same callback "
                "group.",
                "Outside of callbacks, use call_async and "
                "rclpy.spin_until_future_complete(node, future, timeout_sec=5.0), or spin the node in a "
                "background executor while you use call().",
            )
    return None


def awaits_in_vain(evidence: Evidence) -> Advice | None:
    """It was answered, its threads only spin, and nothing goes on."""
    stuck = [p for p in Client(evidence).served if p.ending is None and p.of("response") and stacks(p)]
    if not stuck or new_words(stuck[0]):
        return None
    return Advice(
        "The service answered, and your node spins, but the code that awaits the answer is never resumed: "
        "it awaits "
        "inside a callback of the same callback group that the answer needs.",
        "Give the client a callback group of its own (ReentrantCallbackGroup or another MutuallyExclusive "
        "one), or go "
        "on in future.add_done_callback(...).",
    )


def answer_not_awaited(evidence: Evidence) -> Advice | None:
    """It ended while the answer to a call of its own was still to come."""
    served, calls = Client(evidence).served, Client(evidence.reference).calls
    # Who has made all its calls where an answer came just as late waits for answers, and has not liked this one.
    waits = any(len(requests(part)) >= calls for part in served if part.of("response"))
    if not any(
        ended_before_its_answer(part) or (calls > 1 and not waits and _made_nothing_of_its_answer(part))
        for part in served
    ):
        return None
    return Advice(
        "Your client called the service and did not wait for the answer, which may take a second.",
        "Wait for it: rclpy.spin_until_future_complete(node, future, timeout_sec=5.0), and look at "
        "future.done() before you read the result.",
    )


def ended_before_its_answer(part: Part) -> bool:
    """True if the subject had ended when an answer was given, or a call had not even left it."""
    if part.ending is None:
        return False
    asked = max(len(requests(part)), len(part.of("called")))
    given = sum(event.t <= part.ending.t for event in part.of("response"))
    return asked > given


def _made_nothing_of_its_answer(part: Part) -> bool:
    """True if the subject ended with its first answer, and neither called again nor said a number that came of it.

    A process takes its time to end, so the answer may be given while one that has not waited for it is on its way out.
    """
    if part.ending is None or len(requests(part)) != 1 or len(part.of("response")) != 1:
        return False
    own = {str(abs(number)) for number in part.inputs.get("numbers", ())}
    told = (number for line in new_words(part) for number in re2.findall(r"\d{3,}", line))
    return answers(part)[0] != 0 and all(number in own for number in told)


def zero_taken_for_failure(evidence: Evidence) -> Advice | None:
    """All is well but where the service answered 0."""
    wrong = [part for part in Client(evidence).served if part.ending and not reports(part)]
    right = [part for part in Client(evidence).served if reports(part)]
    if not right or not wrong or any(answers(part)[-1:] != [0] for part in wrong):
        return None
    if any(ended_before_its_answer(part) for part in wrong):
        return None
    return Advice(
        "The service answered 0, and your client took that for no answer. 0 is a sum like any other.",
        "`if result:` is False for 0, too. Ask `if future.done():` or `if future.result() is not None:`, which says "
        "whether there is an answer, whatever it is.",
    )


def not_returned(evidence: Evidence) -> Advice | None:
    """It says the answer, and returns something else each time."""
    served = [part for part in Client(evidence).served if part.of("response")]
    if not served or not all(returns_another(part) and _says_the_answer(part) for part in served):
        return None
    return Advice(
        f"Your function says the sum, but what it returns is {served[0].returned}: code that calls it cannot go on "
        "with the sum.",
        "End your function with `return` and the sum itself, a number: what is in the field sum of the answer.",
    )


def _says_the_answer(part: Part) -> bool:
    said = replace(part, events=[event for event in part.events if event is not part.ending])
    return mentions(said.said(after=part.of("response")[-1]), answers(part)[-1])


def cut_short(client: Client) -> str:
    """The event that ended the judge's runs early, because the client hung; empty where it made all."""
    hung = next((part for part in client.served if part.events and part.ending is None), None)
    if hung is None or all(part.events for part in client.served):
        return ""
    count = len(requests(hung))
    made = "no call" if not count else "one call" if count == 1 else f"{count} calls"
    return f"{made} ({hung.name}), then it hung; the other runs were left out"


def fields_never_filled(evidence: Evidence) -> Advice | None:
    """Every request asks for 0 + 0."""
    made = [pair(event) for part in Client(evidence).served for event in requests(part)]
    if not made or any(pair != [0, 0] for pair in made):
        return None
    return Advice(
        "Every call asks for 0 + 0: the fields of the request were never filled.",
        "A request has the fields a and b. A misspelt keyword in AddTwoInts.Request(...) is ignored "
        "silently.",
    )


def waits_for_nobody(evidence: Evidence) -> Advice | None:
    """Without a service it neither stops in time nor says that it waits."""
    part = evidence.part(ABSENT)
    if not part.events or part.ending is not None or giving_up.goes_on_waiting(part):
        return None
    return Advice(
        f"When the service is not there, your client is still waiting after {giving_up.GIVE_UP_LIMIT:g} s.",
        "Give the wait a limit of a few seconds: `if not client.wait_for_service(timeout_sec=5.0):` say so and stop. A "
        "while loop needs a count.",
    )


def patience_not_kept(evidence: Evidence) -> Advice | None:
    """Without a service it waits by a limit of its own."""
    return giving_up.patience_not_kept(evidence.part(ABSENT))


def waits_forever(evidence: Evidence) -> Advice | None:
    """With a service that is there, it neither calls nor ends."""
    stuck = [
        p for p in Client(evidence).served if p.endpoints("client") and p.ending is None and not requests(p)
    ]
    if not stuck:
        return None
    return Advice(
        "The service was there, but your client never called it and never ended: it goes on waiting.",
        "Wait with a limit, and call as soon as the service is there: "
        "`if not client.wait_for_service(timeout_sec=5.0):` say so and stop.",
    )


def gave_up_too_early(evidence: Evidence) -> Advice | None:
    """It ended before it had met the service."""
    if not giving_up.gave_up(
        Client(evidence).served, evidence.part(ABSENT), lambda part: bool(requests(part))
    ):
        return None
    return Advice(
        "The service was there, or came a moment late, and your client had already given up (or called before it "
        "had met the service).",
        "Wait for the service with wait_for_service and a few seconds of patience before the first call.",
    )


def silent_end(evidence: Evidence) -> Advice | None:
    """Without a service it ends, and says nothing of that."""
    finding = gives_up_in_time(evidence)
    value = giving_up.returned_answer(evidence.part(ABSENT))
    if finding.passed or not (value or finding.seen == giving_up.SILENT):
        return None
    if value:
        return Advice(
            f"When the service is not there, your function returns {value}: who calls it takes that for the sum.",
            "Raise TimeoutError instead, with a few words on what was missing.",
        )
    return Advice(
        "When the service is not there, your client ends and does not say so.",
        "Log an error (or raise TimeoutError) before you return, so that its user knows why there is no sum.",
    )
