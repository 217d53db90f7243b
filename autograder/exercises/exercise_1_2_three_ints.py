"""Exercise 1.2: a client that adds three numbers with two calls of a service that adds two.

The judge serves. In one part it answers with a hidden bias, so that the second call and the reported sum show
whether the first answer was really used.
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
    CALLED,
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
    only_if_called,
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
        (BIASED, negative(random), hidden_bias(random)),
        (EXTREME, extreme(random), 0),
    ):
        if not called(bench, name, numbers, bias, calls=2):
            return
    unserved(bench, ordinary(random))


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


def calls_as_the_reference(evidence: Evidence, part: Part) -> bool:
    """The first call adds the first two numbers, the second its answer and the third number."""
    made = requests(part)
    if len(made) != expected_calls(evidence):
        return False
    a, b, c = part.inputs["numbers"]
    return pair(made[0]) == sorted((a, b)) and pair(made[1]) == sorted((answers(part)[0], c))


def makes_two_calls(evidence: Evidence) -> Finding:
    """In each run it calls as often as the reference solution."""
    wanted = expected_calls(evidence)
    counts = [len(requests(part)) for part in served_parts(evidence)]
    return Finding(
        all(count == wanted for count in counts),
        f"{wanted} calls in each run",
        ", ".join(f"{count} ({name})" for count, name in zip(counts, CALLED, strict=True)),
    )


def chains_the_calls(evidence: Evidence) -> Finding:
    """The second call is built on the first one's answer."""
    wrong = next((p for p in served_parts(evidence) if not calls_as_the_reference(evidence, p)), None)
    expected = "first a + b, then that answer + c"
    if wrong is None:
        return Finding(True, expected, expected)
    made = [f"{e.data['fields']['a']} + {e.data['fields']['b']}" for e in requests(wrong)[:3]]
    numbers = wrong.inputs.get("numbers")
    seen = (f"for {', '.join(map(str, numbers))}: " if numbers else "") + (", then ".join(made) or "no call")
    return Finding(False, expected, seen)


def waits_for_the_service(evidence: Evidence) -> Finding:
    """With a service that comes late it does its work all the same."""
    part = evidence.part(LATE)
    done = calls_as_the_reference(evidence, part) and (part.ending is not None or reports(part))
    return Finding(done, "waits, then calls", "it did" if done else how_it_went(part))


# --- known mistakes ----------------------------------------------------------------------------------------


def first_answer_ignored(evidence: Evidence) -> Advice | None:
    """The second call carries a + b as computed by the client."""
    part = evidence.part(BIASED)
    made = requests(part)
    if len(made) < 2:
        return None
    a, b, c = part.inputs["numbers"]
    if pair(made[1]) != sorted((a + b, c)) or pair(made[1]) == sorted((answers(part)[0], c)):
        return None
    return Advice(
        f"The service answered {answers(part)[0]} to the first call, but your second call does not use that "
        f"answer: "
        "it adds up on its own.",
        "Take first.sum from the first answer and put it into the second request.",
    )


def one_call_only(evidence: Evidence) -> Advice | None:
    """It ends by itself after one call or none."""
    part = next(
        (p for p in served_parts(evidence) if p.ending and len(requests(p)) < expected_calls(evidence)), None
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
    part = next((p for p in served_parts(evidence) if len(requests(p)) > expected_calls(evidence)), None)
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


def sum_not_reported(evidence: Evidence) -> Advice | None:
    """The calls are right, and the last answer is never said."""
    silent = next(
        (part for part in served_parts(evidence) if part.of("response") and not reports(part)), None
    )
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
    silent = next(
        (part for part in served_parts(evidence) if part.of("response") and not reports(part)), None
    )
    if silent is None or not chains_the_calls(evidence).passed:
        return None
    lines = silent.said(after=silent.of("response")[-1])
    if not any(re.search(r"\d", line) for line in lines):
        return None
    return sum_not_reported(evidence)


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
        Mistake("one_call_only", only_if_called(one_call_only), certain=True),
        Mistake("one_call_only", one_call_only),
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
