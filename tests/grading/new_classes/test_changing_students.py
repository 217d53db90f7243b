"""A student is renamed, dropped or joins in the middle of a term: no points are lost, doubled or blanked."""

from __future__ import annotations

import csv
import io
import os
import shutil
import signal
import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner
from downloads import write_zip
from instructor import by_person
from nbgrader.api import Gradebook
from test_collect import work
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass

from autograder.cli import cli
from autograder.grading.class_store import ClassStore
from autograder.grading.classes import gradebook_writing
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import collect
from autograder.grading.grading_errors import GradingError
from autograder.grading.new_classes import changing_students
from autograder.grading.reporting.export_files import export
from autograder.grading.table.roster import Student
from autograder.grading.table.student_list import KnownStudents, compare
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path


HEAD = "id,first_name,last_name,email,section,canvas\n"
ADA = "ada,Ada,Lovelace,ada@uni.example,Mon,101\n"
BEN = "ben,Ben,Bär,ben@uni.example,Mon,102\n"
EVE = "eve,Eve,O'Neill,eve@uni.example,Tue,104\n"
FILES = cases(__file__, "FILES")


@pytest.fixture(scope="module")
def _term(to_be_copied: TinyClass, tmp_path_factory: pytest.TempPathFactory) -> Path:
    listed(to_be_copied, ADA, BEN, EVE)
    files = {name: work(to_be_copied, points) for name, points in FILES.items()}
    collect(to_be_copied.path, [write_zip(tmp_path_factory.mktemp("downloads") / "c.zip", files)])
    with FakeEngine().at_work():
        to_be_copied.grade()
        by_person(to_be_copied, "ben", TALKER, 5, extra=0)
        to_be_copied.grade()
    return to_be_copied.path


@pytest.fixture
def term(_term: Path, fake_engine: FakeEngine, tmp_path: Path) -> TinyClass:
    """Three students' work was collected from Canvas and graded; a person has given Ben 5 points more."""
    return TinyClass(shutil.copytree(_term, tmp_path / "class"))


def listed(klass: TinyClass, *lines: str) -> None:
    (klass.path / "students.csv").write_text(HEAD + "".join(lines), encoding="utf-8")


def students(klass: TinyClass, *options: str) -> tuple[int, str]:
    said = CliRunner().invoke(cli, ["students", str(klass.path), *options])
    return said.exit_code, said.output


def exported(klass: TinyClass) -> tuple[dict[str, str], str]:
    """The points in Canvas's file by the number of Canvas, and what was said."""
    notices = "\n".join(export(klass.path, "canvas").notices)
    text = (klass.path / "export" / "canvas.csv").read_text("utf-8")
    _, _, *rows = csv.reader(io.StringIO(text))
    assert len({row[1] for row in rows}) == len(rows), "no number stands twice"
    return {row[1]: row[-1] for row in rows}, notices


def ids(klass: TinyClass) -> dict[str, set[str]]:
    """The students of whom each store of the class has work or points."""
    with Gradebook(f"sqlite:///{klass.path / 'gradebook.db'}") as book:
        in_gradebook = {one.student.id for one in book.assignment_submissions("lab_1_2")}
    with closing(sqlite3.connect(klass.path / ".autograder" / "class.db")) as book:
        tables = ("result", "attempt")
        in_store = {row[0] for name in tables for row in book.execute(f"SELECT student FROM {name}")}
    return {
        "gradebook": in_gradebook,
        "store": in_store,
        "submitted": {folder.name for folder in (klass.path / "submitted").iterdir()},
        "table": {row["student"] for row in klass.table("collected.csv")},
        "records": {path.stem for path in (klass.path / ".autograder" / "collected").glob("*/*.json")},
    }


def everywhere(*names: str) -> dict[str, set[str]]:
    return {store: set(names) for store in ("gradebook", "store", "submitted", "table", "records")}


NEW_BEN = BEN.replace("ben,", "bb99,").replace("ben@", "new@")


def test_a_new_id_with_the_same_number_is_a_rename_that_nothing_does_by_itself(term: TinyClass) -> None:
    before = exported(term)[0]
    assert before == {"101": "14", "102": "15", "104": "19"}
    term.grade(feedback=True)
    listed(term, ADA, NEW_BEN, EVE)
    for use in (term.grade, lambda: export(term.path, "canvas"), lambda: collect(term.path)):
        with pytest.raises(GradingError, match=r"ben → bb99.*course students"):
            use()
    assert ids(term) == everywhere("ada", "ben", "eve")
    code, said = students(term)
    assert (code, "rename    ben → bb99  Ben Bär (lab_1_2 15)" in said, "--yes" in said) == (0, True, True), (
        said
    )
    assert ids(term) == everywhere("ada", "ben", "eve"), "nothing was done"
    assert students(term, "--yes")[0] == 0
    assert ids(term) == everywhere("ada", "bb99", "eve")
    assert exported(term)[0] == before
    again = term.grade(feedback=True)
    assert again.executed == 0
    assert {row.student for row in again.rows} == {"ada", "bb99", "eve"}
    (page,) = (term.path / "feedback" / "bb99").rglob("*.html")
    assert "Ben Bär (bb99)" in page.read_text("utf-8")
    after, said = exported(term)
    assert (after, "does not list" in said) == (before, False), said
    with ClassStore(ClassDirectory(term.path)) as store:
        assert {row.student for one in store.attempts("bb99") for row in one.rows} == {"bb99"}


def test_new_work_of_a_renamed_student_comes_under_the_new_id(term: TinyClass, tmp_path: Path) -> None:
    listed(term, ADA, NEW_BEN, EVE)
    students(term, "--yes")
    again = {"bärben_102_5009_lab_1_2.ipynb": work(term, 8)}
    report = collect(term.path, [write_zip(tmp_path / "again.zip", again)])
    assert report.exit_code == 0, report
    term.grade()
    assert ids(term) == everywhere("ada", "bb99", "eve")
    assert exported(term)[0]["102"] == "15", "5 by a person, and 10"


def test_who_was_dropped_keeps_the_points_and_comes_back_with_them(term: TinyClass, tmp_path: Path) -> None:
    listed(term, ADA, EVE)
    for _ in range(2):
        assert term.grade().exit_code == 0
        rows, said = exported(term)
        assert rows == {"101": "14", "104": "19"}
        assert "does not list these students" in said
        assert "ben (lab_1_2 15)" in said
        assert collect(term.path).exit_code == 0, "the work of a former student waits for nobody"
    assert "ben" not in (term.path / "grades.csv").read_text("utf-8-sig")
    assert students(term)[1].startswith("2 students in the list"), "it was said, and is no news"
    listed(term, ADA, EVE, NEW_BEN)
    assert "rename    ben → bb99" in students(term)[1], "also after a while, by the number"
    students(term, "--yes")
    assert exported(term)[0] == {"101": "14", "102": "15", "104": "19"}


def test_new_work_of_a_student_who_was_dropped_is_graded_only_by_name(term: TinyClass) -> None:
    listed(term, ADA, EVE)
    assert not [one for one in term.grade().notices if "not graded" in one], "it has its points"
    term.submit("ben", 8)
    report = term.grade()
    (said,) = [one for one in report.notices if "not graded" in one]
    assert "this work is not graded: ben/lab_1_2. To grade it anyway, add --student ben" in said
    assert (report.executed, report.exit_code) == (0, 0)
    assert term.grade(students=["ben"]).executed == 1
    listed(term, ADA, BEN, EVE)
    assert (term.grade().executed, exported(term)[0]["102"]) == (0, "15")


def test_a_list_that_is_given_is_only_used_with_yes(term: TinyClass, tmp_path: Path) -> None:
    new = tmp_path / "new.csv"
    new.write_text(HEAD + ADA.replace("Mon", "Tue") + NEW_BEN + "mia,Mia,Moss,mia@uni.example,Mon,113\n")
    before = (term.path / "students.csv").read_bytes()
    said = students(term, str(new))[1]
    assert "section   ada  Ada Lovelace: Mon → Tue" in said
    assert "drop      eve  Eve O'Neill (lab_1_2 19)" in said
    assert "add       mia  Mia Moss" in said
    assert f"course students {term.path} {new} --yes" in said
    assert (term.path / "students.csv").read_bytes() == before
    students(term, str(new), "--yes")
    rows, said = exported(term)
    assert rows == {"101": "14", "102": "15", "113": ""}
    assert "1 student of the class without points for lab_1_2: mia" in said


def test_two_students_who_swap_their_ids_keep_their_own_points(term: TinyClass) -> None:
    listed(term, ADA.replace("ada,", "ben,"), BEN.replace("ben,", "ada,"), EVE)
    said = students(term, "--yes")[1]
    assert ("ada → ben" in said, "ben → ada" in said) == (True, True), said
    assert ids(term) == everywhere("ada", "ben", "eve")
    assert exported(term)[0] == {"101": "14", "102": "15", "104": "19"}
    term.grade()
    assert exported(term)[0] == {"101": "14", "102": "15", "104": "19"}
    assert collect(term.path).exit_code == 0


def test_an_id_that_is_given_to_another_person_takes_no_points_along(term: TinyClass) -> None:
    listed(term, ADA, "ben,Bea,Best,bea@uni.example,Mon,200\n", EVE)
    assert "ben → ben-102  Ben Bär (lab_1_2 15), because another student has the id now" in students(term)[1]
    students(term, "--yes")
    rows, said = exported(term)
    assert rows == {"101": "14", "104": "19", "200": ""}
    assert "ben-102 (lab_1_2 15)" in said
    assert collect(term.path).exit_code == 0
    term.grade()
    assert exported(term)[0] == rows


def test_a_number_that_was_corrected_makes_nobody_another_person(term: TinyClass) -> None:
    listed(term, ADA, BEN.replace("102", "122"), EVE)
    said = students(term)[1]
    assert said.startswith(
        "number    ben  Ben Bär: canvas 102 → 122 (lab_1_2 15): taken for the same student."
    )
    assert "3 students in the list" in said
    assert exported(term)[0]["122"] == "15"


def test_an_id_in_other_letters_is_the_same_student(term: TinyClass) -> None:
    listed(term, ADA, BEN.replace("ben,", "BEN,").replace("102", ""), EVE)
    assert "rename    ben → BEN" in students(term, "--yes")[1]
    assert ids(term) == everywhere("ada", "BEN", "eve")


def test_the_list_of_another_system_is_one_question(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    people = [
        ("Ada", "Lovelace"),
        ("Ben", "Bär"),
        ("Eve", "Neill"),
        ("Kai", "Ek"),
        ("Mia", "Moss"),
        ("Noé", "Cruz"),
    ]
    before = [f"{first.lower()},{first},{last}" for first, last in people]
    (tiny.path / "students.csv").write_text("\n".join(["id,first_name,last_name", *before]))
    tiny.submit("ada", 7, 7)
    tiny.grade()
    after = [f"{place}7,{first},{last}" for place, (first, last) in enumerate(people, 1)]
    (tiny.path / "students.csv").write_text("\n".join(["id,first_name,last_name", *after]))
    said = students(tiny)[1]
    assert said.count("unclear") == 1
    assert "6 students have the same names as before" in said
    assert "rename    ada → 17" in students(tiny, "--same-names", "--yes")[1]
    assert tiny.scores("17") == {TALKER: 7, LISTENER: 7}


def test_two_of_one_name_and_no_number_are_for_a_person_to_tell_apart(term: TinyClass) -> None:
    listed(term, ADA, "bb99,Ben,Bär,,Mon,\n", EVE)
    with pytest.raises(GradingError, match="ben → bb99"):
        export(term.path, "canvas")
    said = students(term)[1]
    assert "--rename ben=bb99" in said
    assert f"{students(term, '--rename', 'ben=bb99')[1]}".count("rename    ben → bb99") == 1
    students(term, "--yes")
    rows, said = exported(term)
    assert (rows, "ben (lab_1_2 15)" in said) == ({"101": "14", "": "", "104": "19"}, True), (
        "it was said first"
    )
    students(term, "--rename", "ben=bb99", "--yes")
    assert exported(term)[0]["102"] == "15", "the number stands in what was collected"


@pytest.mark.parametrize("options", [["--rename", "zoe=ada"], ["--rename", "ben=zoe"], ["--rename", "ben"]])
def test_a_name_that_is_in_no_list_is_said(term: TinyClass, options: list[str]) -> None:
    code, said = students(term, *options, "--yes")
    assert (code, "Traceback" in said) == (2, False), said


def test_work_under_both_ids_is_put_together(term: TinyClass, tmp_path: Path) -> None:
    """As an earlier course did it: the list was replaced, and new work came under the new id."""
    (term.path / ".autograder" / "students.json").unlink()
    term.hand_in("bb99", work(term, 8))
    listed(term, ADA, NEW_BEN, EVE)
    assert "add --rename ben=bb99 if they are one student" in students(term)[1]
    students(term, "--rename", "ben=bb99", "--yes")
    assert ids(term) == everywhere("ada", "bb99", "eve")
    term.grade()
    assert exported(term)[0]["102"] == "15", "5 by a person, 10 by the judge: whichever file it is of"


def test_two_files_that_were_put_there_by_hand_are_for_a_person(term: TinyClass) -> None:
    term.hand_in("ben", work(term, 1))
    term.hand_in("bb99", work(term, 8))
    listed(term, ADA, NEW_BEN, EVE)
    code, said = students(term, "--yes")
    assert (code, "by hand: move the folder that does not count" in said) == (2, True), said
    assert {"ben", "bb99"} <= ids(term)["submitted"]


@pytest.mark.parametrize("step", range(1, 15))
def test_wherever_it_is_killed_it_can_be_finished(
    term: TinyClass, monkeypatch: pytest.MonkeyPatch, step: int
) -> None:
    """Two swap their ids, so that nothing shows which of them has been moved."""
    listed(term, ADA.replace("ada,", "ben,"), BEN.replace("ben,", "ada,"), EVE)
    child = os.fork()
    if child == 0:
        left = [step]

        def counting(done: Any) -> Any:
            def wrapped(*words: Any, **options: Any) -> Any:
                left[0] -= 1
                if not left[0]:
                    os.kill(os.getpid(), signal.SIGKILL)
                return done(*words, **options)

            return wrapped

        for name in ("_move", "write_whole", "accept_list"):
            setattr(changing_students, name, counting(getattr(changing_students, name)))
        owners: tuple[Any, ...] = (gradebook_writing, ClassStore)
        for owner in owners:
            owner.rename = counting(vars(owner)["rename"])
        students(term, "--yes")
        os._exit(0)
    _, status = os.waitpid(child, 0)
    if (term.path / ".autograder" / "renaming.json").exists():
        with pytest.raises(GradingError, match=r"interrupted.*--yes"):
            export(term.path, "canvas")
    students(term, "--yes")
    assert not (term.path / ".autograder" / "renaming.json").exists()
    assert ids(term) == everywhere("ada", "ben", "eve")
    assert exported(term)[0] == {"101": "14", "102": "15", "104": "19"}
    assert os.WIFSIGNALED(status) or step > 12


def known(*several: Student) -> KnownStudents:
    return KnownStudents({one.id: one for one in several})


def test_what_a_list_changes() -> None:
    old = known(Student("a", lms={"canvas": "1"}), Student("b", email="b@x"), Student("c", "C", "Cee"))
    new = {
        one.id: one
        for one in (Student("a2", lms={"canvas": "1"}), Student("b2", email="B@x"), Student("c2", "Cee", "C"))
    }
    changes = compare(old, new, {})
    assert (dict(changes.renamed), changes.unclear) == ({"a": "a2", "b": "b2"}, (("c", "c2"),))
    assert (changes.dropped, changes.added) == (("c",), ("c2",))
    changes = compare(old, new, {"c": "c2"})
    assert (dict(changes.renamed), changes.unclear) == ({"a": "a2", "b": "b2", "c": "c2"}, ())


def test_a_group_may_share_an_account_on_github() -> None:
    old = known(Student("a", lms={"github": "team"}), Student("b", lms={"github": "team"}))
    assert compare(old, {"b": Student("b", lms={"github": "team"})}, {}).dropped == ("a",)
