"""The known mistakes of each role, and the order in which all of a node's mistakes are checked.

A recipe states its roles and adds only what it alone can recognize, so an author's own scenario has the same mistakes
as a recipe. What a build or a launch brings is in :mod:`.runner_mistakes`.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from autograder.kit.draft import OWN, OWN_LATE
from autograder.kit.lateness import called_too_early
from autograder.kit.mistakes import action_server_mistakes as execute
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES
from autograder.kit.mistakes.hangs import ENDLESS_LOOP, HANGS
from autograder.kit.mistakes.silence import SECOND_NODE, never_published
from autograder.kit.model import Mistake

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence


class Stage(Enum):
    """When a role's mistakes are checked."""

    FIRST = "they explain everything else"
    NAMED = "no other node can be connected"
    JOINED = "both nodes use the name, and yet nothing arrives"
    RAISED = "a callback raised an exception that the table of known errors does not contain"
    WORKING = "the node works, and does something wrong"
    UNSPUN = "nothing runs the node's callbacks"
    SILENT = "nothing else is wrong, and nothing comes"


_Stages = dict[Stage, tuple[Mistake, ...]]
_ONLY: dict[str, _Stages] = {
    "publisher": {
        Stage.FIRST: (common.INT_IN_A_FLOAT,),
        Stage.JOINED: (common.qos_mismatch("publisher"),),
        Stage.SILENT: (never_published(),),
    },
    "subscription": {Stage.JOINED: (common.qos_mismatch("subscription"),)},
    "service": {
        Stage.FIRST: (
            common.two_servers(
                "service",
                "Each call reaches both servers, and the quicker one answers.",
                "Call create_service only once, and make only one node.",
            ),
        ),
    },
    "action_server": {
        Stage.FIRST: (
            common.two_servers(
                "action_server",
                "Each goal reaches both servers, and both execute it.",
                "Make only one ActionServer and only one node.",
            ),
            execute.RESULT_MISSING,
        ),
        Stage.RAISED: (execute.EXCEPTION_IN_EXECUTE,),
        Stage.WORKING: (execute.CANCEL_REFUSED,),
    },
    "client": {Stage.FIRST: (called_too_early("called the service", "wait_for_service"),)},
    "action_client": {Stage.FIRST: (called_too_early("sent its goal", "wait_for_server"),)},
}
BY_ROLE: Mapping[str, Mapping[Stage, Sequence[Mistake]]] = {
    role: only
    | {
        Stage.NAMED: (common.endpoint_name(role), common.message_type(role)),
        Stage.UNSPUN: (common.never_spun(role), common.went_deaf(role)),
    }
    for role, only in _ONLY.items()
}
"""The mistakes of each role, by the stage at which they are checked."""


def ladder(
    roles: Iterable[str],
    *,
    first: Sequence[Mistake] = (),
    named: Sequence[Mistake] = (OWN,),
    working: Sequence[Mistake] = (),
    late: Sequence[Mistake] = (OWN_LATE,),
) -> tuple[Mistake, ...]:
    """Return all known mistakes of a node with these roles, in the order in which they are checked.

    The other arguments are what a recipe adds, with the placeholders for the mistakes of an exercise.

    Args:
        roles: The roles of the node's endpoints.
        first: Mistakes that are checked before crashes.
        named: Mistakes of a node whose names and types are right.
        working: Mistakes of a node that raises no exception.
        late: Mistakes that a node that hangs or is not spun would show, too.
    """
    # A role may be given for each of several programs.
    of = [BY_ROLE[role] for role in dict.fromkeys(roles)]
    at = {stage: [one for stages in of for one in stages.get(stage, ())] for stage in Stage}
    return (
        *at[Stage.FIRST],
        *first,
        *CRASHES,
        ENDLESS_LOOP,
        unfinished.NEVER_CONSTRUCTED,
        *at[Stage.NAMED],
        *named,
        *at[Stage.JOINED],
        *at[Stage.RAISED],
        *OTHER_CRASHES,
        *at[Stage.WORKING],
        *working,
        *HANGS,
        common.AWAITS_IN_VAIN,
        *at[Stage.UNSPUN],
        *late,
        SECOND_NODE,
        *at[Stage.SILENT],
        *unfinished.NOTHING_THERE,
    )
