"""Inspecting services: a function that finds a service by its type, as `ros2 service find` does.

The judge serves. The names, the types that the task asks for and the order of the runs are random. Only the type
distinguishes the right service from the others: one of these has a tempting name, one comes as late as the late one,
some have a type of the same name in another package, and in one run no service has the type.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.kit import Draft, Quest, Robot, giving_up

if TYPE_CHECKING:
    from collections.abc import Mapping
    from random import Random

    from autograder.kit import Searches

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
WORDS = ("kitchen", "garage", "tower", "harbour", "meadow", "attic", "bridge", "cellar", "garden", "forge")

LATE = "the service comes late"
OTHER = "another type is asked for"
ABSENT = "no service has the type"


def robots(random: Random) -> dict[str, Robot]:
    """Draw three robots, and their order: a late service, one of another type, and none at all."""
    # The type with a twin is asked for in the same run of each check, so a subject that takes the twin always loses the
    # same points.
    others = random.sample(sorted(TEMPTING.keys() - TWIN.keys()), 2)
    kinds = dict(zip((LATE, ABSENT, OTHER), (*others, *TWIN), strict=True))
    return {name: robot(random, name, kinds) for name in random.sample(list(kinds), len(kinds))}


def robot(random: Random, name: str, kinds: Mapping[str, str]) -> Robot:
    """Draw a robot: only its type tells the service that is asked for from the others."""
    kind = kinds[name]
    another = random.choice([other for other in kinds.values() if other != kind])

    def service(word: str) -> str:
        return f"/{word}/s{random.randrange(10**5, 10**6)}"

    # The graph tells of services in the order of their names: the right one is neither the first nor the last.
    first, *between, last = sorted(service(random.choice(WORDS)) for _ in range(random.choice(NAMES)))
    # A name may end as the notebook's own list leaves out, although only the type counts.
    right = between.pop(random.randrange(len(between))) + HIDDEN * (name == OTHER)
    # Of the lab's own type in each run, so that who always looks for that one is wrong in each.
    services = {f"{first}{HIDDEN}": ADDER, last: another, TEMPTING[kind]: ADDER}
    services |= {f"{n}{random.choice(('', HIDDEN))}": random.choice((ADDER, another)) for n in between}
    services |= {service(word): TWIN[kind] for word in TWINS if kind in TWIN}
    if name == ABSENT:
        return Robot(asked=(kind,), services={**services, right: another})
    # Another one comes as late, before it or after it: what is new is not right for that.
    late = random.sample([right, random.choice(sorted(services))], 2) if name == LATE else []
    return Robot(asked=(kind,), answer={"name": right}, services={**services, right: kind}, late=late)


quest = Quest(robots, "service")
question = Draft(
    "inspecting_services.question",
    "Inspecting services · Find it by its type",
    "Find the service of a given type on the graph, and name it.",
    quest,
)
question.asks("late", "Finds a service that comes late", quest.finds(robot=LATE), points=4)
question.asks("other", "Finds a service of another type", quest.finds(robot=OTHER), points=3)
question.asks("none", "Says so when there is none", quest.says_that_there_is_none, points=3)


def part_of_its_name(seen: Searches, _: Searches) -> str:
    """Return the right name, if the subject gives only the end of it."""
    for search in seen.values():
        right, said = search.robot.answer.get("name", ""), " ".join(search.part.said()[-1:])
        if right and not search.given and right.rpartition("/")[2] in said:
            return right
    return ""


def of_another_type(seen: Searches, _: Searches) -> tuple[str, str, str] | None:
    """Return the type that was asked for, and a service of another type that the subject gives as its answer."""
    wrong = ((search, name) for search in seen.values() for name in search.astray)
    return next(((search.robot.asked[0], name, search.names[name]) for search, name in wrong), None)


question.knows(
    "wrong_service",
    part_of_its_name,
    "Your answer is only a part of the name {}.",
    "Return the whole name, with all its slashes, as get_service_names_and_types() gives it.",
    certain=True,
)
question.knows(
    "wrong_service",
    of_another_type,
    "You were asked for a service of the type {0[0]}. Your answer, {0[1]}, is of the type {0[2]}.",
    "Compare each service's whole type, package included, with the type_name that you are given. The name of a "
    "service says nothing about its type.",
    certain=True,
)
question.knows(
    "name_filtered",
    lambda seen, _: (
        seen[LATE].has() and seen[OTHER].part.ending and not seen[OTHER].given and seen[OTHER].robot
    ),
    "Your code finds a service that comes late, but not {0.answer[name]}, which is of the type {0.asked[0]} and was "
    "there from the start.",
    "Does it leave out services by their names, as the demonstration does with “parameter”? Only the type counts.",
)


def type_never_matches(seen: Searches, _: Searches) -> bool:
    """The subject looks long enough but does not find the existing service."""
    looked = seen[OTHER].part.events and seen[LATE].part.events and not seen[LATE].gave_up_at_once
    return bool(looked) and not seen[OTHER].given and not seen[LATE].given


question.knows(
    "type_never_matches",
    type_never_matches,
    "The service was on the graph, and you looked, but never found it.",
    "get_service_names_and_types() gives pairs of a name and a *list* of types, each written like "
    "std_srvs/srv/Empty. Ask with `type_name in types`.",
    before="waits_forever",
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
    },
    counts={
        "late": "How soon is not graded.",
        "none": giving_up.COUNTS,
    },
)
