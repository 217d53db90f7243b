"""Lab 1.3: a client that has two integers added.

The judge serves. In one part it answers with a hidden bias, so that the reported sum shows whether the answer was used.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.exercises import common_mistakes as common
from autograder.exercises.hangs import HANGS
from autograder.exercises.model import Advice, Bench, Criterion, Exercise, Finding, Mistake
from autograder.exercises.service_clients import (
    BIASED,
    EXTREME,
    LATE,
    answers,
    awaits_in_vain,
    call_never_spun,
    called,
    expected_calls,
    fields_never_filled,
    gave_up_too_early,
    gives_up_in_time,
    hidden_bias,
    how_it_went,
    pair,
    reports,
    reports_the_sum,
    requests,
    served_parts,
    silent_end,
    unserved,
    waits_for_nobody,
    waits_forever,
)

if TYPE_CHECKING:
    from random import Random

    from autograder.exercises.evidence import Evidence, Part


def scenario(bench: Bench) -> None:
    """Four runs: a late service, a surprising one, large numbers, and none at all."""
    random = bench.random
    for name, numbers, bias in (
        (LATE, ordinary(random), 0),
        (BIASED, (-random.randint(1001, 99_999), 0), hidden_bias(random)),
        (EXTREME, (2**63 - 1 - random.randint(0, 999), -(2**62) + random.randint(0, 999)), 0),
    ):
        if not called(bench, name, numbers, bias, calls=1):
            return
    unserved(bench, ordinary(random))


def ordinary(random: Random) -> tuple[int, int]:
    """Two numbers of everyday size."""
    a, b = random.sample(range(1001, 99_999), 2)
    return a, b


# --- questions to the evidence -----------------------------------------------------------------------------


def calls_as_the_reference(evidence: Evidence, part: Part) -> bool:
    """As many calls as the reference solution makes, with the part's numbers."""
    made = requests(part)
    return len(made) == expected_calls(evidence) and pair(made[0]) == sorted(part.inputs["numbers"])


def asks_for_the_numbers(evidence: Evidence) -> Finding:
    """In each run it calls once, with the two numbers."""
    wrong = next(
        (part for part in served_parts(evidence) if not calls_as_the_reference(evidence, part)), None
    )
    expected = "one call with the two numbers, in each run"
    if wrong is None:
        return Finding(True, expected, expected)
    made = [f"{e.data['fields']['a']} + {e.data['fields']['b']}" for e in requests(wrong)[:3]]
    numbers = " and ".join(map(str, wrong.inputs.get("numbers", ())))
    return Finding(False, expected, (f"for {numbers}: " if numbers else "") + (", ".join(made) or "no call"))


def waits_for_the_service(evidence: Evidence) -> Finding:
    """With a service that comes late it does its work all the same."""
    part = evidence.part(LATE)
    done = calls_as_the_reference(evidence, part) and (part.ending is not None or reports(part))
    return Finding(done, "waits, then calls", "it did" if done else how_it_went(part))


# --- known mistakes ----------------------------------------------------------------------------------------


def too_many_calls(evidence: Evidence) -> Advice | None:
    """More calls than the reference solution makes."""
    part = next((p for p in served_parts(evidence) if len(requests(p)) > expected_calls(evidence)), None)
    if part is None:
        return None
    return Advice(
        f"Your client called the service {len(requests(part))} times for one sum.",
        "Call once, and wait for that answer.",
    )


def no_call(evidence: Evidence) -> Advice | None:
    """It ends by itself, with a client and without a call."""
    part = next((p for p in served_parts(evidence) if p.ending and not requests(p)), None)
    if part is None or not part.endpoints("client"):
        return None
    return Advice(
        "Your client never called the service.",
        "Make a request, fill a and b, and send it with call_async. What you add up yourself is no "
        "answer of the server.",
    )


def wrong_arguments(evidence: Evidence) -> Advice | None:
    """One call with other numbers."""
    finding = asks_for_the_numbers(evidence)
    if finding.passed or not all(
        len(requests(part)) == expected_calls(evidence) for part in served_parts(evidence)
    ):
        return None
    return Advice(
        f"The call carries the wrong numbers ({finding.seen}).",
        "The request's a is the first number, its b the second. On a command line, sys.argv[0] is the program itself.",
    )


def sum_not_reported(evidence: Evidence) -> Advice | None:
    """The call is right, and the answer is never said."""
    silent = _silent(evidence)
    if silent is None:
        return None
    return Advice(
        "The call is right, but the sum is never said.",
        "Log or print the sum of the answer (in the notebook, return it too): future.result().sum.",
    )


def wrong_sum_reported(evidence: Evidence) -> Advice | None:
    """The call is right, and another number is said."""
    silent = _silent(evidence)
    lines = silent.said(after=silent.of("response")[-1]) if silent else []
    told = next((line for line in reversed(lines) if re.search(r"\d", line)), None)
    if silent is None or told is None:
        return None
    return Advice(
        f"The service answered {answers(silent)[-1]}, but your program said “{told}”.",
        "Report what the answer holds, future.result().sum, and add nothing up yourself.",
    )


def _silent(evidence: Evidence) -> Part | None:
    """A part with a right call whose answer was not reported."""
    parts = (part for part in served_parts(evidence) if part.of("response"))
    return next((p for p in parts if calls_as_the_reference(evidence, p) and not reports(p)), None)


EXERCISE = Exercise(
    id="lab_1_3.client",
    title="Lab 1.3 · A client that asks for a sum",
    task="Have the service add_two_ints add two numbers, and report its answer.",
    scenario=scenario,
    criteria=(
        Criterion("call", "Calls once, with the two numbers", 4, asks_for_the_numbers),
        Criterion("sum", "Reports the sum that the service answered", 4, reports_the_sum),
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
        Mistake("field_typo", fields_never_filled, certain=True),
        Mistake("wrong_arguments", wrong_arguments, certain=True),
        Mistake("gave_up_too_early", gave_up_too_early),
        Mistake("no_call", no_call),
        Mistake("wrong_sum_reported", common.only_if_ended(wrong_sum_reported), certain=True),
        Mistake("sum_not_reported", common.only_if_ended(sum_not_reported), certain=True),
        Mistake("wrong_sum_reported", wrong_sum_reported),
        Mistake("sum_not_reported", sum_not_reported),
        Mistake("silent_end", silent_end, certain=True),
        *common.NOTHING_THERE,
    ),
    roles=("client",),
    limit=150.0,
    arguments="two whole numbers",
    sample_arguments=(1, 2),
)
