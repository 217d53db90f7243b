"""The store of a class: nothing is lost, nothing is there by half, nobody's names touch another's."""

from __future__ import annotations

import contextlib
import itertools
import os
import signal
import sqlite3
import subprocess
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from tiny_class import TALKER, FakeEngine, TinyClass, make_version_5, mounted

from autograder.boxes.run_limits import Ended, Limits
from autograder.cli import cli
from autograder.execution.executed_cells import Cell, CellCheck, CellRun, Execution
from autograder.grading import class_store, store_tables
from autograder.grading.class_records import Attempt, Origin, ResultKey
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory, Submission
from autograder.grading.grading_errors import StoreTrouble
from autograder.grading.grading_task import Task
from autograder.grading.table.rows import Row
from autograder.verdict import State, Verdict
from tests import hasty_disk

if TYPE_CHECKING:
    from collections.abc import Iterator

CHECK = CellCheck("lab.one", "One", points=10, worth=4, limit=2)
CELLS = (Cell("1", own=True), Cell("check()", check=CHECK, name="lab-one"))
TASK = Task("ada", "lab", "lab", CELLS, "seed", "v1")
DONE = Execution(
    (CellRun(Ended.DONE, ({"output_type": "stream", "name": "stdout", "text": "ü"},)),),
    {1: Verdict("lab.one", "One", State.FAILED, 5, 10)},
)
ROWS = (Row("ada", "lab", "lab.one", 2, 4, "failed"),)
AT = datetime(2026, 1, 2, tzinfo=UTC)


@pytest.fixture
def store(tmp_path: Path) -> Iterator[ClassStore]:
    """The store of an empty class."""
    (tmp_path / "class" / "source").mkdir(parents=True)
    (tmp_path / "class" / ".autograder").mkdir()
    (tmp_path / "class" / "nbgrader_config.py").touch()
    with ClassStore(ClassDirectory(tmp_path / "class")) as made:
        yield made


def submission(student: str = "ada", assignment: str = "lab") -> Submission:
    return Submission(student, assignment, Path("submitted", student, assignment))


def entered(number: int = 0, student: str = "ada", assignment: str = "lab") -> Attempt:
    own = (Row(student, assignment, "lab.one", 2, 4, "failed"),)
    task = replace(TASK, student=student, assignment=assignment)
    scores = {"lab": {"lab-one": 2.0}}
    key = ResultKey(f"work {number}")
    return Attempt(AT, assignment, key, "v1", own, tasks={"lab": task.key()}, scores=scores)


def attempts(*numbers: int) -> list[Attempt]:
    """The attempts of ada with these numbers, as a list of her attempts has them."""
    keys = [None, *(ResultKey(f"work {number}") for number in numbers)]
    return [
        Attempt(AT, "lab", key, "v1", ROWS, earlier)
        for earlier, key in itertools.pairwise(keys)
        if key is not None
    ]


def attempts_of(store: ClassStore) -> list[Attempt]:
    """The attempts of ada without what a run recognizes them by."""
    return [replace(one, tasks={}, scores={}, shown="") for one in store.attempts("ada")]


def change(store: ClassStore, statement: str) -> None:
    """What another program does to the file."""
    with contextlib.closing(sqlite3.connect(file_of(store))) as book, book:
        book.execute(statement)


def file_of(store: ClassStore) -> Path:
    return store._path


# -- what is kept comes back


def test_a_run_that_enters_nothing_leaves_the_evidence_of_a_grade(store: ClassStore) -> None:
    changed = replace(TASK, course="v2")
    store.keep(TASK, replace(DONE, evidence={"lab.one": b"first"}))
    store.enter(submission(), entered())
    for number in range(2):  # two dry runs with a changed course
        store.keep(changed, replace(DONE, evidence={"lab.one": b"%d" % number}))
    seen = store.evidence("ada", "lab.one")
    assert seen is not None
    assert (seen.task, seen.checks) == (TASK.key(), {"lab.one": b"first"})
    store.keep(TASK, replace(DONE, evidence={"lab.one": b"executed again, and seen otherwise"}))
    assert store.evidence("ada", "lab.one") == seen
    store.keep(changed, replace(DONE, evidence={"lab.one": b"1"}))
    store.enter(submission(), replace(entered(), tasks={"lab": changed.key()}))
    seen = store.evidence("ada", "lab.one")
    assert seen is not None
    assert (seen.task, seen.checks) == (changed.key(), {"lab.one": b"1"})
    with contextlib.closing(sqlite3.connect(file_of(store))) as book:
        assert book.execute("SELECT count(*) FROM evidence").fetchone() == (1,)


def test_an_unknown_class_has_an_empty_answer_to_everything_and_no_file(store: ClassStore) -> None:
    assert (store.results("ada", "lab"), store.entered(), store.attempts("ada")) == ({}, {}, [])
    assert (store.evidence("ada", "lab.one"), store.origins(), store.graded_cells("x")) == (None, {}, b"")
    assert store.last_key(submission()) is None
    assert not file_of(store).exists()
    file_of(store).touch()  # whoever made it was killed before the first step was done
    assert store.entered() == {}
    store.note_origins({"lab": Origin("lab.md", "text", "work")})
    assert store.origins() == {"lab": Origin("lab.md", "text", "work")}


def test_a_result_belongs_to_the_very_task(store: ClassStore) -> None:
    store.keep(TASK, DONE)
    assert store.results("ada", "lab") == {TASK.key(): DONE}
    for changed in (
        replace(TASK, cells=(*TASK.cells, Cell("2"))),
        replace(TASK, seed="other"),
        replace(TASK, course="v2"),
        replace(TASK, limits=Limits(cell_seconds=1)),
        replace(TASK, files={"a": b"b"}),
    ):
        assert changed.key() not in store.results("ada", "lab")
    other = replace(TASK, seed="other")
    store.keep(other, DONE)
    assert list(store.results("ada", "lab")) == [other.key()], "one of each notebook"


def test_evidence_comes_and_goes_with_its_result_and_is_no_part_of_it(store: ClassStore) -> None:
    assert store.keep(TASK, replace(DONE, evidence={"lab.one": b"seen"})) == DONE
    store.keep(TASK, replace(DONE, evidence={"lab.one": b"half"}, trouble="the judge is gone"))
    kept = store.evidence("ada", "lab.one")
    assert kept is not None
    assert (kept.assignment, kept.notebook, kept.task, kept.checks) == (
        "lab",
        "lab",
        TASK.key(),
        {"lab.one": b"seen"},
    )
    assert [(cell.text, cell.checks) for cell in kept.run_cells()] == [("1", ""), ("", "lab.one")]
    assert store.results("ada", "lab") == {TASK.key(): DONE}
    assert store.evidence("ada", "lab.two") is None
    store.keep(TASK, DONE)
    assert store.evidence("ada", "lab.one") is None


def test_what_was_entered_is_known_with_its_attempt_until_it_is_taken_back(store: ClassStore) -> None:
    store.enter(submission(), entered(1))
    store.enter(submission(), entered(2), is_final=False)  # to be tried again
    assert store.entered() == {("ada", "lab"): entered(1)}
    store.note_shown(submission(), "pages")
    noted = replace(entered(1), shown="pages")
    assert store.entered() == {("ada", "lab"): noted}
    store.enter(submission(), entered(3))
    assert store.entered()["ada", "lab"].shown == "", "its pages say something else"
    store.forget_entered([submission()])
    store.note_shown(submission(), "pages")
    assert (store.entered(), attempts_of(store)) == ({}, attempts(1, 2, 3))


def test_attempts_are_added_and_neither_changed_nor_removed(store: ClassStore) -> None:
    store.enter(submission(), entered(), is_final=False)
    for statement in (
        "DELETE FROM attempt",
        "UPDATE attempt SET made_from = 'other'",
        "UPDATE attempt SET tasks = ''",
    ):
        with pytest.raises(sqlite3.IntegrityError, match="attempts stay"):
            change(store, statement)
    assert attempts_of(store) == attempts(0)


def test_the_attempt_before_is_that_at_the_same_assignment(store: ClassStore) -> None:
    for number, assignment in enumerate(("lab", "quiz", "lab", "quiz")):
        store.enter(submission(assignment=assignment), entered(number, assignment=assignment))
    keys = [None, None, ResultKey("work 0"), ResultKey("work 1")]
    assert [one.earlier for one in store.attempts("ada")] == keys
    assert store.last_key(submission()) == ResultKey("work 2")


def test_of_a_student_with_two_ids_the_new_one_keeps_its_grade(store: ClassStore) -> None:
    for number, student in enumerate(("eve", "ada")):
        store.enter(submission(student), entered(number, student))
        store.note_shown(submission(student), "pages")
    store.rename({"ada": "eve"})
    assert store.entered() == {("eve", "lab"): entered(0, "eve")}
    assert [one.made_from for one in store.attempts("eve")] == [ResultKey("work 0"), ResultKey("work 1")]
    store.rename({"eve": "zoe"})
    assert [one.made_from for one in store.entered().values()] == [ResultKey("work 0")]


def test_read_cells_are_those_of_the_present_sources(store: ClassStore) -> None:
    store.keep_graded_cells("one", b"cells")
    store.keep_graded_cells("two", b"others")
    assert (store.graded_cells("one"), store.graded_cells("two")) == (b"", b"others")


# -- names

NAMES = "ada Ada ADA ada@lab lab@ada lab@ada@lab a/da ../ada ada.json % _ * ' ﬁ fi Straße STRASSE 0 00"
ODD = [*NAMES.split(), "e\u0301", "\u00e9", "\u00e9\u200b", "ada ", "ada' OR '1'='1", 'ada" --']


def test_no_name_touches_the_rows_of_another(store: ClassStore) -> None:
    pairs = [(student, assignment) for student in ODD for assignment in ("lab", "Lab", "lab@ada")]
    tasks = {}
    for number, (student, assignment) in enumerate(pairs):
        tasks[student, assignment] = replace(TASK, student=student, assignment=assignment)
        exercise = f"{assignment}.one"
        store.keep(tasks[student, assignment], replace(DONE, evidence={exercise: f"{number}".encode()}))
        store.enter(submission(student, assignment), entered(number, student, assignment))
    gone = submission("ada", "lab")
    store.forget_entered([gone])
    store.note_shown(submission("Ada", "lab"), "pages")
    assert store.entered().keys() == set(pairs) - {("ada", "lab")}
    assert [key for key, one in store.entered().items() if one.shown] == [("Ada", "lab")]
    for number, (student, assignment) in enumerate(pairs):
        task = tasks[student, assignment]
        assert list(store.results(student, assignment)) == [task.key()]
        seen = store.evidence(student, f"{assignment}.one")
        assert seen is not None
        assert (seen.task, seen.checks) == (task.key(), {f"{assignment}.one": f"{number}".encode()})
        own = [one.made_from for one in store.attempts(student) if one.assignment == assignment]
        assert own == [ResultKey(f"work {number}")]
    assert store.attempts("\udcff") == store.attempts("") == []


# -- damage


@pytest.mark.parametrize("column", ["execution", "task"])
def test_a_damaged_result_counts_as_none_and_the_others_stay(store: ClassStore, column: str) -> None:
    two = replace(TASK, notebook="two")
    for task in (TASK, two):
        store.keep(task, DONE)
    change(store, f"UPDATE result SET {column} = substr({column}, 1, 10) WHERE notebook = 'lab'")
    assert store.results("ada", "lab").get(TASK.key()) is None
    assert store.results("ada", "lab")[two.key()] == DONE


@pytest.mark.parametrize("column", ["tasks", "scores", "report", "made_from"])
def test_a_damaged_entry_counts_as_none_and_the_others_stay(store: ClassStore, column: str) -> None:
    for student in ("ada", "ben"):
        store.enter(submission(student), entered(student=student))
    change(store, "DROP TRIGGER not_changed")
    change(store, f"UPDATE attempt SET {column} = 'x' WHERE student = 'ada'")
    assert store.entered() == {("ben", "lab"): entered(student="ben")}
    assert len(store.attempts("ben")) == 1


@pytest.mark.parametrize("damage", ["a page of other bytes", "of another form"])
def test_a_damaged_file_is_named_and_costs_nobody_points(
    tiny: TinyClass, fake_engine: FakeEngine, damage: str
) -> None:
    tiny.submit("ada", 4)
    tiny.grade()
    file = tiny.path / ".autograder" / "class.db"
    good = file.read_bytes()
    page = int.from_bytes(good[16:18], "big")
    if damage == "a page of other bytes":
        file.write_bytes(good[:page] + b"\xff" * (len(good) - page))
    else:
        with contextlib.closing(sqlite3.connect(file)) as book:
            book.execute("PRAGMA user_version = 1")
    advice = (
        r"which contains the results of grading, cannot be .*Restore a backup of the file.*rename the file"
    )
    with pytest.raises(StoreTrouble, match=advice):
        tiny.grade()
    for words in (
        ["attempts", str(tiny.path), "ada"],
        ["report", str(tiny.path)],
    ):
        said = CliRunner().invoke(cli, words)
        assert (said.exit_code, "Restore a backup of the file" in said.output) == (2, True), said.output
    assert tiny.scores("ada")[TALKER] == 4
    file.rename(file.with_suffix(".old"))
    fake_engine.ran.clear()
    assert tiny.grade().exit_code == 0
    assert (fake_engine.ran, tiny.scores("ada")[TALKER]) == (["ada"], 4)


def test_a_file_of_a_newer_course_is_sound(store: ClassStore, tmp_path: Path) -> None:
    store.keep_graded_cells("f", b"{}")
    with contextlib.closing(sqlite3.connect(tmp_path / "class" / ".autograder" / "class.db")) as book:
        book.execute("PRAGMA user_version = 99")
    with pytest.raises(
        StoreTrouble, match=r"the file has version 99 of a newer course.* The file is not damaged"
    ) as caught:
        ClassStore(ClassDirectory(tmp_path / "class")).entered()
    assert "Put back" not in str(caught.value)


# -- files of an earlier course


def make_earlier(store: ClassStore) -> list[str]:
    """Give the file the tables of the earlier version, with content, and return that content."""
    store.keep(TASK, DONE)
    store.enter(submission(), entered())
    store.note_shown(submission(), "pages")
    store.enter(
        submission(), entered(1), is_final=False
    )  # so the newest attempt is not the one in the gradebook
    store.close()
    make_version_5(file_of(store))
    return dump_of(file_of(store))


def dump_of(path: Path) -> list[str]:
    with contextlib.closing(sqlite3.connect(path)) as book:
        return list(book.iterdump())


def test_a_file_of_an_earlier_course_is_used_on_and_a_copy_stays(store: ClassStore) -> None:
    before = make_earlier(store)
    assert store.entered() == {("ada", "lab"): replace(entered(), shown="pages")}
    assert attempts_of(store) == attempts(0, 1)
    with contextlib.closing(sqlite3.connect(file_of(store))) as book:
        assert book.execute("PRAGMA user_version").fetchone() == (store_tables.FORM,)
    copy = file_of(store).with_name("class.db.version-5")
    assert dump_of(copy) == before
    store.rename({"ada": "eve"})
    assert (store.attempts("ada"), len(store.attempts("eve"))) == ([], 2)
    for column in ("made_from", "scores"):
        with pytest.raises(sqlite3.IntegrityError, match="attempts stay"):
            change(store, f"UPDATE attempt SET {column} = 'forged'")
    assert dump_of(copy) == before
    store.close()
    make_earlier(store)  # the instructor put back a file of the earlier course
    assert ("ada", "lab") in store.entered()


@pytest.mark.parametrize("name", ["_copy", "keep_whole", "_form_of"])
def test_a_file_whose_conversion_was_killed_is_whole(
    store: ClassStore, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    before = make_earlier(store)

    def die(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    asked = store_tables._form_of
    times: list[int] = []

    def die_in_the_transaction(book: sqlite3.Connection) -> int:
        times.append(1)
        if len(times) == 2:
            book.execute("PRAGMA cache_size = 1")
            book.execute("DROP TRIGGER not_changed")
            book.execute("CREATE TABLE large AS SELECT randomblob(3000000)")
            die()
        return asked(book)

    monkeypatch.setattr(store_tables, name, die if name != "_form_of" else die_in_the_transaction)
    os.waitpid(in_a_process(store.entered), 0)
    monkeypatch.undo()
    assert dump_of(file_of(store)) == before
    assert store.entered() == {("ada", "lab"): replace(entered(), shown="pages")}
    assert dump_of(file_of(store).with_name("class.db.version-5")) == before


# -- killed


def in_a_process(work: object) -> int:
    """Fork; the child's id. It does its work and never comes back."""
    child = os.fork()
    if child == 0:
        try:
            work()  # type: ignore[operator]
        finally:
            os._exit(0)
    return child


def test_a_step_that_was_killed_in_its_middle_was_never_begun(store: ClassStore) -> None:
    """Also where pages of it are in the file already."""
    store.enter(submission(), entered())
    store.close()

    def die() -> None:
        with store._step() as book:
            book.execute("PRAGMA cache_size = 1")
            for number in range(200):
                book.execute(
                    "INSERT INTO result VALUES (?, 'lab', 'lab', 'key', ?)", (f"{number}", bytes(9000))
                )
            book.execute("UPDATE attempt SET entered = 0")
            os.kill(os.getpid(), signal.SIGKILL)

    os.waitpid(in_a_process(die), 0)
    assert file_of(store).with_name("class.db-journal").stat().st_size > 0
    assert file_of(store).stat().st_size > 1_000_000, "it was in its middle"
    assert store.entered() == {("ada", "lab"): entered()}
    assert store.results("0", "lab") == {}


def test_a_step_is_on_the_disk_before_it_is_said_to_be_done(store: ClassStore) -> None:
    with hasty_disk.waiting():
        store.note_origins({})
    assert store._connection is not None
    asked = [
        store._connection.execute(f"PRAGMA {name}").fetchone()[0] for name in ("synchronous", "journal_mode")
    ]
    assert asked == [2, "truncate"]


# -- others at the same time


def test_who_reads_reads_while_a_batch_runs(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    for student in ("ada", "ben"):
        tiny.submit(student, 4)
    fake_engine.evidence["lab_1_2.talker"] = b"seen"
    tiny.grade()
    tiny.submit("ben", 7)
    tiny.grade()
    tiny.submit("ben", 9)
    said: list[str] = []

    def ask(_: object) -> None:
        for words in (("attempts", "ada"), ("report",), ("appeal", "ada", "lab_1_2.talker")):
            done = CliRunner().invoke(cli, [words[0], str(tiny.path), *words[1:]])
            said.append(f"{words[0]} {done.exit_code} {done.output}")

    fake_engine.before = ask
    tiny.grade()
    assert [one.split()[:2] for one in said] == [
        ["attempts", "0"],
        ["report", "0"],
        ["appeal", "2"],
    ]
    assert "is damaged" in said[-1], "the evidence of this test is none, and was found"


def test_who_reads_waits_for_no_step_that_has_not_come_to_its_end(store: ClassStore) -> None:
    store.enter(submission(), entered())
    with contextlib.closing(sqlite3.connect(file_of(store), isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        other.execute("UPDATE attempt SET entered = 0")
        assert store.entered() == {("ada", "lab"): entered()}
        other.execute("ROLLBACK")


def test_a_store_that_another_program_holds(store: ClassStore, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(class_store, "_PATIENCE", 0.1)
    store.enter(submission(), entered())
    store.close()
    with contextlib.closing(sqlite3.connect(file_of(store), isolation_level=None)) as other:
        other.execute("BEGIN EXCLUSIVE")
        for ask in (store.entered, lambda: store.forget_entered([submission()])):
            with pytest.raises(StoreTrouble, match=r"locked.*Another program has the file open"):
                ask()
        other.execute("ROLLBACK")
    assert store.entered() == {("ada", "lab"): entered()}


# -- the disk


def test_a_class_that_may_only_be_read_is_read(
    tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path
) -> None:
    for points in (4, 7):
        tiny.submit("ada", points)
        tiny.grade()
    with mounted(tiny.path, "--bind", str(tiny.path)):
        subprocess.run(["mount", "-o", "remount,bind,ro", str(tiny.path)], check=True)
        page = str(tmp_path / "report.html")
        for words in (("attempts", "ada"), ("report", "--output", page)):
            done = CliRunner().invoke(cli, [words[0], str(tiny.path), *words[1:]])
            assert done.exit_code == 0, done.output
        for line in (
            ["export", "--to", "csv", "--output", str(tmp_path)],
            ["grade"],
            ["students"],
            ["collect"],
        ):
            done = CliRunner().invoke(cli, [line[0], str(tiny.path), *line[1:]])
            said = "You do not have the right to read or write"
            assert (done.exit_code, said in done.output, done.output.count("\n")) == (2, True, 1), done.output
        store = ClassStore(ClassDirectory(tiny.path))
        with pytest.raises(StoreTrouble, match=r"readonly.*Check the owner"):
            store.forget_entered([submission()])
