"""Inspecting services: a function that finds a service by its type, as `ros2 service find` does.

The judge serves. The names are drawn anew each time, one service carries a tempting name and another type, one comes
late, and once there is none of the type.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from autograder.exercises import common_mistakes as common
from autograder.exercises.model import Advice, Bench, Criterion, Exercise, Finding, Mistake

if TYPE_CHECKING:
    from collections.abc import Mapping
    from random import Random

    from autograder.exercises.evidence import Evidence, Part

ADDER = "my_robot_interfaces/srv/AddTwoInts"
SWITCH = "std_srvs/srv/SetBool"
RESET = "std_srvs/srv/Empty"
TRIGGER = "std_srvs/srv/Trigger"

LATE = "the service comes late"
OTHER = "another type is asked for"
ABSENT = "no service has the type"

LATENESS = 2.0
"""Seconds at most for which the subject's node is on the graph before the late service is: longer than a busy machine
needs for a single look, and well below the 5 s for which the task says to wait."""
LOOKS = 4
"""Looks at the graph after which a subject is sure to look again: the service need not be any later for that one."""
IMPATIENT = 3.0
"""Seconds after which nobody who looked for a while has given up; on a busy machine a single look may take one."""
FIND_LIMIT = 12.0
"""Seconds of wall time in which a subject must have found a service that is there."""
GIVE_UP_LIMIT = 12.0
"""Seconds in which it must have ended when there is none; the task says 5."""
SHORT_PATIENCE = 0.3
"""Seconds that a notebook's function is told to look where there is nothing to be found."""

_WORDS = ("kitchen", "garage", "tower", "harbour", "meadow", "attic", "bridge", "cellar", "garden", "forge")


def scenario(bench: Bench) -> None:
    """Three runs: a late service, one of another type, and none at all."""
    random = bench.random
    # No type is asked for after it was served in an earlier run: the graph forgets with a delay.
    served(bench, LATE, ADDER, {"/add_two_ints": SWITCH, _name(random): SWITCH}, late=True)
    served(bench, OTHER, RESET, {_name(random): ADDER, _name(random): SWITCH}, late=False)
    others = {_name(random): ADDER, _name(random): SWITCH}
    if bench.keep(ABSENT):
        return
    bench.part(ABSENT, type=TRIGGER, right="", others=others)
    _serve(bench, others)
    bench.start(TRIGGER, patience_sec=SHORT_PATIENCE)
    bench.await_end(GIVE_UP_LIMIT)
    bench.stop()


def served(bench: Bench, name: str, type_name: str, others: Mapping[str, str], *, late: bool) -> None:
    """One run in which there is one service of the type."""
    right = _name(bench.random)
    bench.part(name, type=type_name, right=right, others=dict(others))
    _serve(bench, others)
    if not late:
        _serve(bench, {right: type_name})
    bench.start(type_name)
    if late:
        bench.await_node()
        bench.wait_until(lambda evidence: len(evidence.main.of("looked")) >= LOOKS, LATENESS)
        if bench.await_end(0.0):
            bench.stop()
            return
        _serve(bench, {right: type_name})
    if bench.wait_until(
        lambda evidence: evidence.main.ending is not None or names_it(evidence.main), FIND_LIMIT
    ):
        bench.await_end(0.5)
    bench.stop()


def _serve(bench: Bench, services: Mapping[str, str]) -> None:
    for service, type_name in services.items():
        bench.serve(service, type_name, lambda _: {})


def _name(random: Random) -> str:
    return f"/{random.choice(_WORDS)}/s{random.randrange(10**5, 10**6)}"


# --- questions to the evidence -----------------------------------------------------------------------------


def named(part: Part) -> list[str]:
    """The services of this run that the last line with any of them names."""
    services = [name for name in (part.inputs.get("right"), *part.inputs.get("others", {})) if name]
    for line in reversed(part.said()):
        found = [name for name in services if _mentions(line, name)]
        if found:
            return found
    return []


def _mentions(line: str, service: str) -> bool:
    """Whether a line has the name in it, with or without the slash in front."""
    return re.search(rf"(?<![\w/])/?{re.escape(service.lstrip('/'))}(?![\w/])", line) is not None


def names_it(part: Part) -> bool:
    """Whether the right service is named, and no other one with it."""
    return bool(part.inputs.get("right")) and named(part) == [part.inputs["right"]]


def gave_up_at_once(part: Part) -> bool:
    """Whether the subject ended without the late service, and much too early."""
    seen = part.first("interface")
    if part.ending is None or names_it(part):
        return False
    return seen is None or part.ending.t < seen.t + IMPATIENT


def finds_the_late_one(evidence: Evidence) -> Finding:
    """It goes on looking until the service is there."""
    return _found(evidence.part(LATE))


def finds_the_other_type(evidence: Evidence) -> Finding:
    """It looks for the type that it is given."""
    return _found(evidence.part(OTHER))


def _found(part: Part) -> Finding:
    expected = "the one service of the type that was asked for"
    if names_it(part):
        return Finding(True, expected, part.inputs["right"])
    return Finding(False, expected, ", ".join(named(part)) or _how_it_went(part))


def says_that_there_is_none(evidence: Evidence) -> Finding:
    """Without such a service it ends by itself and says so."""
    part = evidence.part(ABSENT)
    expected = "says so and ends by itself"
    if not any(names_it(evidence.part(name)) for name in (LATE, OTHER)):
        # What finds nothing anywhere has not shown that it looked.
        return Finding(False, expected, "found no service in the other runs")
    if part.ending is None:
        return Finding(False, expected, f"still looking after {GIVE_UP_LIMIT:g} s")
    said = part.said()
    if said and any(_mentions(said[-1], name) for name in part.inputs["others"]):
        return Finding(False, expected, f"named {', '.join(named(part))}")
    told = bool(said) or bool(part.traceback) or part.ending.name == "raised"
    return Finding(told, expected, "it did" if told else "ended without a word")


def _how_it_went(part: Part) -> str:
    if part.ending is None:
        return "named none, and never ended" if part.events else "not reached"
    if "TimeoutError" in part.traceback:
        return "gave up"
    return f"“{part.said()[-1]}”" if part.said() else "named none"


# --- known mistakes ----------------------------------------------------------------------------------------


def not_written(evidence: Evidence) -> Advice | None:
    """It comes back at once, with nothing, whatever it is asked."""
    runs = [evidence.part(name) for name in (LATE, OTHER, ABSENT)]
    if any(part.said() or part.traceback for part in runs):
        return None
    if not gave_up_at_once(runs[0]):
        return None
    return Advice(
        "Your function comes back at once and names no service.",
        "Find the TODO in your solution cell and write that step; the hints below it open one at a time.",
    )


def wrong_service(evidence: Evidence) -> Advice | None:
    """It names a service of another type."""
    for part in evidence:
        others = [name for name in named(part) if name != part.inputs["right"]]
        if others:
            return Advice(
                f"You were asked for a service of the type {part.inputs['type']} and named {others[0]}, which is a "
                f"{part.inputs['others'][others[0]]}.",
                "Compare each service's type with the type_name that you are given. The name of a service says nothing "
                "about its type.",
            )
    return None


def _crashed(part: Part) -> bool:
    """Whether it ended with an error; a TimeoutError is an answer."""
    return bool(part.traceback) and "TimeoutError" not in part.traceback


def looked_once(evidence: Evidence) -> Advice | None:
    """It has given up before the late service was there."""
    part = evidence.part(LATE)
    if not gave_up_at_once(part) or _crashed(part):
        return None
    return Advice(
        "You looked once, at once. A node that was just made knows hardly anything of the graph, and a service may "
        "start later than whoever looks for it.",
        "Look again and again, with a short pause, until the service is there or patience_sec seconds have passed.",
    )


def type_never_matches(evidence: Evidence) -> Advice | None:
    """It looks long enough and finds nothing, although it is there."""
    runs = [evidence.part(LATE), evidence.part(OTHER)]
    if gave_up_at_once(runs[0]):
        return None
    if any(named(part) for part in runs) or not all(part.events for part in runs):
        return None
    if any(map(_crashed, runs)):
        return None
    return Advice(
        "The service was on the graph, and you looked, but never found it.",
        "get_service_names_and_types() gives pairs of a name and a *list* of types, each written like "
        "std_srvs/srv/Empty. Ask with `type_name in types`.",
    )


def waits_forever(evidence: Evidence) -> Advice | None:
    """Without such a service it never ends."""
    part = evidence.part(ABSENT)
    if not part.events or part.ending is not None:
        return None
    return Advice(
        "When no service has the type, you look for it without end.",
        "Note the time at the start (time.monotonic()), and raise TimeoutError when patience_sec seconds have passed.",
    )


def silent_end(evidence: Evidence) -> Advice | None:
    """Without such a service it ends, and says nothing."""
    if says_that_there_is_none(evidence).seen != "ended without a word":
        return None
    return Advice(
        "When no service has the type, you end without a word.",
        "Raise TimeoutError, with a few words on what was not found.",
    )


EXERCISE = Exercise(
    id="inspecting_services.question",
    title="Inspecting services · Find it by its type",
    task="Find the service of a given type on the graph, and name it.",
    scenario=scenario,
    criteria=(
        Criterion("late", "Finds a service that comes late", 4, finds_the_late_one),
        Criterion("other", "Finds a service of another type", 3, finds_the_other_type),
        Criterion("none", "Says so when there is none", 3, says_that_there_is_none),
    ),
    mistakes=(
        Mistake("not_written", not_written, certain=True),
        *common.CRASHES,
        Mistake("wrong_service", wrong_service, certain=True),
        Mistake("looked_once", looked_once, certain=True),
        Mistake("type_never_matches", type_never_matches),
        *common.OTHER_CRASHES,
        Mistake("waits_forever", waits_forever),
        Mistake("silent_end", silent_end, certain=True),
        *common.NOTHING_THERE,
    ),
    roles=(),
    limit=90.0,
    arguments="the type of a service, such as std_srvs/srv/Empty",
    sample_arguments=(ADDER,),
)
