"""Inspecting services: a function that finds a service by its type, as `ros2 service find` does.

The judge serves. The names, the types that the task asks for and the order of the runs are random. Only the type
distinguishes the right service from the others: one of these has a tempting name, one comes as late as the late one,
some have a type of the same name in another package, and in one run no service has the type.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder.kit import giving_up
from autograder.kit.draft import OWN, OWN_LATE, Draft
from autograder.kit.giving_up import LATENESS, PATIENCES
from autograder.kit.lateness import SOON, was_patient
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, OTHER_SLIPS, meant
from autograder.kit.model import Advice, Bench, Finding, Pace
from autograder.kit.recipes.own_scenario import OwnLadder

if TYPE_CHECKING:
    from collections.abc import Mapping
    from random import Random

    from autograder.kit.evidence import Evidence, Part

ADDER = "my_robot_interfaces/srv/AddTwoInts"
"""The type that the notebook shows. Other services have it, but the task never asks for it."""
TEMPTING = {
    "std_srvs/srv/SetBool": "/set_bool",
    "std_srvs/srv/Empty": "/empty",
    "std_srvs/srv/Trigger": "/trigger",
}
"""The types that are asked for, each with a name that sounds like it and is given to a service of another type."""

TWIN = {"std_srvs/srv/Trigger": "small_robot_interfaces/srv/Trigger"}
"""A type that is asked for, and the type of another package that is called like it."""
TWINS = ("alcove", "zenith")
"""Words for services of that type: their names come before and after those of all others."""
NAMES = (4, 5, 6)
"""How many services there may be beside the tempting one."""
HIDDEN = "_parameters"
"""The end of the name of one service that is asked for, and of some that are not."""

LATE = "the service comes late"
OTHER = "another type is asked for"
ABSENT = "no service has the type"

LOOKS = 4
"""Looks at the graph after which a subject will certainly look again: the service need not be later than that.

A subject that looks this often and then gives up has not kept its patience if there is no service.
"""
IMPATIENT = 3.0
"""Seconds within which no patient subject has given up; on a busy machine a single look may take one second."""
FIND_LIMIT = 12.0
"""Seconds of wall time within which a subject must have found an existing service."""
PATIENCE_IN_LATE = (4.0, 5.0)
"""The range of the patience that a function is told if the service comes late."""
PATIENCE_ELSEWHERE = {Pace.FAST: (0.4, 0.48), Pace.REAL_TIME: PATIENCES}
"""The range if the service exists from the start, and if there is none, so that the patience does not reveal which.

No usual constant from 2 seconds on lies in one of these.
"""

_WORDS = ("kitchen", "garage", "tower", "harbour", "meadow", "attic", "bridge", "cellar", "garden", "forge")


def scenario(bench: Bench) -> None:
    """Three runs, in an order that is drawn: a late service, one of another type, and none at all."""
    random = bench.random
    # The type with a twin is asked for in the same run of each check, so a subject that takes the twin always loses the
    # same points.
    (twin,), others = TWIN, sorted(TEMPTING.keys() - TWIN.keys())
    asked = dict(zip((LATE, ABSENT, OTHER), (*random.sample(others, len(others)), twin), strict=True))
    for name in random.sample(list(asked), len(asked)):
        type_name = asked[name]
        another = random.choice([other for other in asked.values() if other != type_name])
        right, misleading = named_services(random, another, hidden=name == OTHER)
        # Of the lab's own type in each run, so that who always looks for that one is wrong in each.
        misleading[TEMPTING[type_name]] = ADDER
        if type_name in TWIN:
            misleading |= {f"/{word}/{_number(random)}": TWIN[type_name] for word in TWINS}
        if name == ABSENT:
            unserved(bench, type_name, {**misleading, right: another})
        else:
            served(bench, name, {right: type_name}, misleading)


def named_services(random: Random, another: str, *, hidden: bool) -> tuple[str, dict[str, str]]:
    """Return a name for the service that is asked for, and others with their types: only its type tells it from them.

    A ``hidden`` name ends as the notebook's own list leaves out, although only the type counts.
    """
    # The graph tells of services in the order of their names: the right one is neither the first nor the last.
    first, *between, last = sorted(
        f"/{random.choice(_WORDS)}/{_number(random)}" for _ in range(random.choice(NAMES))
    )
    right = between.pop(random.randrange(len(between)))
    misleading = {f"{first}{HIDDEN}": ADDER, last: another}
    for name in between:
        misleading[f"{name}{random.choice(('', HIDDEN))}"] = random.choice((ADDER, another))
    return f"{right}{HIDDEN}" if hidden else right, misleading


def unserved(bench: Bench, type_name: str, others: Mapping[str, str]) -> None:
    """Make the run in which no service has the type."""
    if bench.keep(ABSENT):
        return
    patience = giving_up.drawn_patience(bench, PATIENCE_ELSEWHERE[bench.pace])
    bench.part(ABSENT, type=type_name, right="", others=dict(others), patience_sec=patience)
    _serve(bench, others)
    bench.start(type_name, patience_sec=patience)
    giving_up.await_it(bench)
    bench.stop()


def served(bench: Bench, name: str, service: Mapping[str, str], others: Mapping[str, str]) -> None:
    """One run in which there is one service of the type."""
    late = name == LATE
    right, type_name = next(iter(service.items()))
    # Another one comes as late, before it or after it: what is new is not right for that.
    comes_late = bench.random.sample([right, bench.random.choice(sorted(others))], 2) if late else []
    patience = giving_up.drawn_patience(bench, PATIENCE_IN_LATE if late else PATIENCE_ELSEWHERE[bench.pace])
    bench.part(name, type=type_name, right=right, others=dict(others), late=comes_late, patience_sec=patience)
    looks_for(bench, patience, lateness=LATENESS if late else 0.0)
    if late and not names_it(bench.seen()) and was_patient(bench.seen()):
        bench.again()
        looks_for(bench, patience, lateness=SOON)
    bench.stop()


def looks_for(bench: Bench, patience: float, *, lateness: float) -> None:
    """Start the subject, and let it find the service within its patience.

    Some services come so many seconds after the subject's node, if ``lateness`` is not 0.
    """
    inputs = bench.seen().inputs
    services = {**inputs["others"], inputs["right"]: inputs["type"]}
    _serve(bench, {name: kind for name, kind in services.items() if name not in inputs["late"]})
    bench.start(inputs["type"], patience_sec=patience)
    if lateness:
        bench.await_node()
        bench.run_time(lateness, until=lambda: len(bench.seen().of("looked")) >= LOOKS)
        if bench.await_end(0.0):
            return
        _serve(bench, {name: services[name] for name in inputs["late"]})
    if bench.wait_until(
        lambda evidence: evidence.main.ending is not None or names_it(evidence.main), FIND_LIMIT
    ):
        bench.await_end(0.5)


def _serve(bench: Bench, services: Mapping[str, str]) -> None:
    for service, type_name in services.items():
        bench.serve(service, type_name, lambda _: {})


def _number(random: Random) -> str:
    return f"s{random.randrange(10**5, 10**6)}"


# --- questions to the evidence -----------------------------------------------------------------------------


def named(part: Part) -> list[str]:
    """The services that it names as its answer: the last one that it names alone, or the end of what it lists."""
    services = [name for name in (part.inputs.get("right"), *part.inputs.get("others", {})) if name]
    found = [[name for name in services if _mentions(line, name)] for line in reversed(part.said())]
    alone = [names for names in found if len(names) == 1]
    return next(iter(alone or filter(None, found)), [])


def named_for_none(evidence: Evidence) -> list[str]:
    """The service that it names at the end where none has the type.

    A subject that reports that there is none may name what exists instead.
    """
    part = evidence.part(ABSENT)
    told = named(part)
    is_last = len(told) == 1 and _mentions(part.said()[-1], told[0])
    return told if is_last and not giving_up.NOT_AVAILABLE.lines(part) else []


def _mentions(line: str, service: str) -> bool:
    """True if a line has the name in it, with or without the slash in front."""
    return (
        re2.search(rf"(?:^|[^\pL\pN_/])/?{re2.escape(service.lstrip('/'))}(?:[^\pL\pN_/]|$)", line)
        is not None
    )


def names_it(part: Part) -> bool:
    """True if the right service is named, and no other one with it."""
    return bool(part.inputs.get("right")) and named(part) == [part.inputs["right"]]


def returns_it(part: Part) -> bool:
    """True if a notebook's function that named the right service has returned this name; a program returns nothing."""
    if part.returned is None:
        return True
    return part.returned.strip("'").lstrip("/") == part.inputs["right"].lstrip("/")


def gave_up_at_once(part: Part) -> bool:
    """True if the subject ended much too early, without the name of a service."""
    seen = part.first("interface")
    if part.ending is None or named(part):
        return False
    return seen is None or part.ending.t < seen.t + IMPATIENT


def _found(part: Part) -> Finding:
    expected = "the one service of the type that was asked for"
    if not names_it(part):
        return Finding(False, expected, ", ".join(named(part)) or _how_it_went(part))
    returned = returns_it(part)
    return Finding(
        returned, expected, part.inputs["right"] if returned else "named it, and did not return it"
    )


def _how_it_went(part: Part) -> str:
    if part.ending is None:
        return "named none, and never ended" if part.events else "not reached"
    return f"“{part.said()[-1]}”" if part.said() else "named none"


# --- what is asked, and known mistakes ----------------------------------------------------------------------

question = Draft(
    "inspecting_services.question",
    "Inspecting services · Find it by its type",
    "Find the service of a given type on the graph, and name it.",
    OwnLadder(
        scenario,
        *CRASHES,
        OWN,
        *OTHER_SLIPS,
        unfinished.USAGE_MESSAGE,
        OWN_LATE,
        *OTHER_CRASHES,
        *unfinished.NOTHING_THERE,
    ),
)
question.asks("late", 4, "Finds a service that comes late", lambda evidence: _found(evidence.part(LATE)))


@question.criterion("other", 3, "Finds a service of another type")
def finds_another(seen: Evidence, _: Evidence) -> Finding:
    """The subject finds the service that exists from the start, and not only because its first look happened to."""
    found = _found(seen.part(OTHER))
    if found.passed and gave_up_at_once(seen.part(LATE)):
        return Finding(False, found.expected, "it looks once, and what a first look finds is chance")
    return found


@question.criterion("none", 3, "Says so when there is none")
def says_that_there_is_none(seen: Evidence, _: Evidence) -> Finding:
    """Without such a service it ends by itself and says so."""
    part = seen.part(ABSENT)
    expected = f"says {giving_up.NOT_AVAILABLE} and ends by itself"
    if not names_it(seen.part(LATE)) and not finds_another(seen, seen).passed:
        # A subject that finds nothing in any run has not shown that it looked.
        return Finding(False, expected, "no other run shows that it finds a service")
    if part.ending and (wrong_ones := named_for_none(seen)):
        return Finding(False, expected, f"named {', '.join(wrong_ones)}")
    wrong = giving_up.objection(part, found_in(seen))
    it_did = "says again and again that it looks" if giving_up.goes_on_waiting(part) else "it did"
    return Finding(not wrong, expected, wrong or it_did)


def found_in(seen: Evidence) -> list[Part]:
    """The run with a service from the start, if it found that."""
    return [other for other in [seen.part(OTHER)] if names_it(other)]


def not_written(seen: Evidence, _: Evidence) -> bool:
    """The function returns nothing, at once, for every type."""
    runs = [seen.part(name) for name in (LATE, OTHER, ABSENT)]
    return not any(part.said() or part.traceback for part in runs) and gave_up_at_once(runs[0])


question.knows(
    "not_written",
    not_written,
    "Your function comes back at once and names no service.",
    unfinished.STEP_MISSING,
    certain=True,
    before="syntax_error",
)


@question.mistake("wrong_service", certain=True)
def wrong_service(seen: Evidence, _: Evidence) -> Advice | None:
    """The subject names a service of another type, or only a part of the right one's name."""
    for name in (LATE, OTHER):
        end = seen.part(name).inputs.get("right", "").rpartition("/")[2]
        if end and not named(seen.part(name)) and end in " ".join(seen.part(name).said()[-1:]):
            return Advice(
                f"Your answer, {end}, is only a part of the name {seen.part(name).inputs['right']}.",
                "Return the whole name, with all its slashes, as get_service_names_and_types() gives it.",
            )
    for part in seen:
        told = named_for_none(seen) if part.name == ABSENT else named(part)
        others = [name for name in told if name != part.inputs["right"]]
        if others:
            return Advice(
                f"You were asked for a service of the type {part.inputs['type']}. Your answer, {others[0]}, is of "
                f"the type {part.inputs['others'][others[0]]}.",
                "Compare each service's whole type, package included, with the type_name that you are given. The name "
                "of a service says nothing about its type.",
            )
    return None


question.knows(
    "name_filtered",
    lambda seen, _: (
        names_it(seen.part(LATE)) and (other := seen.part(OTHER)).ending and not named(other) and other.inputs
    ),
    "Your code finds a service that comes late, but not {0[right]}, which is of the type {0[type]} and was there from "
    "the start.",
    "Does it leave out services by their names, as the demonstration does with “parameter”? Only the type counts.",
)
question.knows(
    "not_returned",
    lambda seen, _: next((part for part in seen if names_it(part) and not returns_it(part)), None),
    "Your function found {0.inputs[right]}, but what it returns is {0.returned}: code that calls it cannot go on with "
    "the name.",
    "End your function with `return` and the name itself, as get_service_names_and_types() gives it.",
    certain=True,
)


def _crashed(part: Part) -> bool:
    """True if it ended with an error; what it raises on purpose is an answer, and a TimeoutError above all."""
    return bool(part.traceback) and "TimeoutError" not in part.traceback and not meant(part.traceback)


question.knows(
    "looked_once",
    lambda seen, _: gave_up_at_once(seen.part(LATE)) and not _crashed(seen.part(LATE)),
    "You looked only once. A new node knows almost nothing of the graph, and a service may start later "
    "than your function.",
    "Look again and again, with a short pause, until the service is there or patience_sec seconds have passed.",
    certain=True,
)


def type_never_matches(seen: Evidence, _: Evidence) -> bool:
    """The subject looks long enough but does not find the existing service."""
    runs = [seen.part(LATE), seen.part(OTHER)]
    looked = not gave_up_at_once(runs[0]) and all(part.events for part in runs)
    return looked and not any(named(part) or _crashed(part) for part in runs)


question.knows(
    "type_never_matches",
    type_never_matches,
    "The service was on the graph, and you looked, but never found it.",
    "get_service_names_and_types() gives pairs of a name and a *list* of types, each written like "
    "std_srvs/srv/Empty. Ask with `type_name in types`.",
)


question.knows(
    "waits_forever",
    lambda seen, _: giving_up.waits_in_silence(seen.part(ABSENT)),
    "When no service has the type, you look for it without end.",
    "Note the time at the start (time.monotonic()), and raise TimeoutError when patience_sec seconds have passed.",
    late=True,
)


@question.mistake("silent_end", certain=True, late=True)
def silent_end(seen: Evidence, _: Evidence) -> Advice | None:
    """Without such a service the subject ends, and does not report that."""
    return giving_up.silent_end(seen.part(ABSENT), found_in(seen), "service")


question.knows(
    "patience_not_kept",
    lambda seen, _: giving_up.broken_patience(seen.part(ABSENT)),
    "When no service has the type, your function {}.",
    "Note the time at the start, give_up_at = time.monotonic() + patience_sec, and look until that moment.",
    late=True,
)


EXERCISE = question.exercise(
    limit=90.0,
    arguments="the type of a service, such as std_srvs/srv/Empty",
    sample_arguments=(ADDER,),
    remarks=(giving_up.remark(ABSENT),),
    text={
        "compare the whole type, package included": "other",
        "returns the name as soon as it sees a service of the type": "late other",
        "it raises `TimeoutError`, with a message that contains `not available`.": "none",
        "you may also raise another exception, or log a line that contains `not available` and return `None`.": "none",
        "it must say `not available` and end within 12 seconds, or say at least every three seconds": "none",
    },
)
