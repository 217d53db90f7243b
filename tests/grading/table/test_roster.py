"""Who is meant by a name as systems write it."""

from __future__ import annotations

import unicodedata
from dataclasses import replace
from typing import TYPE_CHECKING

from hypothesis import example, given
from hypothesis import strategies as st

from autograder.grading.table.roster import Identity, Roster, Student
from tests.drawn import drawn

if TYPE_CHECKING:
    from collections.abc import Callable

CONOR = Student("a1", "Conor", "O'Brien")
TURKISH = Roster([Student("a4", "Işık", "Yıldız")])
ROSTER = Roster([CONOR, Student("a2", "Conor", "Brien"), Student("a3", "Nora", "D’Angelo")])
WORDS = st.sampled_from(
    ["Ana", "Ann", "Lee", "Leeann", "Annlee", "Bär", "Bar", "O’Neil", "O'Neil", "Oneil", "Neil", "李"]
)
LETTERS = st.text(st.characters(categories=["Lu", "Ll"], max_codepoint=0x52F), min_size=1, max_size=4)
NAMES = st.lists(WORDS | LETTERS, min_size=1, max_size=2)


@st.composite
def rosters(draw: Callable[..., list[str]]) -> Roster:
    """Students whose names resemble each other; each has an id, a number and an address of her own."""
    names = [" ".join(draw(NAMES)).split(" ") for _ in range(4)]
    return Roster(
        Student(
            f"s{place}",
            first,
            " ".join(last),
            f"{place}@x.org",
            {"canvas": f"{place}1", "moodle": f"{place}"},
        )
        for place, (first, *last) in enumerate(names)
    )


WAYS: dict[str, Callable[[Student], str]] = {
    "as it is": lambda one: one.name,
    "last name first": lambda one: f"{one.last_name}, {one.first_name}",
    "capitals": lambda one: one.name.upper(),
    "small letters": lambda one: one.name.casefold(),
    "accents apart": lambda one: unicodedata.normalize("NFD", one.name),
    "other apostrophes": lambda one: one.name.replace("'", "`").replace("’", "ʼ"),
    "no apostrophes": lambda one: one.name.replace("'", "").replace("’", ""),
    "blanks for apostrophes": lambda one: one.name.replace("'", " ").replace("’", " "),
}


@drawn(80)
@given(rosters(), st.sampled_from([*WAYS]))
@example(TURKISH, "capitals")
@example(ROSTER, "no apostrophes")
@example(ROSTER, "blanks for apostrophes")
def test_a_student_is_among_those_whom_any_way_to_write_the_name_means(roster: Roster, way: str) -> None:
    for one in roster.students.values():
        found = roster.find(Identity("moodle", name=WAYS[way](one)))
        assert one in found
        turned = Roster(reversed(roster.students.values()))
        assert turned.find(Identity("moodle", name=WAYS[way](one))) == found[::-1]
    if roster is ROSTER:
        assert ROSTER.find(Identity("moodle", name=WAYS[way](CONOR))) == (CONOR,)


@drawn(60)
@given(rosters(), st.data())
def test_a_number_decides_before_a_login_and_a_login_before_a_name(
    roster: Roster, data: st.DataObject
) -> None:
    by_number, by_login, by_name = (data.draw(st.sampled_from([*roster.students.values()])) for _ in range(3))
    said = Identity("moodle", by_number.lms["moodle"], by_login.email, by_name.name)
    assert roster.find(said) == (by_number,)
    assert roster.find(replace(said, number="unknown")) == (by_login,)
    assert by_name in roster.find(replace(said, number="", login="unknown"))
    assert roster.find(replace(said, lms="canvas", number=f"{by_number.lms['moodle']}1")) == (by_number,)
    assert roster.find(Identity("moodle", "unknown", "unknown", "")) == ()


def test_who_has_no_apostrophe_is_not_taken_for_who_has() -> None:
    assert [one.id for one in ROSTER.find(Identity("moodle", name="Conor Brien"))] == ["a2"]
    assert [one.id for one in ROSTER.find(Identity("moodle", name="Nora DAngelo"))] == ["a3"]


def test_a_name_that_two_students_have_means_neither() -> None:
    """What means several students says nothing; the next thing that is known of the person decides, or none does."""
    lees = Roster([Student("a1", "Ann", "Lee"), Student("a2", "Ann", "Lee"), Student("a3", "Nora", "Bär")])
    ann = Identity(name="Ann Lee")
    assert lees.first([ann]) is None
    assert lees.first([ann, Identity(login="a2")]) == (lees.students["a2"], 1)
    assert lees.first([Identity(login="a9"), ann, Identity(name="Nora Bär"), Identity(login="a1")]) == (
        lees.students["a3"],
        2,
    )
