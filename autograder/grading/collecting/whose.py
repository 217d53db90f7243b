"""Whose a file is: what its name says, held against the list of students and the lists that came with the download."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder.grading.table.roster import Identity, Roster, Student

if TYPE_CHECKING:
    from datetime import datetime

    from autograder.grading.collecting.forms import Found
    from autograder.grading.collecting.lists import LmsList


class Whose:
    """Knows the students of a class by all names that systems have for them.

    Args:
        roster: The students of the class.
    """

    def __init__(self, roster: Roster) -> None:
        self._roster = roster
        self._lists: dict[str, LmsList] = {}

    def learn(self, known: LmsList) -> None:
        """Take what a list says that came with a download."""
        self._lists[known.lms] = known

    def find(self, way: Found) -> tuple[Found, tuple[Student, ...]] | None:
        """Who may be meant, by the first way of reading the name in which somebody is."""
        readings = way.readings if self._roster.students and way.readings else (way.identity,)
        for identity in readings:
            if students := self._of(identity):
                return replace(way, identity=identity), students
        return None

    def _of(self, identity: Identity) -> tuple[Student, ...]:
        """Who may be meant. Without any list of students, whoever is named in the LMS's own form."""
        found = self._roster.find(identity)
        known = self._lists.get(identity.lms)
        if known is not None:
            others = known.people.get(identity.number or identity.login, ())
            sure = next((hit for other in others if len(hit := self._roster.find(other)) == 1), ())
            found = sure or found
        called = identity.login or identity.name
        if not found and not self._roster.students and identity.lms and called:
            found = (Student(called),)
        return found

    def reason_against(self, identity: Identity | None) -> str:
        """Why nobody was found, and what to do."""
        if identity is None:
            return (
                "its name does not say whose it is: say --from, or put it into a folder with the student's id"
            )
        return (
            f"nobody in the class is called {identity}: add a line to students.csv, or the id that "
            f"{identity.lms.capitalize()} uses ({identity.number or identity.login}) to the column {identity.lms}"
        )

    def time_in_list(self, identity: Identity) -> datetime | None:
        """When a list says that somebody handed in, in its own time; None where none says so."""
        known = self._lists.get(identity.lms)
        return known.times.get(identity.number or identity.login) if known else None
