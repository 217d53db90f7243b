"""The forms of lists that LMSs export: what ``collect`` reads, and what ``export --into`` fills in."""

from __future__ import annotations

from dataclasses import dataclass

EACH = "*"
"""The value of ``points`` if each assignment has a column of its own."""


@dataclass(frozen=True)
class ListForm:
    """A form of list, by the names of its columns, in lower case.

    Attributes:
        lms: The system that exports such lists.
        has: The columns by which it is recognized.
        number: The column with the number, or the user name, that is also in the names of files.
        logins: Columns with user names and addresses, the most certain first.
        names: The columns that together are the name, which users choose themselves.
        time: The column with the time at which the work was handed in.
        points: The column for the points, or :data:`EACH`; empty if the list has no place for points.
        is_numbered: True if the number is the same for all assignments.
    """

    lms: str
    has: tuple[str, ...]
    number: str = ""
    logins: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    time: str = ""
    points: str = ""
    is_numbered: bool = False

    @property
    def sure(self) -> tuple[str, ...]:
        """The columns that identify a person better than a name does, the most certain first."""
        return (self.number, *self.logins) if self.is_numbered else self.logins


FORMS = (
    # Moodle's grading worksheet. Its identifiers look like "Participant 12345", but the word depends on the language.
    ListForm(
        "moodle",
        ("identifier", "grade"),
        "identifier",
        ("id number", "username", "email address"),
        ("full name",),
        "last modified (submission)",
        "grade",
    ),
    ListForm(
        "moodle",
        ("id", "vollständiger name", "bewertung"),
        "id",
        ("matrikelnummer", "id-nummer", "anmeldename", "e-mail-adresse"),
        ("vollständiger name",),
        "zuletzt geändert (abgabe)",
        "bewertung",
    ),
    ListForm(
        "moodle",
        ("identifiant", "nom complet", "note"),
        "identifiant",
        ("numéro d'identification", "nom d'utilisateur", "adresse de courriel"),
        ("nom complet",),
        "dernière modification (travail remis)",
        "note",
    ),
    ListForm(
        "canvas",
        ("student", "id", "section"),
        "id",
        ("sis user id", "sis login id"),
        ("student",),
        points=EACH,
        is_numbered=True,
    ),
    # A list of submissions from Canvas, whose columns have the field names of Canvas's API.
    ListForm(
        "canvas",
        ("user_id", "submitted_at"),
        "user_id",
        ("login_id", "sis_user_id"),
        ("name",),
        "submitted_at",
    ),
    ListForm(
        "github",
        ("github_username", "roster_identifier"),
        "github_username",
        ("roster_identifier",),
        ("roster_identifier",),
        "submission_timestamp",
    ),
    # Gradescope's scores of one assignment.
    ListForm(
        "gradescope",
        ("sid", "submission time"),
        "submission id",
        ("sid", "email"),
        ("first name", "last name"),
        "submission time",
    ),
    ListForm(
        "brightspace",
        ("orgdefinedid", "end-of-line indicator"),
        logins=("username", "orgdefinedid"),
        points=EACH,
    ),
    ListForm("blackboard", ("username", "last name"), logins=("username",), points=EACH),
    ListForm(
        "sakai", ("student id", "student name"), logins=("student id",), names=("student name",), points=EACH
    ),
)
