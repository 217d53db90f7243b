"""The store of a class: one SQLite file in which the grader keeps results, evidence and attempts.

Each write is one transaction, so that a killed run or a power failure leaves no half-written entry. The file uses
SQLite's rollback journal, because a write-ahead log would not work on network disks, and would need write access even
for readers. Other programs may read the file during a run, because the run locks it only for milliseconds at a time. A
separate lock file (:mod:`autograder.grading.classes.class_lock`) ensures that only one process grades a class at a
time.
"""

from __future__ import annotations

import contextlib
import sqlite3
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar

import msgspec

from autograder.execution.executed_cells import Execution
from autograder.grading.class_records import Attempt, KeptEvidence, Origin, ResultKey
from autograder.grading.grading_errors import DiskFull, StoreTrouble, is_disk_full, said_by_database
from autograder.grading.store_tables import bring_up_to_date
from autograder.grading.table.rows import Row
from autograder.safe_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.grading_task import Task

NAME = "class.db"
_SQL = Path(__file__).with_name("class_queries.sql").read_text(encoding="utf-8")
_QUERIES = dict(part.split("\n", 1) for part in _SQL.split("-- query: ")[1:])
"""The queries in ``class_queries.sql`` by name."""
_NOT_ENTERED = (
    "task NOT IN (SELECT value FROM attempt AS a, json_each(CAST(a.tasks AS TEXT))"
    " WHERE a.entered AND a.student = evidence.student AND a.assignment = evidence.assignment)"
)
"""SQL condition for evidence whose points are not in the gradebook."""
_RENAME = (
    "UPDATE attempt SET entered = 0 WHERE student = ?2 AND entered"
    " AND assignment IN (SELECT assignment FROM attempt WHERE student = ?1 AND entered)",
    "UPDATE attempt SET student = ?1, shown = '' WHERE student IN (?1, ?2)",
    "UPDATE OR IGNORE result SET student = ?1 WHERE student = ?2",
    "DELETE FROM result WHERE student = ?2",
    "UPDATE OR IGNORE evidence SET student = ?1 WHERE student = ?2",
    "DELETE FROM evidence WHERE student = ?2",
)
"""SQL statements that give a student (?2) another id (?1). Pages name the student, so they are made again."""
_TAKE_BACK = "UPDATE attempt SET entered = 0 WHERE (student, assignment) = (?, ?) AND entered"
_PATIENCE = 30.0
"""Time limit in seconds for waiting until another program has ended its transaction."""
_Decoded = TypeVar("_Decoded")


class ClassStore:
    """The store of one class. Use it in a ``with`` statement, which closes the file at the end.

    The first write makes the file, and before that, the store counts as empty. Methods skip a damaged entry if the next
    run can make it again.

    Every method raises :class:`DiskFull` if the disk is full, and :class:`StoreTrouble` if the file is damaged,
    locked, read-only or of another version. The content of the file does not change in these cases.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self._class = directory.path
        self._path = directory.state / NAME
        self._connection: sqlite3.Connection | None = None
        self._has_tables = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file. The next method that needs the file opens it again."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    # -- results of tasks

    def keep(self, task: Task, execution: Execution) -> Execution:
        """Store the result and the evidence of a notebook, and return the result without the evidence.

        The notebook's earlier result and evidence are deleted, except evidence for points in the gradebook, which an
        appeal may need. If the grader itself failed, store nothing, so that the next run tries again.
        """
        result = replace(execution, evidence={})
        if execution.trouble:
            return result
        names = (task.student, task.assignment, task.notebook)
        seen = KeptEvidence.of(task, execution)
        with self._step() as book:
            book.execute(
                "REPLACE INTO result VALUES (?, ?, ?, ?, ?)", (*names, seen.task, msgspec.json.encode(result))
            )
            book.execute(
                f"DELETE FROM evidence WHERE (student, assignment, notebook) = (?, ?, ?) AND {_NOT_ENTERED}",
                names,
            )
            if seen.checks:
                book.execute(
                    "INSERT OR IGNORE INTO evidence VALUES (?, ?, ?, ?, ?, ?, ?)",
                    (*names, seen.task, seen.course, msgspec.msgpack.encode(seen.checks), seen.cells),
                )
        return result

    def adopt(self, task: Task, earlier: str) -> None:
        """Record that the stored result and evidence of an earlier task, given by its hash, are those of this task."""
        names = (task.key(), task.student, task.assignment, task.notebook, earlier)
        where = "(student, assignment, notebook, task) = (?, ?, ?, ?)"
        with self._step() as book:
            for table in ("result", "evidence"):
                book.execute(f"UPDATE OR REPLACE {table} SET task = ? WHERE {where}", names)

    def results(self, student: str, assignment: str) -> dict[str, Execution]:
        """Return the stored results of a submission by the hash of the task, in the order of the notebooks.

        Some results may be outdated: if the submission has changed since, its present tasks have other hashes.
        """
        rows = self._rows(
            "SELECT task, execution FROM result WHERE (student, assignment) = (?, ?) ORDER BY notebook",
            student,
            assignment,
        )
        found = {task: _decoded(execution, Execution) for task, execution in rows}
        return {task: execution for task, execution in found.items() if execution is not None}

    def evidence(self, student: str, exercise: str) -> KeptEvidence | None:
        """Return the evidence for a check's points in the gradebook, or the newest evidence; None if there is none."""
        for assignment, notebook, task, course, checks, cells in self._rows(
            "SELECT assignment, notebook, task, course, checks, cells FROM evidence WHERE student = ?"
            f" ORDER BY assignment, notebook, {_NOT_ENTERED}",
            student,
        ):
            found = _decoded(checks, dict[str, bytes], msgspec.msgpack.decode)
            if found is not None and exercise in found:
                return KeptEvidence(assignment, notebook, task, course, found, cells)
        return None

    # -- attempts

    def enter(self, submission: Submission, attempt: Attempt, *, is_final: bool = True) -> None:
        """Record an attempt, whose results are now in the gradebook.

        If ``is_final`` is False, the next run grades the submission again.
        """
        names = submission.key
        with self._step() as book:
            if is_final:
                book.execute(_TAKE_BACK, names)
            blobs = (attempt.made_from, attempt.rows, attempt.tasks, attempt.scores)
            book.execute(
                "INSERT INTO attempt (student, assignment, at, course, made_from, report, tasks, scores, entered)"
                " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                (*names, attempt.at.isoformat(), attempt.course, *map(msgspec.json.encode, blobs), is_final),
            )
            if is_final:
                whose = "(student, assignment) = (?, ?)"
                book.execute(f"DELETE FROM evidence WHERE {whose} AND {_NOT_ENTERED}", names)

    def note_shown(self, submission: Submission, shown: str) -> None:
        """Record the hash of the gradebook's entry from which the feedback pages of a submission were made."""
        with self._step() as book:
            book.execute(
                "UPDATE attempt SET shown = ? WHERE (student, assignment) = (?, ?) AND entered",
                (shown, *submission.key),
            )

    def forget_entered(self, submissions: Iterable[Submission]) -> None:
        """Record that submissions have no grades. Call this before setting the grades in the gradebook to zero."""
        with self._step() as book:
            book.executemany(_TAKE_BACK, (one.key for one in submissions))

    def entered(self) -> dict[tuple[str, str], Attempt]:
        """Return the attempts whose results are in the gradebook, by student and assignment."""
        found = {tuple(row[:2]): _attempt(*row) for row in self._rows(_QUERIES["entered"])}
        return {key: attempt for key, attempt in found.items() if attempt}

    def attempts(self, student: str) -> list[Attempt]:
        """Return all attempts of a student, oldest first."""
        return list(filter(None, (_attempt(*row) for row in self._rows(_QUERIES["attempts"], student))))

    def last_key(self, submission: Submission) -> ResultKey | None:
        """Return the key of the newest attempt of a submission; None if it was never graded."""
        rows = self._rows(_QUERIES["last_key"], *submission.key)
        return _decoded(rows[0][0], ResultKey) if rows else None

    def rename(self, ids: Mapping[str, str]) -> None:
        """Give students other ids. If a student had both ids, the results under the new one stay.

        Args:
            ids: The new ids by the old ones. No new id may be one of the old ones.
        """
        if not self._path.exists():
            return
        with self._step() as book:
            for statement in _RENAME:
                book.executemany(statement, [(new, old) for old, new in ids.items()])

    # -- sources

    def note_origins(self, origins: Mapping[str, Origin]) -> None:
        """Record the masters of new source notebooks, by assignment."""
        with self._step() as book:
            book.executemany(
                "REPLACE INTO origin VALUES (?, ?, ?, ?)",
                [(name, one.master, one.text, one.work) for name, one in origins.items()],
            )

    def origins(self) -> dict[str, Origin]:
        """Return the masters of the source notebooks, by assignment; empty if no master was recorded."""
        return {name: Origin(*fields) for name, *fields in self._rows("SELECT * FROM origin")}

    def keep_graded_cells(self, fingerprint: str, cells: bytes) -> None:
        """Store the cells with points in the present source notebooks, instead of all earlier ones."""
        with self._step() as book:
            book.execute("DELETE FROM graded_cells")
            book.execute("INSERT INTO graded_cells VALUES (?, ?)", (fingerprint, cells))

    def graded_cells(self, fingerprint: str) -> bytes:
        """Return the cells with points, as stored for source notebooks with this fingerprint; empty if not stored."""
        rows = self._rows("SELECT cells FROM graded_cells WHERE fingerprint = ?", fingerprint)
        return rows[0][0] if rows else b""

    # -- the file

    def _rows(self, question: str, *names: str) -> list[tuple[Any, ...]]:
        with self._said_clearly():
            if self._connection is None and not self._path.exists():
                return []
            book = self._opened(may_make=False)
            if not self._has_tables:
                return []  # a process was killed after it created the file and before it made the tables
            return book.execute(question, [name_as_text(name) for name in names]).fetchall()

    @contextlib.contextmanager
    def _step(self) -> Iterator[sqlite3.Connection]:
        """Execute the block in one transaction."""
        with self._said_clearly():
            book = self._opened(may_make=True)
            book.execute("BEGIN IMMEDIATE")
            yield book
            book.execute("COMMIT")

    def _opened(self, *, may_make: bool) -> sqlite3.Connection:
        if self._connection is None:
            # Open the file for writing even to read it, so that SQLite can roll back the transaction of a killed
            # process.
            address = f"{self._path.as_uri()}?mode={'rwc' if may_make else 'rw'}"
            self._connection = sqlite3.connect(address, _PATIENCE, isolation_level=None, uri=True)
            self._connection.execute("PRAGMA journal_mode = TRUNCATE")
            self._connection.execute("PRAGMA synchronous = FULL")
            self._has_tables = False
        if not self._has_tables:
            try:
                self._has_tables = bring_up_to_date(self._connection, self._path, may_make=may_make)
            except ValueError as error:
                raise StoreTrouble(self._path, str(error)) from error
        return self._connection

    @contextlib.contextmanager
    def _said_clearly(self) -> Iterator[None]:
        """If the block fails, roll back its transaction, and raise an error with a message for an instructor."""
        try:
            yield
        except BaseException as error:
            self.close()  # closing rolls back the transaction
            if is_disk_full(error):
                raise DiskFull(self._class) from error
            if isinstance(error, sqlite3.Error):
                raise StoreTrouble(self._path, said_by_database(error)) from error
            raise


def _attempt(
    student: str,
    assignment: str,
    at: str,
    course: str,
    shown: str,
    key: bytes,
    report: bytes,
    tasks: bytes,
    scores: bytes,
    earlier: bytes | None,
) -> Attempt | None:
    """Return an attempt; None if its data is damaged. The rows may have an earlier id of the student."""
    made_from, rows = _decoded(key, ResultKey), _decoded(report, tuple[Row, ...])
    hashes, points = _decoded(tasks, dict[str, str]), _decoded(scores, dict[str, dict[str, float]])
    if made_from is None or rows is None or hashes is None or points is None:
        return None
    own = tuple(replace(row, student=student) for row in rows)
    before = _decoded(earlier or b"", ResultKey)
    when = datetime.fromisoformat(at)
    return Attempt(when, assignment, made_from, course, own, before, hashes, points, shown)


def _decoded(
    data: bytes | str, form: type[_Decoded], decode: Callable[..., Any] = msgspec.json.decode
) -> _Decoded | None:
    """Return the decoded value; None if the data is damaged."""
    try:
        found: _Decoded = decode(data, type=form)
    except msgspec.MsgspecError:
        return None
    return found
