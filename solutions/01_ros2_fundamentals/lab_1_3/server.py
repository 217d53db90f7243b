"""Lab 1.3: a server that adds two integers: small, everyday, equal, negative and zero, and near the ends of 64 bits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit import Asks, Draft

if TYPE_CHECKING:
    from random import Random

    from autograder.kit.recipes.servers import Fields, ServerSeen

LOW, TOP = -(2**63), 2**63 - 1
"""The ends of an int64."""


def single_calls(random: Random) -> list[Fields]:
    """The calls that are made one by one: everyday numbers, negative ones, zeros, and sums just inside an int64.

    One request comes twice, with others in between: a server may remember nothing that changes its answer. The digits
    of two small requests are the same, one after the other.
    """
    some, *sizes = (random.randint(1001, 99_999) for _ in range(4))
    one, two, three, four = random.sample(range(1, 10), 4)
    small = [(one, four), (one, 10 * two + three), (10 * one + two, three), (0, some), (-some, 0), (0, 0)]
    mixed = [(some, some), (-some, sizes[0]), (-sizes[1], -sizes[2]), (some, -some), (TOP - some, some)]
    huge = [(LOW + some, random.randint(0, 9) - some), (TOP, LOW + random.randint(1, 999))]
    everyday = [ordinary(random) for _ in range(6)]
    return [*everyday, *({"a": a, "b": b} for a, b in (*small, *mixed, *huge)), everyday[0]]


def ordinary(random: Random) -> Fields:
    """Two numbers of everyday size."""
    return dict(zip("ab", random.sample(range(1001, 99_999), 2), strict=True))


def objection(request: Fields, answer: Fields) -> str:
    """Return the fault of an answer, in words; empty if it is right."""
    a, b = request["a"], request["b"]
    return "" if answer["sum"] == a + b else f"{a} + {b} was answered with {answer['sum']}"


server = Draft(
    "lab_1_3.server",
    "Lab 1.3 · A server that adds",
    "Serve add_two_ints: answer each request with the sum of its two numbers.",
    asks := Asks(single_calls, ordinary),
)
server.asks("service", "Serves add_two_ints, with the right type", asks.serves, points=2)

server.asks(
    "sums", "Answers with the sum", asks.right("singly", objection, "the sum, for every pair"), points=4
)
server.asks(
    "together", "Answers several calls at once", asks.right("together", objection, "each sum"), points=2
)
server.asks("alive", "Stays alive", asks.right("last", lambda *_: "", "one more call is answered"), points=2)


def wrong_sum(seen: ServerSeen, _: ServerSeen) -> str:
    """Return a wrong answer in words.

    If a value does not fit into the message, rclpy answers -1 and ends: that is not the subject's own sum.
    """
    wrong = [text for text in seen.objections(seen.asked, objection) if " was answered" in text]
    return next((w for w in wrong if not (seen.part.traceback and w.endswith(" was answered with -1"))), "")


server.knows(
    "field_typo",
    lambda seen, _: bool(seen.answers) and not any(answer["sum"] for answer in seen.answers.values()),
    "Every answer is 0: in the response that your method returns, the field sum was never filled.",
    "Set the field sum of the response that you were given, as in response.sum = request.a + request.b, and return "
    "this response. A misspelt keyword in AddTwoInts.Response(...) is ignored silently.",
    certain=True,
)
server.knows(
    "wrong_sum",
    wrong_sum,
    "The answer is not the sum: {}.",
    "Compute it from this very request, as in response.sum = request.a + request.b. Python's whole numbers have no "
    "limit, so nothing needs to be converted.",
    certain=True,
)

EXERCISE = server.exercise(
    limit=90.0,
    text={
        "Let your node offer the service `add_two_ints`": "service",
        "answer each request with the sum of `a` and `b`.": "sums",
        "Serves add_two_ints: the sum of a and b.": "sums",
        "It sends small, huge and negative numbers, and several requests at the same time.": "sums together",
        "Then it checks that your node is still running.": "alive",
        "log each request": "",
    },
    counts={
        "sums": "An answer within one second is quick enough.",
    },
)
