"""docs/exercise-reference.md names every kind of event, and recipes have the mistakes that their help promises."""

from __future__ import annotations

import inspect
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.mistakes.runner_mistakes import with_those_of
from autograder.kit.oracle.action_server import SendsGoals
from autograder.kit.oracle.goals_seen import GoalsSeen
from autograder.kit.quests.quest import Quest
from autograder.kit.recipes.action_client import ActionClient
from autograder.kit.recipes.launch_file import LaunchFile
from autograder.kit.recipes.own_scenario import OwnScenario
from autograder.kit.recipes.program import Program
from autograder.kit.recipes.publisher import Publisher
from autograder.kit.recipes.servers import Asks
from autograder.kit.recipes.service_client import Calls
from autograder.kit.recipes.service_type import ServiceType
from autograder.kit.recipes.subscriber import Subscriber

if TYPE_CHECKING:
    from autograder.kit.draft import Recipe

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/exercise-reference.md").read_text(encoding="utf-8")
WRITTEN = re.compile(r"""\b(?:_?record|_note|end|ended)\(\s*"(\w+)",""")
HEARS = Publisher()
HEARS.says_text()
HEARS.counts()
RECIPES: dict[str, Recipe[Any]] = {
    "OwnScenario": OwnScenario(
        lambda _: None, "publisher", "subscription", "client", "service", "action_client", "action_server"
    ),
    "Publisher": HEARS,
    "Subscriber": Subscriber(pace=0.5, paced_by="a timer"),
    "Asks": Asks(lambda _: [], lambda _: {}),
    "Calls": Calls(1, wanted=""),
    "SendsGoals": SendsGoals(lambda _: None, lambda seen: GoalsSeen(seen, [], [], [], [], [], [], [], None)),
    "ActionClient": ActionClient(lambda _: None),
    "Program": Program("my_robot_pkg", "simple_node", "a program"),
    "LaunchFile": LaunchFile("my_robot_pkg", "/chatter"),
    "ServiceType": ServiceType("srv/AddTwoInts.srv", "my_robot_interfaces"),
    "Quest": Quest(lambda _: {}),
}
NODES = ["OwnScenario", "Publisher", "Subscriber", "Asks", "Calls", "SendsGoals"]
"""The recipes for nodes, which also recognize one that does nothing."""


def test_each_kind_of_event_is_in_the_table() -> None:
    files = (ROOT / "autograder/judge").rglob("*.py")
    kinds = {kind for file in files for kind in WRITTEN.findall(file.read_text(encoding="utf-8"))}
    assert len(kinds) > 25
    listed = "\n".join(re.findall(r"^\| (`.*)$", PAGE, re.MULTILINE))
    assert [kind for kind in sorted(kinds) if f"`{kind}`" not in listed] == []


@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_has_the_mistakes_that_its_help_and_the_page_promise(name: str) -> None:
    recipe = RECIPES[name]
    keys = {mistake.key for mistake in with_those_of(getattr(recipe, "runner", None), recipe.ladder)}
    in_all, in_nodes = (
        paragraph("All recipes also recognize"),
        paragraph("also recognize a node that does nothing"),
    )
    promise = (
        (inspect.getdoc(type(recipe)) or "").partition("recognizes the mistakes")[2].partition("\n\n")[0]
    )
    own = set(re.findall(r"``([a-z_]+)``", promise))
    promised = own | keys_in(in_all) | (keys_in(in_nodes) if name in NODES else set())
    assert promised - keys == set()
    assert len(keys_in(in_all)) >= 5
    assert len(own) >= 4


def paragraph(beginning: str) -> str:
    return PAGE.partition(beginning)[2].partition("\n\n")[0]


def keys_in(text: str) -> set[str]:
    return set(re.findall(r"`([a-z_]+)`", text))


def test_the_page_names_the_recipes_of_nodes() -> None:
    before = PAGE.partition(" also recognize a node that does nothing")[0].rpartition("\n\n")[2]
    assert re.findall(r"`(\w+)`", before) == NODES
