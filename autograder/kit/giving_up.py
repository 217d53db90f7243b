"""Clients whose server is late or does not come: how long they wait, what they say meanwhile, and how they give up.

One rule holds for every client of the course. A client that ends and says why has given up well; a bare number, an
error that nobody meant, or words that it also says where the server is there are no such report. A client that says
again and again that it waits may go on, with a remark on the card about limits. A client that is silent, or says
something once and is silent then, does neither. A function that is told how long to wait, by a parameter
``patience_sec``, keeps that time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from decimal import Decimal
from typing import TYPE_CHECKING

import re2

from autograder.kit.crashes import last_line_of, meant, on_purpose
from autograder.kit.model import mistake

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.model import Bench, Finding, Mistake

PATIENCE = "patience_sec"
"""The parameter by which a notebook's function is told how long to wait; also its name among a part's inputs."""
GIVE_UP_LIMIT = 12.0
"""Seconds in which a client must have ended when nobody serves, or have said again and again that it waits."""
LATENESS = 1.5
"""Seconds that a late server comes after its client."""
PATIENCES = (6.5, 6.95)
"""Between which the seconds are drawn that a function is told to wait. No usual constant, such as 5 or 10, is taken for
one of these: it may differ from its patience by what is below."""
TOO_LONG = 2.0
"""Seconds that a function may need on top of its patience: to make its node, to take it away, to be slow."""
SLACK = 3.0
"""The same as a multiple of a short patience; who was slower than that in a quick look is told a longer one."""
TOO_SHORT = 0.5
"""The share of its patience that a function must at least wait."""
PART_OF_A_WAIT = 1.0
"""Seconds that a function may leave out at the end of a longer patience: it may wait in whole seconds."""
SILENT = "ended without saying so"
"""The objection to a client that says nothing of what it misses."""
_SHUT_DOWN = "rclpy.executors.ExternalShutdownException"
_NUMBER = re2.compile(r"-?\d+(?:\.\d+)?")
_NUMBER_OR_NONE = re2.compile(rf"{_NUMBER.pattern}|\bNone\b")
_VALUE = re2.compile(rf"{_NUMBER_OR_NONE.pattern}|\b(?:True|False)\b")
_SIGNS = re2.compile(r"[^\pL\pN#]+")
AGAIN_AND_AGAIN = 3
"""The number of times that a client says that it waits, to have said it again and again."""
SAYS_SO_TO = 8.0
"""Seconds after which it must still say so: who says it every four seconds does, and who tried three times does not."""
_CLIENTS = ("client", "action_client")
_AT_WORK = ("log", "spared", "called", "willing")
"""The kinds of events that show a node at work, or a function that waits, also where the graph tells of neither."""
MOMENT = 0.5
"""Seconds: what is said within these is said once. A log line comes on two ways, and a loop may be in a hurry."""


# --- time ----------------------------------------------------------------------------------------------------


def spared(part: Part) -> float:
    """Seconds of waiting for a server that a notebook has left out of a run so far."""
    return sum(float(event.data["seconds"]) for event in part.of("spared"))


def willing(part: Part, call: int) -> float:
    """Seconds that a subject is known to wait for the answer to one of its calls, at least; 0 where nobody tells."""
    told = [event for event in part.of("willing") if event.data["call"] == call]
    return max((float(event.data["seconds"]) for event in told), default=0.0)


def waited(part: Part) -> float:
    """Seconds from a subject's start to its end, with those that it was spared; to the last event where it goes on."""
    start = part.first("subject", "started")
    end = part.ending or (part.events[-1] if part.events else None)
    return (end.t if end else 0.0) - (start.t if start else 0.0) + spared(part)


def patience(part: Part) -> float | None:
    """The seconds that the subject was told to wait; None where it has no parameter for that."""
    start = part.first("subject", "started")
    takes = start is not None and PATIENCE in start.data["accepted"]
    return float(part.inputs[PATIENCE]) if takes and PATIENCE in part.inputs else None


def drawn_patience(bench: Bench, between: tuple[float, float] = PATIENCES) -> float:
    """Seconds that a function is to be told to wait, in whole hundredths."""
    return round(bench.random.uniform(*between), 2)


def await_it(bench: Bench) -> None:
    """Wait until a subject without a server has given up, or could have; what it was spared counts as waited."""
    bench.wait_until(lambda seen: spared(seen.main) >= GIVE_UP_LIMIT, GIVE_UP_LIMIT)


# --- without a server ----------------------------------------------------------------------------------------


def says_that_it_waits(part: Part) -> bool:
    """True if the subject says the same, but for numbers and signs, again and again, and not only at the beginning.

    The beginning is where its client was seen: on a busy machine a program may need seconds to come so far.
    """
    looks = (event.t for event in part.of("interface") if any(map(event.data.get, _CLIENTS)))
    late = (next(looks, 0.0) + SAYS_SO_TO) / MOMENT
    return any(len(times) >= AGAIN_AND_AGAIN and max(times) >= late for times in _moments(part).values())


def _moments(part: Part) -> dict[str, set[int]]:
    """The moments at which it said each line; lines that differ in their numbers, or in signs alone, are one."""
    moments: dict[str, set[int]] = {}
    passed = 0.0
    for event in part.events:
        if event.kind == "spared":
            passed += float(event.data["seconds"])
        for line in filter(str.strip, replace(part, events=[event]).said()):
            moments.setdefault(_in_letters(line), set()).add(int((event.t + passed) / MOMENT))
    return moments


def _in_letters(line: str) -> str:
    """The shape of a line without its signs: a row of dots that grows, or a bar that turns, says nothing new."""
    return _SIGNS.sub(" ", shape(line)).strip()


def shape(line: str) -> str:
    """A line with a place for each number or other bare value, so that it can be compared with another line."""
    return _VALUE.sub("#", line)


def answer_shape(line: str) -> str:
    """The shape of a line that reports an answer: "found: False" says something else than "found: True" does."""
    return _NUMBER_OR_NONE.sub("#", line)


def goes_on_waiting(part: Part) -> bool:
    """True if the subject waits without end and may: it says so, and was not told how long to wait."""
    return bool(part.events) and part.ending is None and patience(part) is None and says_that_it_waits(part)


def waits_in_silence(part: Part) -> bool:
    """True if the subject waits without end and may not."""
    return bool(part.events) and part.ending is None and not goes_on_waiting(part)


def hides_its_end(part: Part, finding: Finding) -> str:
    """The value that it returned as if that were the answer, or :data:`SILENT`; empty where it says what it misses.

    Args:
        part: The run without a server.
        finding: The criterion on that run.
    """
    if finding.passed:
        return ""
    return returned_answer(part) or (SILENT if finding.seen == SILENT else "")


def objection(
    part: Part, usual: Sequence[Part] = (), *, is_report: Callable[[str], bool] = lambda _: False
) -> str:
    """The fault of a client that finds no server, in words; empty where it behaves well.

    Args:
        part: The run without a server.
        usual: Runs in which it met its server at once and did its work: what it says there, too, tells of no trouble.
        is_report: Whether a line has the words in which the subject reports an answer.
    """
    if not part.events:
        return "not reached"
    if part.ending is None:
        return "" if goes_on_waiting(part) else f"still waiting after {GIVE_UP_LIMIT:g} s"
    if value := returned_answer(part):
        return f"returned {value}, as if that were the answer"
    if not (_failed_aloud(part) or any(not is_report(line) for line in _telling(part, usual))):
        return SILENT
    return broken_patience(part)


def returned_answer(part: Part) -> str:
    """The number or text that a function returned; empty where it returned nothing that looks like an answer."""
    value = part.returned or ""
    return value if re2.fullmatch(r"-?\d+|['\"].*\pL.*", value) else ""


def _telling(part: Part, usual: Sequence[Part]) -> list[str]:
    """Its lines with words that it does not say where its server is there, or says again and again."""
    said = replace(part, events=[event for event in part.events if event.kind != "subject"]).said()
    lines = {line for line in said if re2.search(r"\pL", _VALUE.sub("", line))}
    if len(lines) > MOST_LINES:
        return sorted(lines)
    known = [words for other in usual for words in _said(other)[:MOST_LINES]]
    again = {line for line, times in _moments(part).items() if max(times) - min(times) > 1}
    return [
        line
        for line in lines
        if _in_letters(line) in again
        or not any(_in_words(part, line).says_the_same_as(words) for words in known)
    ]


def _failed_aloud(part: Part) -> bool:
    """True if it has shown what went wrong, by an exception that somebody may have meant.

    A thread that spins while the program calls ``rclpy.shutdown()`` shows a traceback at every end, also at a good one.
    """
    lines = part.traceback.strip().splitlines()
    if not lines:
        return part.ending is not None and part.ending.name == "raised"
    return on_purpose(part.traceback) and (meant(part.traceback) or not lines[-1].startswith(_SHUT_DOWN))


def broken_patience(part: Part) -> str:
    """The difference between the time that a function took and its patience, in words; empty where it kept that."""
    limit = patience(part)
    if limit is None or part.ending is None:
        return ""
    if max(limit * TOO_SHORT, limit - PART_OF_A_WAIT) <= waited(part) <= limit + min(TOO_LONG, limit * SLACK):
        return ""
    return f"gave up after {waited(part):.1f} s, where {PATIENCE} was {limit:g}"


def looks_elsewhere(evidence: Evidence, absent: Part, role: str) -> bool:
    """True if a client that was never seen to ask for anything was seen to look for another server than the task's.

    One that ends, whether there is a server or not, must have looked under another name. One that goes on waiting may
    have had the task's name and another type.

    Args:
        evidence: All of its runs.
        absent: The run without a server.
        role: ``client`` or ``action_client``.
    """
    name, kind = evidence.reference.only(role)
    looked_for = [found for part in evidence for found in part.endpoints(role).items()]
    waits_on = absent.ending is None
    return any(other != name or (waits_on and its_type != kind) for other, its_type in looked_for)


def ended_at_once(part: Part) -> bool:
    """True if a function that was told how long to wait has ended much too early for any wait."""
    limit = patience(part)
    return limit is not None and part.ending is not None and waited(part) < limit * TOO_SHORT


def patience_not_kept(absent: str) -> Mistake:
    """A function waits by a limit of its own in the run without a server, which is called ``absent``."""
    return mistake(
        "patience_not_kept",
        lambda evidence: "" if _looked_for_nobody(evidence) else broken_patience(evidence.part(absent)),
        "When there is no server, your function {}.",
        f"Use {PATIENCE} as the limit, once: `if not your_client.wait_for_service(timeout_sec={PATIENCE}):` (or "
        f"`wait_for_server`), and below it say so and end: `raise TimeoutError(...)`. Without `raise` or `return` it "
        f"goes on to its next wait. A loop has to end {PATIENCE} seconds after it began.",
    )


def remark(absent: str) -> Callable[[Evidence], str]:
    """The card's remark on a client that goes on waiting in the run without a server, which is called ``absent``."""
    words = (
        "When there is no server, your client says again and again that it waits, and waits on. The task allows this; "
        "a robot that must not wait for ever needs a limit as well, such as a number of tries."
    )
    return lambda evidence: words if goes_on_waiting(evidence.part(absent)) else ""


# --- with a server -------------------------------------------------------------------------------------------

MOST_LINES = 200
"""Different lines of a run that are compared one by one; nobody says more of a server that is not there."""


def gave_up(served: Sequence[Part], absent: Part, asked: Callable[[Part], bool]) -> bool:
    """True if the subject ended before it had met a server that was there.

    On the wire a client that gave up and one that never meant to ask both only end. What tells them apart is that the
    first says of a server that is there what it says of one that is not. In which of the runs it ends too early depends
    on the machine: who looks once may find the server in some of them, in all or in none.

    Args:
        served: The runs with a server; in the first one the server comes late.
        absent: The run without one.
        asked: Whether the subject asked the server for something in a run.
    """
    if _looked_for_nobody((absent, *served)):
        return False
    ended = [part for part in served if part.ending and not asked(part)]
    if served[0] in ended and any(asked(part) for part in served):
        return True
    told = _parting_words(absent)
    # In each of them: a sum that the subject has added up itself may happen to be one of the run's own numbers.
    return bool(absent.ending and told and ended) and all(_same(_parting_words(part), told) for part in ended)


def _looked_for_nobody(parts: Iterable[Part]) -> bool:
    """True of a subject that came to a good end in each of its runs and was never seen to be a node, nor to wait.

    A notebook's function may be gone before the graph tells of its node, so what it did is not known then.
    """
    return all(
        part.ending is not None and part.ending.name in ("exited", "returned") and not _was_seen(part)
        for part in parts
    )


def _was_seen(part: Part) -> bool:
    return part.had_node or any(map(part.endpoints, _CLIENTS)) or any(map(part.of, _AT_WORK))


def not_forgotten(
    absent: str,
    noun: str,
    role: str,
    served: Callable[[Evidence], Sequence[Part]],
    asked: Callable[[Part], bool],
) -> Mistake:
    """A client gives up where its server is there, and not where it is absent: its condition lacks a ``not``.

    Args:
        absent: The name of the run without a server.
        noun: What is waited for, ``"service"`` or ``"server"``, as in the name of the wait.
        role: The client's endpoint, such as ``"client"``.
        served: Gives the runs with a server.
        asked: Whether the subject asked the server for something in a run.
    """
    wait = f"wait_for_{noun}"
    return mistake(
        "not_forgotten",
        lambda evidence: _gives_up_where_served(served(evidence), evidence.part(absent), role, asked),
        f"Your client says “{{}}” where the {noun} is there, and does not say it where there is none: the condition is "
        "the wrong way round.",
        f"{wait} returns True when the {noun} is there. Write `if not your_{role}.{wait}(timeout_sec=5.0):` above what "
        f"your client does without a {noun}.",
        certain=True,
    )


def _gives_up_where_served(
    served: Sequence[Part], absent: Part, role: str, asked: Callable[[Part], bool]
) -> str:
    """The words with which a client ends where its server is there, and not where it is absent; empty for none.

    Empty also where it gives up well without a server: what it says where there is one is then about something else.
    """
    if not (served and absent.events and objection(absent, served)):
        return ""
    if any(asked(part) or not (part.ending and part.endpoints(role)) for part in served):
        return ""
    usual = {line.shape for line in _parting_words(absent)}
    told = [
        [line for line in _last_words(part) if _in_words(part, line).shape not in usual] for part in served
    ]
    return told[0][-1] if all(told) else ""


def _last_words(part: Part) -> list[str]:
    """Its lines, and the exception that it ended with where it raised that itself."""
    raised = last_line_of(part.traceback) if meant(part.traceback) else ""
    return list(filter(str.strip, [*part.said(), raised]))


@dataclass(frozen=True)
class _Words:
    """A line that a subject said, so that it can be compared with a line of another run, which had other inputs.

    Attributes:
        shape: The line with a place for each number.
        numbers: The numbers in these places, as they were said.
        own: Of each number, whether it is one of the run's inputs.
    """

    shape: str
    numbers: tuple[str, ...]
    own: tuple[bool, ...]

    def says_the_same_as(self, other: _Words) -> bool:
        """True if the lines differ in nothing but the inputs of their runs. A number may be an input by chance."""
        return self.shape == other.shape and all(
            mine == theirs or (own and others)
            for mine, theirs, own, others in zip(
                self.numbers, other.numbers, self.own, other.own, strict=True
            )
        )


def _same(words: set[_Words], others: set[_Words]) -> bool:
    if max(len(words), len(others)) > MOST_LINES:
        return words == others
    return _all_within(words, others) and _all_within(others, words)


def asks_nowhere(absent: Part, served: Part, role: str) -> bool:
    """True if it is no client of anything, or ends with the same words whether there is a server or not.

    Args:
        absent: The run without a server.
        served: One in which it did not ask its server either.
        role: The client's endpoint, such as ``"client"``.
    """
    if not absent.endpoints(role):
        return True
    alike = (absent.ending is None) is (served.ending is None)
    return alike and _same(_parting_words(absent), _parting_words(served))


def _all_within(words: set[_Words], others: set[_Words]) -> bool:
    return all(any(line.says_the_same_as(other) for other in others) for line in words)


def _parting_words(part: Part) -> set[_Words]:
    """Its lines, each once: a log line may come on two ways."""
    last = [_in_words(part, line) for line in part.traceback.splitlines()[-1:] if line.strip()]
    return {*_said(part), *last}


def _said(part: Part) -> list[_Words]:
    return [_in_words(part, line) for line in part.said() if line.strip()]


def _in_words(part: Part, line: str) -> _Words:
    for text in part.inputs.values():
        if isinstance(text, str) and text:
            line = line.replace(text, "(an input)")
    own = {_value(number) for number in _NUMBER.findall(str(list(part.inputs.values())))}
    numbers = _NUMBER.findall(line)
    return _Words(_NUMBER.sub("#", line), tuple(numbers), tuple(_value(number) in own for number in numbers))


def _value(number: str) -> Decimal:
    """Without its sign: who says ``1-2`` may mean two numbers."""
    return abs(Decimal(number))
