"""The base of the recipes for action clients: their common mistakes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.kit.draft import SeenAsItIs
from autograder.kit.goal_reports import WAIT
from autograder.kit.lateness import called_too_early
from autograder.kit.mistakes import common_mistakes as common
from autograder.kit.mistakes import goal_mistakes as goals
from autograder.kit.mistakes import unfinished
from autograder.kit.mistakes.crashes import CRASHES, OTHER_CRASHES, OTHER_SLIPS

if TYPE_CHECKING:
    from collections.abc import Callable

    from autograder.kit.bench import Bench
    from autograder.kit.evidence import Evidence
    from autograder.kit.model import Advice, Mistake


def _not_by_refusal(mistake: Mistake) -> Mistake:
    """Return the mistake, but do not recognize it if the client crashes only in the run with a refused goal."""

    def recognize(evidence: Evidence) -> Advice | None:
        return None if goals.crashed_by_refusal(evidence) else mistake.recognize(evidence)

    return replace(mistake, recognize=recognize)


class ActionClient(SeenAsItIs):
    """The recipe for an action client. Its criteria get the whole evidence, because several runs have a goal.

    The recipe recognizes the mistakes ``called_too_early``, ``action_name``, ``message_type``, ``main_guard``,
    ``nothing_on_the_graph``, ``ended_too_early``, and the mistakes that you give it.

    Args:
        scenario: The function that runs all parts of the exercise on a bench. The action's name and type are
            ``bench.reference.only("action_client")``.
        ladder: The mistakes of the exercise, most specific first. They are checked after mistakes that prevent any
            right goal, and before mistakes that are checked only if nothing more specific is recognized.

    Example::

        def scenario(bench: Bench) -> None:
            bench.part("one goal")
            server = bench.serve_action(*bench.reference.only("action_client"))
            bench.start()
            bench.release()
            if server.await_goal(15.0) and server.await_result_request(8.0):
                server.finish("succeeded", sequence=[0, 1, 1, 2])
                bench.await_end(1.0)
            bench.stop()

        recipe = ActionClient(scenario, goals.RESULT_NOT_REPORTED)
    """

    roles = ("action_client",)

    def __init__(self, scenario: Callable[[Bench], None], *ladder: Mistake) -> None:
        self.scenario = scenario
        self.ladder = (
            WAIT.the_wrong_way_round(),
            *map(_not_by_refusal, CRASHES),
            called_too_early("sent its goal", "wait_for_server"),
            common.endpoint_name("action_client"),
            common.message_type("action_client"),
            *map(_not_by_refusal, OTHER_SLIPS),
            goals.ORDER_NEVER_FILLED,
            *ladder,
            *OTHER_CRASHES,
            *unfinished.NOTHING_THERE,
        )
