"""The modules with which exercises are written: the model, the evidence, recipes, and common rules and mistakes.

Promises: an exercise reads like its specification; neither ROS nor the judge is imported, so that evidence is judged
    without them.
Names: ``model.Exercise``, ``bench.Bench``, ``evidence.Evidence``, ``draft.Draft``,
    ``oracle.same_as_solution.SameAsSolution``, ``mission.mission.Mission``, ``quests.quest.Quest``,
    ``hunts.ticket.Ticket``
Imports: ``course``, ``known_errors``, ``messages``, ``packed_files``, ``robot``, ``verdict``.
Takes: what an author declares: inputs, outputs, worlds, mistakes.
Gives: an ``Exercise``: a scenario for the bench, and criteria and mistakes, which are functions of evidence.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from autograder.kit.counterparts import Qos, Work
    from autograder.kit.draft import Draft
    from autograder.kit.evidence import Evidence, Part
    from autograder.kit.mission.mission import Mission, Moment, Pose, Wall, World
    from autograder.kit.model import Advice, Criterion, Finding, Mistake, mistake, unless
    from autograder.kit.oracle.drawings import dealt, drawn_until, levels, mixed, scans, shuffled
    from autograder.kit.oracle.returns import Returns
    from autograder.kit.oracle.same_as_solution import Goal, SameAsSolution, Sets, To
    from autograder.kit.oracle.steps import Text
    from autograder.kit.oracle.tool_user import ToolUser
    from autograder.kit.quests.quest import Quest, Searches
    from autograder.kit.quests.robot import Robot
    from autograder.kit.recipes.launch_file import LaunchFile
    from autograder.kit.recipes.own_scenario import OwnScenario
    from autograder.kit.recipes.program import Program
    from autograder.kit.recipes.publisher import Publisher
    from autograder.kit.recipes.servers import Asks
    from autograder.kit.recipes.service_client import Calls
    from autograder.kit.recipes.service_type import ServiceType
    from autograder.kit.recipes.subscriber import Subscriber

_PLACES = {
    "counterparts": ("Qos", "Work"),
    "draft": ("Draft",),
    "evidence": ("Evidence", "Part"),
    "mission.mission": ("Mission", "Moment", "Pose", "Wall", "World"),
    "model": ("Advice", "Criterion", "Finding", "Mistake", "mistake", "unless"),
    "oracle.drawings": ("dealt", "drawn_until", "levels", "mixed", "scans", "shuffled"),
    "oracle.returns": ("Returns",),
    "oracle.same_as_solution": ("Goal", "SameAsSolution", "Sets", "To"),
    "oracle.steps": ("Text",),
    "oracle.tool_user": ("ToolUser",),
    "quests.quest": ("Quest", "Searches"),
    "quests.robot": ("Robot",),
    "recipes.launch_file": ("LaunchFile",),
    "recipes.own_scenario": ("OwnScenario",),
    "recipes.program": ("Program",),
    "recipes.publisher": ("Publisher",),
    "recipes.servers": ("Asks",),
    "recipes.service_client": ("Calls",),
    "recipes.service_type": ("ServiceType",),
    "recipes.subscriber": ("Subscriber",),
}
"""The modules of the names that authors use, which are documented in docs/kit.md. Each is imported at its first use."""
_MODULES = {name: f"{__name__}.{module}" for module, names in _PLACES.items() for name in names}
__all__ = [
    "Advice",
    "Asks",
    "Calls",
    "Criterion",
    "Draft",
    "Evidence",
    "Finding",
    "Goal",
    "LaunchFile",
    "Mission",
    "Mistake",
    "Moment",
    "OwnScenario",
    "Part",
    "Pose",
    "Program",
    "Publisher",
    "Qos",
    "Quest",
    "Returns",
    "Robot",
    "SameAsSolution",
    "Searches",
    "ServiceType",
    "Sets",
    "Subscriber",
    "Text",
    "To",
    "ToolUser",
    "Wall",
    "Work",
    "World",
    "dealt",
    "drawn_until",
    "levels",
    "mistake",
    "mixed",
    "scans",
    "shuffled",
    "unless",
]


def __getattr__(name: str) -> Any:
    """Return what an author asks for by name, such as ``SameAsSolution``."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_MODULES[name]), name)
