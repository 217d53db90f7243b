"""Lab 1.3: a server that adds two integers.

The judge is the client: calls one by one, with everyday, negative, zero and 64-bit numbers, then several at once,
then one more to see that the node is still alive.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from autograder.exercises import common_mistakes as common
from autograder.exercises.crashes import traceback_of
from autograder.exercises.hangs import HANGS, stacks
from autograder.exercises.model import Advice, Bench, Criterion, Exercise, Finding, Look, Mistake

if TYPE_CHECKING:
    from random import Random

    from autograder.exercises.callers import Caller
    from autograder.exercises.evidence import Event, Evidence, Part

CALLS = "calls"
ORDINARY = 6
"""Calls with numbers of everyday size."""
AT_ONCE = 6
"""Calls that are in flight together. A service's queue keeps 10, and 12 lose some even at a right server (measured)."""
SERVER_LIMIT = {Look.FAST: 3.0, Look.REAL_TIME: 6.0}
"""Seconds in which a server that is on the graph must be matched with the judge's client."""
QUIET = {Look.FAST: 2.0, Look.REAL_TIME: 6.0}
"""Seconds without any event after which an answer is taken not to come."""

Numbers = Mapping[str, int]


def scenario(bench: Bench) -> None:
    """One run: calls one by one, calls at once, one more."""
    service, type_name = bench.reference.only("service")
    bench.part(CALLS)
    caller = bench.call(service, type_name)
    bench.start()
    there = bench.await_endpoint("service", service)
    bench.release()
    if there and caller.await_server(SERVER_LIMIT[bench.look]) and not all_answered(bench, caller):
        bench.note_whether_it_spins()
        bench.note_where_it_hangs()
    bench.stop()


def all_answered(bench: Bench, caller: Caller) -> bool:
    """Make all calls; False at the first that is not answered."""
    quiet = QUIET[bench.look]
    for numbers in single_calls(bench.random):
        caller.ask(numbers)
        if not caller.await_answers(quiet):
            return False
    caller.ask(*(ordinary(bench.random) for _ in range(AT_ONCE)))
    if not caller.await_answers(quiet):
        return False
    caller.ask(ordinary(bench.random))
    return caller.await_answers(quiet)


def single_calls(random: Random) -> list[Numbers]:
    """What is asked one by one: everyday numbers, negative ones, zeros, and sums just inside an int64."""
    wide, low = 2**63 - 1, -(2**63)
    some = random.randint(1001, 99_999)
    return [
        *(ordinary(random) for _ in range(ORDINARY)),
        {"a": -some, "b": random.randint(1001, 99_999)},
        {"a": -random.randint(1001, 99_999), "b": -random.randint(1001, 99_999)},
        {"a": 0, "b": some},
        {"a": some, "b": -some},
        {"a": wide - some, "b": some},
        {"a": low + some, "b": -some + random.randint(0, 9)},
        {"a": wide, "b": low + random.randint(1, 999)},
    ]


def ordinary(random: Random) -> Numbers:
    """Two numbers of everyday size."""
    a, b = random.sample(range(1001, 99_999), 2)
    return {"a": a, "b": b}


# --- questions to the evidence -----------------------------------------------------------------------------


def answers(part: Part) -> dict[int, int]:
    """The answer to each call that was answered."""
    return {int(e.data["call"]): int(e.data["fields"]["sum"]) for e in part.of("answered")}


def wrong_answers(part: Part, calls: list[Event]) -> list[str]:
    """What is wrong about the answers to these calls, in words."""
    given = answers(part)
    return [objection for call in calls if (objection := _objection(call, given))]


def _objection(call: Event, given: Mapping[int, int]) -> str:
    a, b = call.data["fields"]["a"], call.data["fields"]["b"]
    answer = given.get(int(call.data["call"]))
    if answer is None:
        return f"no answer to {a} + {b}"
    return "" if answer == a + b else f"{a} + {b} was answered with {answer}"


def _phases(evidence: Evidence) -> tuple[list[Event], list[Event], list[Event]]:
    """The calls one by one, the calls at once, the last one."""
    asked = evidence.main.of("asked")
    total = len(evidence.reference.part(CALLS).of("asked"))
    single = total - AT_ONCE - 1
    return asked[:single], asked[single : total - 1], asked[total - 1 :]


def servers(part: Part) -> int:
    """The largest number of servers that were there at once."""
    return max((int(event.data["count"]) for event in part.of("servers")), default=0)


def serves(evidence: Evidence) -> Finding:
    """One server of the right name and type, and it answers."""
    name, type_name = evidence.reference.only("service")
    part, expected = evidence.main, f"one server of {name} ({type_name}) that answers"
    made = part.endpoints("service")
    if name not in made:
        seen = f"a service {', '.join(sorted(made))}" if made else "no service"
        return Finding(False, expected, seen)
    if made[name] != type_name:
        return Finding(False, expected, f"{name} is a {made[name]}")
    if servers(part) > 1:
        return Finding(False, expected, f"{servers(part)} servers of {name}")
    return Finding(bool(answers(part)), expected, "it answers" if answers(part) else "no call was answered")


def answers_with_sums(evidence: Evidence) -> Finding:
    """Each call of the first phase is answered with the sum."""
    single, _, _ = _phases(evidence)
    return _all_right(evidence.main, single, "the sum, for every pair of numbers")


def answers_at_once(evidence: Evidence) -> Finding:
    """Each of the calls at once is answered with its own sum."""
    _, together, _ = _phases(evidence)
    return _all_right(evidence.main, together, f"the right sum for each of {AT_ONCE} calls at once")


def stays_alive(evidence: Evidence) -> Finding:
    """The call after all others is answered."""
    _, _, last = _phases(evidence)
    return _all_right(evidence.main, last, "answers once more after all that")


def _all_right(part: Part, calls: list[Event], expected: str) -> Finding:
    wrong = wrong_answers(part, calls)
    seen = (
        wrong[0]
        if wrong
        else f"{len(calls)} right"
        if calls
        else "not asked any more"
        if part.of("asked")
        else "not asked"
    )
    return Finding(bool(calls) and not wrong, expected, seen)


# --- known mistakes ----------------------------------------------------------------------------------------


def two_servers(evidence: Evidence) -> Advice | None:
    """Two servers share the name."""
    name, _ = evidence.reference.only("service")
    count = servers(evidence.main)
    if count < 2:
        return None
    return Advice(
        f"{count} servers of {name} are on the graph. Each call reaches both, and whichever is quicker "
        f"answers.",
        "Call create_service once, and make one node only.",
    )


def fields_never_filled(evidence: Evidence) -> Advice | None:
    """Every answer is 0."""
    given = answers(evidence.main)
    if not given or any(given.values()):
        return None
    return Advice(
        "Every answer is 0: the field sum of the response was never filled.",
        "Set response.sum = request.a + request.b. A misspelt keyword in AddTwoInts.Response(...) is "
        "ignored silently.",
    )


def returned_none(evidence: Evidence) -> Advice | None:
    """A bare TypeError out of nowhere: all that a notebook shows of it, where rclpy's own lines are left out."""
    if traceback_of(evidence).strip() != "TypeError":
        return None
    return Advice(
        "The service callback did not return the response: rclpy could not send what came back, and the server died of "
        "it.",
        "End the callback with `return response`, on every way out.",
    )


def wrong_sum(evidence: Evidence) -> Advice | None:
    """An answer is not the sum."""
    part = evidence.main
    # rclpy answers with -1 what it cannot put into the message, and dies of it: that is no sum of the subject's.
    garbage = " was answered with -1" if part.traceback else None
    wrong = [text for text in wrong_answers(part, part.of("asked")) if " was answered" in text]
    wrong = [text for text in wrong if garbage is None or not text.endswith(garbage)]
    if not wrong:
        return None
    return Advice(
        f"The answer is not the sum: {wrong[0]}.",
        "Compute it from this very request: response.sum = request.a + request.b. Python's whole numbers "
        "have no "
        "limit, so nothing needs to be converted.",
    )


def stopped_answering(evidence: Evidence) -> Advice | None:
    """A callback of the student's was called and never comes back."""
    part = evidence.main
    given, asked = answers(part), part.of("asked")
    if len(given) == len(asked) or part.ending is not None:
        return None
    stuck = [s for s in stacks(part) if not s[0].rclpy and any(f.rclpy == "executors.py" for f in s)]
    if not stuck:
        return None
    return Advice(
        f"Your server answered {len(given)} calls and then no more: its callback {stuck[0][0].function} was called and "
        "never came back.",
        "A callback has to come to its end at each call. Look for a wait, a loop or a lock in it.",
    )


EXERCISE = Exercise(
    id="lab_1_3.server",
    title="Lab 1.3 · A server that adds",
    task="Serve add_two_ints: answer each request with the sum of its two numbers.",
    scenario=scenario,
    criteria=(
        Criterion("service", "Serves add_two_ints, with the right type", 2, serves),
        Criterion("sums", "Answers with the sum", 4, answers_with_sums),
        Criterion("together", "Answers several calls at once", 2, answers_at_once),
        Criterion("alive", "Stays alive", 2, stays_alive),
    ),
    mistakes=(
        # Before any crash: a wrong sum may leave the range of an int64, and rclpy's server dies of that.
        Mistake("two_servers", two_servers, certain=True),
        Mistake("field_typo", fields_never_filled, certain=True),
        Mistake("wrong_sum", wrong_sum, certain=True),
        *common.CRASHES,
        Mistake("callback_returned_none", returned_none, certain=True),
        common.endpoint_name("service"),
        common.message_type("service"),
        *common.OTHER_CRASHES,
        *HANGS,
        Mistake("stopped_answering", stopped_answering),
        common.never_spun("service"),
        common.went_deaf("service"),
        *common.NOTHING_THERE,
    ),
    roles=("service",),
    limit=90.0,
)
