"""Exercise 1.2: a client that adds three numbers with two calls of a service that adds two.

The judge serves. In one part it answers with a hidden bias, so that the second call and the reported sum show
whether the first answer was really used.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from autograder.exercises import common_mistakes as common
from autograder.exercises.hangs import HANGS, stacks
from autograder.exercises.model import Advice, Bench, Criterion, Exercise, Finding, Mistake

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
SHORT_PATIENCE = 0.4
"""Seconds that a notebook's function is told to wait for the service where there is none."""


def scenario(bench: Bench) -> None:
    """Four runs: a late service, a surprising one, large numbers, and none at all."""
    random = bench.random
    for name, numbers, bias in (
        (LATE, ordinary(random), 0),
        (BIASED, negative(random), random.randint(10**5, 10**6)),
        (EXTREME, extreme(random), 0),
    ):
        if not called(bench, name, numbers, bias):
            return
    unserved(bench, ordinary(random))


def called(bench: Bench, name: str, numbers: tuple[int, int, int], bias: int) -> bool:
    """One run with a service; whether the subject came to an end of its work."""
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
    done = bench.wait_until(is_done, CALL_LIMIT, quiet=HANGS_AFTER)
    if done:
        bench.await_end(AFTERMATH)
    else:
        bench.note_where_it_hangs()
    bench.stop()
    return done


def is_done(evidence: Evidence) -> bool:
    """Whether the subject has ended or, as a program may, has reported the sum and goes on spinning."""
    part = evidence.main
    return part.ending is not None or (len(answers(part)) > 1 and reports(part))


def unserved(bench: Bench, numbers: tuple[int, int, int]) -> None:
    """One run without the service."""
    bench.part(ABSENT, numbers=list(numbers))
    bench.start(*numbers, patience_sec=SHORT_PATIENCE)
    service, _ = bench.reference.only("client")
    bench.await_endpoint("client", service)
    bench.await_end(GIVE_UP_LIMIT)
    bench.stop()


def adder(bias: int) -> Callable[[Mapping[str, Any]], Mapping[str, Any]]:
    """A service that adds two numbers, and a bias."""
    return lambda request: {"sum": _as_int64(request["a"] + request["b"] + bias)}


def _as_int64(number: int) -> int:
    # A client that adds in another order may leave the range; C++ servers wrap around, rclpy's would die of
    # it.
    return (number + 2**63) % 2**64 - 2**63


def ordinary(random: Random) -> tuple[int, int, int]:
    """Three numbers of everyday size."""
    a, b, c = random.sample(range(1001, 99_999), 3)
    return a, b, c


def negative(random: Random) -> tuple[int, int, int]:
    """A negative number, a positive one and a zero."""
    return -random.randint(1001, 99_999), random.randint(1001, 99_999), 0


def extreme(random: Random) -> tuple[int, int, int]:
    """Numbers near both ends of an int64, whose sums stay inside it."""
    return (
        2**63 - 1 - random.randint(0, 999),
        -(2**62) - random.randint(1, 999),
        -(2**62) + random.randint(1, 999),
    )


# --- questions to the evidence -----------------------------------------------------------------------------


def requests(part: Part) -> list[Event]:
    """The calls, in order."""
    return part.of("request")


def answers(part: Part) -> list[int]:
    """The answers, in order."""
    return [int(event.data["fields"]["sum"]) for event in part.of("response")]


def _pair(event: Event) -> list[int]:
    # The sum does not care which number is a and which is b.
    return sorted((int(event.data["fields"]["a"]), int(event.data["fields"]["b"])))


def expected_calls(evidence: Evidence) -> int:
    """How often the reference solution calls."""
    return len(requests(evidence.reference.part(LATE)))


def calls_as_the_reference(evidence: Evidence, part: Part) -> bool:
    """The first call adds the first two numbers, the second its answer and the third number."""
    made = requests(part)
    if len(made) != expected_calls(evidence):
        return False
    a, b, c = part.inputs["numbers"]
    return _pair(made[0]) == sorted((a, b)) and _pair(made[1]) == sorted((answers(part)[0], c))


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


def _seen_parts(evidence: Evidence) -> list[Part]:
    return [evidence.part(name) for name in CALLED]


def makes_two_calls(evidence: Evidence) -> Finding:
    """In each run it calls as often as the reference solution."""
    wanted = expected_calls(evidence)
    counts = [len(requests(part)) for part in _seen_parts(evidence)]
    return Finding(
        all(count == wanted for count in counts),
        f"{wanted} calls in each run",
        ", ".join(f"{count} ({name})" for count, name in zip(counts, CALLED, strict=True)),
    )


def chains_the_calls(evidence: Evidence) -> Finding:
    """The second call is built on the first one's answer."""
    wrong = next((p for p in _seen_parts(evidence) if not calls_as_the_reference(evidence, p)), None)
    expected = "first a + b, then that answer + c"
    if wrong is None:
        return Finding(True, expected, expected)
    made = [f"{e.data['fields']['a']} + {e.data['fields']['b']}" for e in requests(wrong)[:3]]
    numbers = wrong.inputs.get("numbers")
    seen = (f"for {', '.join(map(str, numbers))}: " if numbers else "") + (", then ".join(made) or "no call")
    return Finding(False, expected, seen)


def reports_the_sum(evidence: Evidence) -> Finding:
    """The last answer is logged, printed or returned."""
    silent = next((part for part in _seen_parts(evidence) if not reports(part)), None)
    if silent is None:
        return Finding(True, "the final sum, in each run", "the final sum, in each run")
    given = answers(silent)
    wanted = f"{given[-1]} said at the end" if given else "the final sum, in each run"
    lines = silent.said(after=silent.of("response")[-1]) if given else silent.said()
    return Finding(False, wanted, f"“{lines[-1]}”" if lines else "nothing was said")


def waits_for_the_service(evidence: Evidence) -> Finding:
    """With a service that comes late it does its work all the same."""
    part = evidence.part(LATE)
    done = calls_as_the_reference(evidence, part) and (part.ending is not None or reports(part))
    return Finding(done, "waits, then calls", "it did" if done else _how_it_went(part))


def gives_up_in_time(evidence: Evidence) -> Finding:
    """Without a service it ends by itself and says so."""
    part = evidence.part(ABSENT)
    # A client that gives up quickly may be gone before the graph has shown it; the other parts have seen it
    # then.
    asked = any(p.endpoints("client") or requests(p) for p in evidence)
    told = bool(part.said()) or bool(part.traceback) or bool(part.ending and part.ending.name == "raised")
    passed = asked and part.ending is not None and told
    if passed:
        seen = "it did"
    elif part.ending is not None:
        seen = "ended without a word" if asked else "never made a client"
    else:
        seen = f"still waiting after {GIVE_UP_LIMIT:g} s" if part.events else _how_it_went(part)
    return Finding(passed, "says so and ends by itself", seen)


def _how_it_went(part: Part) -> str:
    if not part.events:
        return "not reached"
    ending = part.ending
    if ending is None:
        return f"neither done nor ended, and silent for {HANGS_AFTER:g} s"
    return f"it {ending.name} after {len(requests(part))} calls"


# --- known mistakes ----------------------------------------------------------------------------------------


def call_never_spun(evidence: Evidence) -> Advice | None:
    """It called, was answered and hangs."""
    for part in _seen_parts(evidence):
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
    stuck = [p for p in _seen_parts(evidence) if p.ending is None and p.of("response") and stacks(p)]
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


def first_answer_ignored(evidence: Evidence) -> Advice | None:
    """The second call carries a + b as computed by the client."""
    part = evidence.part(BIASED)
    made = requests(part)
    if len(made) < 2:
        return None
    a, b, c = part.inputs["numbers"]
    if _pair(made[1]) != sorted((a + b, c)) or _pair(made[1]) == sorted((answers(part)[0], c)):
        return None
    return Advice(
        f"The service answered {answers(part)[0]} to the first call, but your second call does not use that "
        f"answer: "
        "it adds up on its own.",
        "Take first.sum from the first answer and put it into the second request.",
    )


def fields_never_filled(evidence: Evidence) -> Advice | None:
    """Every request asks for 0 + 0."""
    made = [_pair(event) for part in _seen_parts(evidence) for event in requests(part)]
    if not made or any(pair != [0, 0] for pair in made):
        return None
    return Advice(
        "Every call asks for 0 + 0: the fields of the request were never filled.",
        "A request has the fields a and b. A misspelt keyword in AddTwoInts.Request(...) is ignored "
        "silently.",
    )


def one_call_only(evidence: Evidence) -> Advice | None:
    """It ends by itself after one call or none."""
    part = next(
        (p for p in _seen_parts(evidence) if p.ending and len(requests(p)) < expected_calls(evidence)), None
    )
    if part is None or (not part.endpoints("client") and not requests(part)):
        return None
    count = len(requests(part))
    return Advice(
        f"Your client called the service {'once' if count == 1 else 'not at all'}; the task asks for two "
        f"calls.",
        "Call once with a and b, then again with the first answer and c.",
    )


def too_many_calls(evidence: Evidence) -> Advice | None:
    """More calls than the reference solution makes."""
    part = next((p for p in _seen_parts(evidence) if len(requests(p)) > expected_calls(evidence)), None)
    if part is None:
        return None
    return Advice(
        f"Your client called the service {len(requests(part))} times; two calls are enough.",
        "Call once with a and b, once with the first answer and c, and no more.",
    )


def wrong_arguments(evidence: Evidence) -> Advice | None:
    """Two calls with other numbers."""
    finding = chains_the_calls(evidence)
    if finding.passed or not makes_two_calls(evidence).passed:
        return None
    return Advice(
        f"The calls carry the wrong numbers ({finding.seen}).",
        "The first call adds a and b, the second adds the first answer and c. Look at which field gets "
        "which number, "
        "and whether one request object is reused before it was sent.",
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
        p for p in _seen_parts(evidence) if p.endpoints("client") and p.ending is None and not requests(p)
    ]
    if not stuck:
        return None
    return Advice(
        "The service was there, but your client never called it and never ended: it goes on waiting.",
        "Wait with a limit, and call as soon as the service is there: "
        "`if not client.wait_for_service(timeout_sec=5.0):` say so and stop.",
    )


def gave_up_too_early(evidence: Evidence) -> Advice | None:
    """It ended before the late service came."""
    part = evidence.part(LATE)
    if part.ending is None or requests(part):
        return None
    if not any(requests(p) for p in _seen_parts(evidence)):
        return None
    return Advice(
        "The service came a moment late, and your client had already given up (or called before it was "
        "there).",
        "Wait for the service with wait_for_service and a few seconds of patience before the first call.",
    )


def sum_not_reported(evidence: Evidence) -> Advice | None:
    """The calls are right, and the last answer is never said."""
    silent = next((part for part in _seen_parts(evidence) if part.of("response") and not reports(part)), None)
    if silent is None or not chains_the_calls(evidence).passed:
        return None
    lines = silent.said(after=silent.of("response")[-1])
    if any(re.search(r"\d", line) for line in lines):
        return Advice(
            f"The service's last answer was {answers(silent)[-1]}, but your program said “{lines[-1]}”.",
            "Report the sum of the second answer, not the first one and not one of your own.",
        )
    return Advice(
        "Both calls are right, but the final sum is never said.",
        "Log or print the sum of the second answer (in the notebook, return it too).",
    )


def wrong_sum_reported(evidence: Evidence) -> Advice | None:
    """The calls are right, and another number is said."""
    silent = next((part for part in _seen_parts(evidence) if part.of("response") and not reports(part)), None)
    if silent is None or not chains_the_calls(evidence).passed:
        return None
    lines = silent.said(after=silent.of("response")[-1])
    if not any(re.search(r"\d", line) for line in lines):
        return None
    return sum_not_reported(evidence)


def silent_end(evidence: Evidence) -> Advice | None:
    """Without a service it ends, and says nothing."""
    finding = gives_up_in_time(evidence)
    if finding.passed or finding.seen != "ended without a word":
        return None
    return Advice(
        "When the service is not there, your client ends without a word.",
        "Log an error (or raise TimeoutError) before you return, so that its user knows why there is no sum.",
    )


EXERCISE = Exercise(
    id="exercise_1_2.three_ints",
    title="Exercise 1.2 · Three numbers, two calls",
    task="Add three numbers with two calls of a service that adds two.",
    scenario=scenario,
    criteria=(
        Criterion("calls", "Calls exactly twice", 2, makes_two_calls),
        Criterion("chain", "Builds the second call on the first answer", 3, chains_the_calls),
        Criterion("sum", "Reports the final sum", 3, reports_the_sum),
        Criterion("late", "Waits for a service that comes late", 1, waits_for_the_service),
        Criterion("limit", "Ends clearly when there is no service", 1, gives_up_in_time),
    ),
    mistakes=(
        *common.CRASHES,
        common.endpoint_name("client"),
        common.message_type("client"),
        *common.OTHER_CRASHES,
        Mistake("waits_forever", waits_for_nobody, certain=True),
        Mistake("waits_forever", waits_forever),
        *(replace(hang, certain=True) for hang in HANGS),
        Mistake("await_in_same_group", awaits_in_vain, certain=True),
        Mistake("call_never_spun", call_never_spun, certain=True),
        Mistake("too_many_calls", too_many_calls, certain=True),
        Mistake("first_answer_ignored", first_answer_ignored, certain=True),
        Mistake("field_typo", fields_never_filled, certain=True),
        Mistake("wrong_arguments", wrong_arguments, certain=True),
        Mistake("gave_up_too_early", gave_up_too_early),
        Mistake("one_call_only", one_call_only, certain=True),
        Mistake("wrong_sum_reported", common.only_if_ended(wrong_sum_reported), certain=True),
        Mistake("sum_not_reported", common.only_if_ended(sum_not_reported), certain=True),
        Mistake("wrong_sum_reported", wrong_sum_reported),
        Mistake("sum_not_reported", sum_not_reported),
        Mistake("silent_end", silent_end, certain=True),
        *common.NOTHING_THERE,
    ),
    roles=("client",),
    limit=150.0,
    arguments="three whole numbers",
    sample_arguments=(1, 2, 3),
)
