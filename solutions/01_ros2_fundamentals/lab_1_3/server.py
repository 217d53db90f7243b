"""Lab 1.3: a server that adds two integers: small, everyday, equal, negative and zero, and near the ends of 64 bits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit.draft import Draft
from autograder.kit.model import Advice, Finding
from autograder.kit.recipes.servers import CALLS_AT_ONCE, Asks, ServerSeen

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.recipes.servers import Fields

ORDINARY = 6
"""Calls with numbers of everyday size."""


def single_calls(random: Random) -> list[Fields]:
    """The calls that are made one by one: everyday numbers, negative ones, zeros, and sums just inside an int64.

    One request comes twice, with others in between: a server may remember nothing that changes its answer.
    """
    wide, low = 2**63 - 1, -(2**63)
    some = random.randint(1001, 99_999)
    everyday = [ordinary(random) for _ in range(ORDINARY)]
    return [
        *everyday,
        *small(random),
        {"a": some, "b": some},
        everyday[0],
        {"a": -some, "b": random.randint(1001, 99_999)},
        {"a": -random.randint(1001, 99_999), "b": -random.randint(1001, 99_999)},
        {"a": 0, "b": some},
        {"a": -some, "b": 0},
        {"a": 0, "b": 0},
        {"a": some, "b": -some},
        {"a": wide - some, "b": some},
        {"a": low + some, "b": -some + random.randint(0, 9)},
        {"a": wide, "b": low + random.randint(1, 999)},
    ]


def ordinary(random: Random) -> Fields:
    """Two numbers of everyday size."""
    a, b = random.sample(range(1001, 99_999), 2)
    return {"a": a, "b": b}


def small(random: Random) -> list[Fields]:
    """Numbers of one or two digits; the digits of the last two requests are the same, one after the other."""
    one, two, three, four = random.sample(range(1, 10), 4)
    return [
        {"a": one, "b": four},
        {"a": one, "b": 10 * two + three},
        {"a": 10 * one + two, "b": three},
    ]


def objection(request: Fields, answer: Fields | None) -> str:
    """Return the fault of an answer, in words; empty if it is right."""
    a, b = request["a"], request["b"]
    if answer is None:
        return f"no answer to {a} + {b}"
    return "" if answer["sum"] == a + b else f"{a} + {b} was answered with {answer['sum']}"


def silence(request: Fields, answer: Fields | None) -> str:
    """Return the objection to a missing answer; empty if one came, right or wrong."""
    return "" if answer is not None else objection(request, answer)


server = Draft(
    "lab_1_3.server",
    "Lab 1.3 · A server that adds",
    "Serve add_two_ints: answer each request with the sum of its two numbers.",
    asks := Asks(single_calls, ordinary),
)
server.asks("service", 2, "Serves add_two_ints, with the right type", asks.serves)


@server.criterion("sums", 4, "Answers with the sum")
def sums(seen: ServerSeen, _: ServerSeen) -> Finding:
    """Each call of the first phase is answered with the sum."""
    return seen.all_right(seen.singly, objection, "the sum, for every pair of numbers")


@server.criterion("together", 2, "Answers several calls at once")
def together(seen: ServerSeen, _: ServerSeen) -> Finding:
    """Each of the calls at once is answered with its own sum."""
    return seen.all_right(
        seen.together, objection, f"the right sum for each of {CALLS_AT_ONCE} calls at once"
    )


@server.criterion("alive", 2, "Stays alive")
def alive(seen: ServerSeen, _: ServerSeen) -> Finding:
    """The call after all others is answered; with which sum, other criteria say."""
    return seen.all_right(seen.last, silence, "one more call is answered after all that")


server.knows(
    "field_typo",
    lambda seen, _: bool(seen.answers) and not any(answer["sum"] for answer in seen.answers.values()),
    "Every answer is 0: in the response that your method returns, the field sum was never filled.",
    "Set the field sum of the response that you were given, as in response.sum = request.a + request.b, and return "
    "this response. A misspelt keyword in AddTwoInts.Response(...) is ignored silently.",
    certain=True,
)


@server.mistake("wrong_sum", certain=True)
def wrong_sum(seen: ServerSeen, _: ServerSeen) -> Advice | None:
    """An answer is not the sum."""
    wrong = [text for text in seen.objections(seen.asked, objection) if " was answered" in text]
    if seen.part.traceback:
        # If a value does not fit into the message, rclpy answers -1 and ends: that is not the subject's own sum.
        wrong = [text for text in wrong if not text.endswith(" was answered with -1")]
    if not wrong:
        return None
    return Advice(
        f"The answer is not the sum: {wrong[0]}.",
        "Compute it from this very request, as in response.sum = request.a + request.b. Python's whole numbers have no "
        "limit, so nothing needs to be converted.",
    )


EXERCISE = server.exercise(
    limit=90.0,
    text={
        "Let your node offer the service `add_two_ints`": "service",
        "An answer within one second is quick enough.": "sums",
        "answer each request with the sum of `a` and `b`.": "sums",
        "Serves add_two_ints: the sum of a and b.": "sums",
        "It sends small, huge and negative numbers, and several requests at the same time.": "sums together",
        "Then it checks that your node is still running.": "alive",
    },
)
