"""Who is meant by a name as systems write it."""

from __future__ import annotations

import pytest

from autograder.grading.table.roster import Identity, Roster, Student

ROSTER = Roster(
    [Student("a1", "Conor", "O'Brien"), Student("a2", "Conor", "Brien"), Student("a3", "Nora", "D’Angelo")]
)


@pytest.mark.parametrize(
    "name", ["Conor O'Brien", "Conor OBrien", "Conor O Brien", "O’Brien, Conor", "conor o`brien"]
)
def test_an_apostrophe_that_a_system_drops_or_makes_a_blank_hides_nobody(name: str) -> None:
    assert [one.id for one in ROSTER.find(Identity("moodle", name=name))] == ["a1"]


def test_who_has_no_apostrophe_is_not_taken_for_who_has() -> None:
    assert [one.id for one in ROSTER.find(Identity("moodle", name="Conor Brien"))] == ["a2"]
    assert [one.id for one in ROSTER.find(Identity("moodle", name="Nora DAngelo"))] == ["a3"]
