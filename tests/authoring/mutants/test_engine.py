"""What mutants are made of a program: each once, under a key that unrelated edits leave alone."""

from __future__ import annotations

import ast
from typing import Any

import pytest

from autograder.authoring.mutants import engine
from autograder.authoring.mutants.code import Code, Edit
from autograder.authoring.mutants.engine import Mutant, in_all_places, mutants, python_changes
from tests.cases import cases

HANDS = cases(__file__, "HANDS")


def made(text: str = HANDS) -> list[Mutant]:
    changes = python_changes(Code(text))
    return mutants(text, [*changes, *in_all_places(changes)])


def lines(operator: str, kind: str = "") -> list[str]:
    """Return the changed lines of the mutants of an operator."""
    return [
        one.text.splitlines()[one.line - 1].strip()
        for one in made()
        if one.operator == operator and kind in ("", one.kind) and one.all_of == 1
    ]


@pytest.mark.parametrize(("operator", "kind", "line"), cases(__file__, "an_operator_makes_its_mistake"))
def test_an_operator_makes_its_mistake(operator: str, kind: str, line: str) -> None:
    assert line in lines(operator, kind)


@pytest.mark.parametrize(
    ("kind", "holds"),
    [
        ("once true", [False, True, True, True]),
        ("once false", [False, False, False, False]),
        ("one call late", [False, False, True, False]),
    ],
)
def test_a_condition_may_go_by_earlier_calls(kind: str, holds: list[bool]) -> None:
    text = "class Door:\n    def opens(self, near):\n        return True if near else False\n"
    (changed,) = [one.text for one in made(text) if (one.operator, one.kind) == ("remembered", kind)]
    names: dict[str, Any] = {}
    exec(changed, names)
    door = names["Door"]()
    assert [door.opens(near) for near in (False, True, False, True)] == holds


def test_the_same_mistake_is_made_in_all_places_of_a_method() -> None:
    both = [
        one for one in made() if one.operator == "bound" and one.kind == "left out max 0" and one.all_of > 1
    ]
    (one,) = both
    assert one.all_of == 2
    assert "max" not in one.text
    assert one.text.count("min(0.5, ") == 2


def test_what_belongs_together_is_changed_together() -> None:
    (shared,) = [one for one in made() if one.operator == "on_the_class"]
    assert "class Hands:\n    last = None\n" in shared.text
    assert "type(self).last = command" in shared.text


def test_mutants_that_mean_the_same_fall_together() -> None:
    changes = [("one", Edit(4, 5, "3")), ("other", Edit(4, 5, "(3)")), ("none", Edit(4, 5, "2 "))]
    (only,) = mutants("a = 2\n", changes)
    assert (only.operator, only.before, only.after) == ("one", "2", "3")


def test_no_mutant_is_broken_and_each_has_a_key_of_its_own() -> None:
    found = made()
    meanings = {ast.dump(ast.parse(one.text)) for one in found}
    assert len(meanings) == len({one.key for one in found}) == len(found)
    assert engine.meaning(HANDS) not in meanings


def test_other_edits_leave_the_keys_as_they_are() -> None:
    other = HANDS.replace('"""Hands."""', '"""Hands, and what they do."""\n\n# A comment.\n')
    assert [one.key for one in made(other)] == [one.key for one in made()]


def test_only_what_the_subject_needs_is_changed() -> None:
    text = "LIMIT = 5.0\nOTHER = 3\n\ndef other():\n    print(OTHER)\n\ndef own():\n    print(LIMIT)\n"
    changed = {one.line for one in mutants(text, python_changes(Code(text, subject="own")))}
    assert changed
    assert changed <= {1, 8}
