"""A ticket is a file: its two exercises read all their words from it, and a file of another form is refused."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from autograder.judge import evidence_files
from autograder.kit.evidence import Event, Evidence
from autograder.kit.hunts.ticket import exercise_of
from tests.cases import cases, named_cases

if TYPE_CHECKING:
    from pathlib import Path

TICKET = cases(__file__, "TICKET")


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """A lab with a ticket."""
    folder = tmp_path / "bugs_9"
    folder.mkdir()
    (folder / "silent.ticket.toml").write_text(TICKET)
    return folder


def test_both_exercises_have_the_words_of_the_ticket(lab: Path) -> None:
    repaired, asked = exercise_of(lab / "silent.py"), exercise_of(lab / "silent_why.py")
    assert (repaired.id, asked.id) == ("bugs_9.silent", "bugs_9.silent_why")
    assert (repaired.title, asked.title) == ("Hunt · The silent talker", "Hunt · The silent talker · Why")
    assert repaired.text == {"The talker says hello.": "repaired"}
    assert asked.text == {"Why?": "right"}
    assert repaired.hides_causes
    assert asked.hides_causes
    assert repaired.points + asked.points == 5


def test_after_the_pass_the_card_tells_the_cause_how_to_see_it_sooner_and_where_it_happens(lab: Path) -> None:
    reference = evidence_files.load_reference("lab_1_2.talker")
    graph = Event(0.0, "interface", "graph", reference.interface)
    parts = [replace(part, events=[graph, *part.events]) for part in reference.parts]
    solved = Evidence(parts, reference)
    remarks = exercise_of(lab / "silent.py").remarks
    assert [remark(solved) for remark in remarks] == [
        "The cause: The topic was misspelt. ROS 2 does not report that.",
        "Sooner next time: The list of topics shows it.",
        "In real projects: It happens: https://example.org/1",
    ]
    assert [remark(Evidence([], reference)) for remark in remarks] == ["", "", ""]


@pytest.mark.parametrize(("old", "new", "said"), named_cases(__file__, "a_ticket_of_another_form_is_refused"))
def test_a_ticket_of_another_form_is_refused(lab: Path, old: str, new: str, said: str) -> None:
    file = lab / "silent.ticket.toml"
    file.write_text(file.read_text().replace(old, new))
    with pytest.raises(
        ValueError, match=r"^silent\.ticket\.toml: .*A ticket has the fields title, task, "
    ) as error:
        exercise_of(lab / "silent.py")
    assert said in str(error.value)


def test_a_missing_ticket_is_named(lab: Path) -> None:
    with pytest.raises(ValueError, match=r"^other\.ticket\.toml: "):
        exercise_of(lab / "other_why.py")
