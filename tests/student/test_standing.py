"""The map of the course: its order, what is done, and where to go on."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from autograder import course, exercises
from autograder.check_journal import JournalEntry
from autograder.student.handout import hand_out
from autograder.student.progress import Standing, standing

if TYPE_CHECKING:
    from pathlib import Path

ROOT = course.root()
FOLDER = ROOT / course.CHAPTERS


def after(*entries: JournalEntry) -> Standing:
    return standing(ROOT, FOLDER, entries)


def full(exercise: str, time: float = 1) -> JournalEntry:
    points = exercises.get(exercise).points
    return JournalEntry("check", exercise, time, points, points)


def exercises_of(notebook: str) -> list[str]:
    return [name for name in exercises.all_ids() if name.startswith(f"{notebook}.")]


def test_it_has_the_notebooks_in_their_order_with_their_titles_and_minutes() -> None:
    chapter = after().chapters[0]
    assert [one.name for one in chapter.notebooks] == [lab.name for lab in course.chapters(ROOT)[0].labs]
    assert all((FOLDER / one.path).is_file() and one.minutes for one in chapter.notebooks)
    talker = next(one for one in chapter.notebooks if one.name == "lab_1_2")
    assert talker.title == "Lab 1.2: A talker and a listener"
    assert [one.id for one in talker.exercises] == [
        f"lab_1_2.{name}" for name in ("talker", "listener", "wall", "rooms", "programs")
    ]


def test_points_make_a_notebook_done_and_a_mark_one_that_is_only_read() -> None:
    lines = [
        full("lab_1_2.talker"),
        JournalEntry("check", "lab_1_2.listener", 2, 99, 10),
        *(full(f"lab_1_2.{name}") for name in ("wall", "rooms", "programs")),
    ]
    states = {one.name: one for one in after(*lines).chapters[0].notebooks}
    assert (states["lab_1_2"].state, states["lab_1_2"].points) == ("done", states["lab_1_2"].possible)
    states = {one.name: one for one in after(lines[0]).chapters[0].notebooks}
    assert states["lab_1_2"].state == "begun"
    new, begun, done = (after(*lines[:count]).chapters[0].minutes_left for count in (0, 1, len(lines)))
    assert new == begun == done + states["lab_1_2"].minutes
    marks = [JournalEntry("read", "lab_1_2", 3), JournalEntry("unread", "lab_1_2", 4)]
    marked = [after(*marks[:count]).chapters[0].notebooks for count in range(3)]
    read = [next(replace(one, exercises=()) for one in each if one.name == "lab_1_2") for each in marked]
    assert [one.state for one in read] == ["new", "done", "new"]


def test_one_goes_on_where_one_has_worked_last() -> None:
    def following(*entries: JournalEntry) -> str | None:
        found = after(*entries).following
        return found.name if found else None

    names = [one.name for chapter in after().chapters for one in chapter.notebooks]
    assert following() == names[0]
    assert following(full("lab_1_2.talker")) == "lab_1_2"
    done = [full(exercise, 2) for exercise in exercises_of("lab_1_2")]
    assert following(*done) == names[names.index("lab_1_2") + 1]
    assert following(*done, full("lab_1_4.client", 1)) == names[names.index("lab_1_2") + 1]
    assert following(*done, JournalEntry("reset", "lab_1_1", 3)) == "lab_1_1"
    last = [full(exercise, 3) for exercise in exercises_of(names[-1])]
    assert following(*done, *last) == names[0]
    everything = [full(exercise) for exercise in exercises.all_ids()]
    read = [JournalEntry("read", name, 2) for name in names]
    assert following(*everything, *read[1:]) == (None if exercises_of(names[0]) else names[0])
    assert following(*everything, *read) is None


def test_only_what_was_begun_can_be_begun_anew(tmp_path: Path) -> None:
    hand_out(tmp_path / "class", ROOT)
    chapters = tmp_path / "class" / course.CHAPTERS

    def touched(*entries: JournalEntry) -> list[str]:
        found = standing(tmp_path / "class", chapters, entries).chapters[0].notebooks
        return [one.name for one in found if one.touched]

    assert touched() == []
    checked = JournalEntry("check", "lab_1_2.talker", 1, 0, 10)
    assert touched(checked) == ["lab_1_2"]
    assert touched(checked, JournalEntry("reset", "lab_1_2", 2)) == []
    saved = next(chapters.rglob("lab_1_3.ipynb"))
    saved.write_bytes(saved.read_bytes() + b"\n")
    assert touched() == ["lab_1_3"]
    found = standing(tmp_path / "class", chapters, [full("lab_1_2.talker")])
    assert found.following is not None
    assert (found.following.name, found.begun) == ("lab_1_3", True), "one goes on in what one has saved"


def test_a_chapter_is_finished_with_its_last_point_and_not_before() -> None:
    lines = [full(exercise, time) for time, exercise in enumerate(exercises.all_ids(), 1)]
    assert after(*lines[:-1]).chapters[-1].finished is None
    assert after(*lines).chapters[-1].finished == len(lines)
