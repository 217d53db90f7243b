"""docs/exercise-reference.md names every kind of event that a judge writes down, and every mistake that it promises."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from autograder.kit.recipes.action_server import SendsGoals
from autograder.kit.recipes.own_scenario import OwnScenario
from autograder.kit.recipes.publisher import Hears
from autograder.kit.recipes.service_server import Asks

if TYPE_CHECKING:
    from autograder.kit.draft import Recipe

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/exercise-reference.md").read_text(encoding="utf-8")
WRITTEN = re.compile(r"""\b(?:_?record|_note|end|ended)\(\s*"(\w+)",""")
RECIPES: dict[str, Recipe[Any]] = {
    "OwnScenario": OwnScenario(
        lambda _: None,
        "publisher",
        "subscription",
        "client",
        "service",
        "action_client",
        "action_server",
    ),
    "Hears": Hears(messages=8, long_run=20),
    "Asks": Asks(lambda _: [], lambda _: {}),
    "SendsGoals": SendsGoals(lambda _: None, good=lambda _: [], canceled=lambda _: None),  # type: ignore[arg-type,return-value]
}


def row(name: str) -> str:
    (found,) = re.findall(rf"^\| `{name}`.*$", PAGE, re.MULTILINE)
    return str(found)


def test_each_kind_of_event_is_in_the_table() -> None:
    files = [
        file for part in ("bench", "subjects") for file in (ROOT / "autograder/judge" / part).rglob("*.py")
    ]
    kinds = {kind for file in files for kind in WRITTEN.findall(file.read_text(encoding="utf-8"))}
    assert len(kinds) > 25
    listed = "\n".join(re.findall(r"^\| (`.*)$", PAGE, re.MULTILINE))
    assert [kind for kind in sorted(kinds) if f"`{kind}`" not in listed] == []


@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_has_the_mistakes_that_the_page_promises(name: str) -> None:
    keys = {mistake.key for mistake in RECIPES[name].ladder}
    everywhere = PAGE.partition("All recipes know")[2].partition("\n\n")[0]
    promised = set(re.findall(r"`([a-z_]+)`", row(name).partition("|")[2].partition("|")[2] + everywhere))
    assert promised - keys == set()
    assert len(promised) > 10
