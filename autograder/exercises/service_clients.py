"""What the exercises with a service client share: the judge serves, in each run in another way.

In one part the service comes late, in one it answers with a hidden bias, so that what the client reports shows whether
it used the answer, in one the numbers fill 64 bits, and in the last there is no service.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from autograder.exercises.giving_up import gave_up
from autograder.exercises.hangs import stacks
from autograder.exercises.model import Advice, Bench, Finding

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from random import Random

    from autograder.exercises.evidence import Event, Evidence, Part

LATE = "the service comes late"
BIASED = "the answers are surprising"
EXTREME = "64-bit numbers"
ABSENT = "there is no service"
CALLED = (LATE, BIASED, EXTREME)
"""The parts in which the service answers."""

CALL_LIMIT = 15.0
"""Seconds of wall time in which a client that has its service must be done."""
HANGS_AFTER = 8.0
"""Seconds without any event after which a client that has its answer is taken to hang."""
AFTERMATH = 1.0
"""Seconds in which a client that has reported its sum may end, or go on and show what else it does."""
GIVE_UP_LIMIT = 12.0
"""Seconds in which a client must have ended when there is no service; the task says 10."""
SHORT_PATIENCE = 0.15
"""Seconds that a notebook's function is told to wait for the service where there is none."""


def called(bench: Bench, name: str, numbers: Sequence[int], bias: int, *, calls: int) -> bool:
    """One run with a service.

    Args:
        bench: Where it happens.
        name: The part's name.
        numbers: What the subject is to add.
        bias: What the service adds to each sum.
        calls: How many calls a subject that has done its work has made.

    Returns:
        Whether the subject came to an end of its work.
    """
    service, type_name = bench.reference.only("client")
    bench.part(name, numbers=list(numbers))
    if name != LATE:
        bench.serve(service, type_name, adder(bias))
    bench.start(*numbers)
    if name == LATE:
        if not bench.await_endpoint("client", service):
            # Without the client it waits for something else; a program that has ended may show more in
            # another part.
            ended = bench.await_end(0.0)
            bench.stop()
            return ended
        bench.serve(service, type_name, adder(bias))
    done = bench.wait_until(lambda seen: is_done(seen, calls), CALL_LIMIT, quiet=HANGS_AFTER)
    if done:
        bench.await_end(AFTERMATH)
    else:
        bench.note_where_it_hangs()
    bench.stop()
    return done


def is_done(evidence: Evidence, calls: int) -> bool:
    """Whether the subject has ended or, as a program may, has reported the sum and goes on spinning."""
    part = evidence.main
    return part.ending is not None or (len(answers(part)) >= calls and reports(part))


def unserved(bench: Bench, numbers: Sequence[int]) -> None:
    """One run without the service."""
    if bench.keep(ABSENT):
        return
    bench.part(ABSENT, numbers=list(numbers))
    bench.start(*numbers, patience_sec=SHORT_PATIENCE)
    service, _ = bench.reference.only("client")
    bench.await_endpoint("client", service)
    bench.await_end(GIVE_UP_LIMIT)
    bench.stop()


def hidden_bias(random: Random) -> int:
    """What a surprising service adds: one of so many that nobody can say them all."""
    return random.randint(10**9, 10**12)


def adder(bias: int) -> Callable[[Mapping[str, Any]], Mapping[str, Any]]:
    """A service that adds two numbers, and a bias."""
    return lambda request: {"sum": _as_int64(request["a"] + request["b"] + bias)}


def _as_int64(number: int) -> int:
    # A client that adds in another order may leave the range; C++ servers wrap around, rclpy's would die of
    # it.
    return (number + 2**63) % 2**64 - 2**63


# --- questions to the evidence -----------------------------------------------------------------------------


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


def expected_calls(evidence: Evidence) -> int:
    """How often the reference solution calls."""
    return len(requests(evidence.reference.part(LATE)))


def mentions(lines: Sequence[str], number: int) -> bool:
    """Whether the number stands in one of the lines, with or without separators between its digits."""
    digits = str(abs(number))
    pattern = r"[,_' .]?".join(digits)
    sign = r"[-−]\s?" if number < 0 else r"(?<![-−])"
    return any(re.search(rf"(?<![\d]){sign}{pattern}(?!\d)", line) for line in lines)


def reports(part: Part) -> bool:
    """The last answer is said after it was given."""
    given = part.of("response")
    return bool(given) and mentions(part.said(after=given[-1]), answers(part)[-1])


def served_parts(evidence: Evidence) -> list[Part]:
    """The parts in which the service answers."""
    return [evidence.part(name) for name in CALLED]


def reports_the_sum(evidence: Evidence) -> Finding:
    """The last answer is logged, printed or returned."""
    silent = next((part for part in served_parts(evidence) if not reports(part)), None)
    if silent is None:
        return Finding(True, "the final sum, in each run", "the final sum, in each run")
    given = answers(silent)
    wanted = f"{given[-1]} said at the end" if given else "the final sum, in each run"
    lines = silent.said(after=silent.of("response")[-1]) if given else silent.said()
    return Finding(False, wanted, f"“{lines[-1]}”" if lines else "nothing was said")


def gives_up_in_time(evidence: Evidence) -> Finding:
    """Without a service it ends by itself and says so."""
    part = evidence.part(ABSENT)
    # Who ends at once whether there is a service or not has not given up. But one that looks under another name has.
    named = {name for p in evidence for name in p.endpoints("client")}
    asked = any(map(requests, evidence)) or bool(named - {evidence.reference.only("client")[0]})
    told = bool(part.said()) or bool(part.traceback) or bool(part.ending and part.ending.name == "raised")
    # Who names the sum has not given up, but added up by itself.
    claimed = bool(part.inputs) and mentions(part.said(), sum(part.inputs["numbers"]))
    passed = asked and part.ending is not None and told and not claimed
    if passed:
        seen = "it did"
    elif claimed:
        seen = "named a sum that no service gave"
    elif part.ending is not None:
        seen = "ended without a word" if asked else "never called a service"
    else:
        seen = f"still waiting after {GIVE_UP_LIMIT:g} s" if part.events else how_it_went(part)
    return Finding(passed, "says so and ends by itself", seen)


def how_it_went(part: Part) -> str:
    """How a part ended, in words."""
    if not part.events:
        return "not reached"
    ending = part.ending
    if ending is None:
        return f"neither done nor ended, and silent for {HANGS_AFTER:g} s"
    return f"it {ending.name} after {len(requests(part))} calls"


# --- known mistakes ----------------------------------------------------------------------------------------


def call_never_spun(evidence: Evidence) -> Advice | None:
    """It called, was answered and hangs."""
    for part in served_parts(evidence):
        if (
            part.ending is None
            and part.of("response")
            and not reports(part)
            and len(requests(part)) <= expected_calls(evidence)
        ):
            return Advice(
                "The service answered, but your client never took the answer: nothing spins it while it "
                "waits. "
                "call() blocks for ever then, and so does any wait inside a callback of the same callback "
                "group.",
                "Outside of callbacks, use call_async and rclpy.spin_until_future_complete(node, future), "
                "or spin the "
                "node in a background executor while you use call().",
            )
    return None


def awaits_in_vain(evidence: Evidence) -> Advice | None:
    """It was answered, its threads only spin, and nothing goes on."""
    stuck = [p for p in served_parts(evidence) if p.ending is None and p.of("response") and stacks(p)]
    if not stuck or reports(stuck[0]):
        return None
    return Advice(
        "The service answered, and your node spins, but the code that awaits the answer is never resumed: "
        "it awaits "
        "inside a callback of the same callback group that the answer needs.",
        "Give the client a callback group of its own (ReentrantCallbackGroup or another MutuallyExclusive "
        "one), or go "
        "on in future.add_done_callback(...).",
    )


def fields_never_filled(evidence: Evidence) -> Advice | None:
    """Every request asks for 0 + 0."""
    made = [pair(event) for part in served_parts(evidence) for event in requests(part)]
    if not made or any(pair != [0, 0] for pair in made):
        return None
    return Advice(
        "Every call asks for 0 + 0: the fields of the request were never filled.",
        "A request has the fields a and b. A misspelt keyword in AddTwoInts.Request(...) is ignored "
        "silently.",
    )


def waits_for_nobody(evidence: Evidence) -> Advice | None:
    """Without a service it never ends."""
    part = evidence.part(ABSENT)
    if not part.events or part.ending is not None:
        return None
    return Advice(
        "When the service is not there, your client waits without end.",
        "Give the wait a limit: `if not client.wait_for_service(timeout_sec=5.0):` say so and stop. A while "
        "loop needs "
        "a count.",
    )


def waits_forever(evidence: Evidence) -> Advice | None:
    """With a service that is there, it neither calls nor ends."""
    stuck = [
        p for p in served_parts(evidence) if p.endpoints("client") and p.ending is None and not requests(p)
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
    if not gave_up(served_parts(evidence), evidence.part(ABSENT), lambda part: bool(requests(part))):
        return None
    return Advice(
        "The service was there, or came a moment late, and your client had already given up (or called before it "
        "had met the service).",
        "Wait for the service with wait_for_service and a few seconds of patience before the first call.",
    )


def only_if_called(recognise: Callable[[Evidence], Advice | None]) -> Callable[[Evidence], Advice | None]:
    """The same, but only where each run with a service came to a call: time had no part in the number of calls then."""

    def called_each_time(evidence: Evidence) -> Advice | None:
        return recognise(evidence) if all(map(requests, served_parts(evidence))) else None

    return called_each_time


def silent_end(evidence: Evidence) -> Advice | None:
    """Without a service it ends, and says nothing."""
    finding = gives_up_in_time(evidence)
    if finding.passed or finding.seen != "ended without a word":
        return None
    return Advice(
        "When the service is not there, your client ends without a word.",
        "Log an error (or raise TimeoutError) before you return, so that its user knows why there is no sum.",
    )
