"""The tables of a class's store, and the steps by which a file that an earlier course made gets the present tables.

To change the tables: change :data:`TABLES`, raise :data:`FORM` by one, and add a step to :data:`_STEPS`.
"""

from __future__ import annotations

import contextlib
import secrets
import sqlite3
from typing import TYPE_CHECKING

from autograder.safe_files import keep_whole

if TYPE_CHECKING:
    from pathlib import Path

FORM = 3
"""The version of the tables, as the file's ``user_version``."""
TABLES = """
-- The last result of each notebook. The column task contains the hash of everything on which the result depends.
CREATE TABLE IF NOT EXISTS result (
    student TEXT, assignment TEXT, notebook TEXT, task TEXT NOT NULL, execution BLOB NOT NULL,
    PRIMARY KEY (student, assignment, notebook)
);
-- The evidence of each notebook, for appeals: packed by exercise, with the executed cells. Evidence is kept for the
-- task whose points are in the gradebook, and for the task that was executed last.
CREATE TABLE IF NOT EXISTS evidence (
    student TEXT, assignment TEXT, notebook TEXT, task TEXT NOT NULL, course TEXT NOT NULL,
    checks BLOB NOT NULL, cells BLOB NOT NULL,
    PRIMARY KEY (student, assignment, notebook, task)
);
-- The results that were entered into the gradebook; see the class Entered.
CREATE TABLE IF NOT EXISTS entered (
    student TEXT, assignment TEXT, fingerprint TEXT NOT NULL, tasks BLOB NOT NULL, scores BLOB NOT NULL,
    report BLOB NOT NULL, course TEXT NOT NULL, shown TEXT NOT NULL,
    PRIMARY KEY (student, assignment)
);
-- Each grading of a submission; see the class Attempt. Attempts are only added, never changed or removed;
-- only the id of their student may change.
CREATE TABLE IF NOT EXISTS attempt (
    number INTEGER PRIMARY KEY, student TEXT NOT NULL, at TEXT NOT NULL, assignment TEXT NOT NULL,
    work TEXT NOT NULL, course TEXT NOT NULL, report BLOB NOT NULL
);
CREATE INDEX IF NOT EXISTS attempt_of ON attempt (student);
CREATE TRIGGER IF NOT EXISTS not_removed BEFORE DELETE ON attempt BEGIN SELECT RAISE(ABORT, 'attempts stay'); END;
CREATE TRIGGER IF NOT EXISTS not_changed BEFORE UPDATE OF number, at, assignment, work, course, report ON attempt
    BEGIN SELECT RAISE(ABORT, 'attempts stay'); END;
-- The class's table of results after each of the last runs that changed the table. The name is the run's time in UTC.
CREATE TABLE IF NOT EXISTS run (name TEXT PRIMARY KEY, course TEXT NOT NULL, report BLOB NOT NULL);
-- The master from which each source notebook of the class was made; see the class Origin.
CREATE TABLE IF NOT EXISTS origin (
    assignment TEXT PRIMARY KEY, master TEXT NOT NULL, text TEXT NOT NULL, work TEXT NOT NULL
);
-- The cells with points in the source notebooks. They are valid as long as the sources have this fingerprint.
CREATE TABLE IF NOT EXISTS graded_cells (fingerprint TEXT PRIMARY KEY, cells BLOB NOT NULL);
"""
_STEPS = {
    2: (
        "DROP TRIGGER IF EXISTS not_changed",
        "CREATE TRIGGER not_changed BEFORE UPDATE OF number, at, assignment, work, course, report ON attempt"
        " BEGIN SELECT RAISE(ABORT, 'attempts stay'); END",
    ),
}
"""For each earlier version, the statements that make the next version's tables from its tables."""


def bring_up_to_date(book: sqlite3.Connection, path: Path, *, may_make: bool) -> bool:
    """Make the tables if the file has none, or bring those of an earlier version to the present one.

    The steps are one transaction. Before it, the file is copied to ``class.db.version-2`` or the like, so that the
    earlier course can be used again.

    Args:
        book: The open file.
        path: The path of the file.
        may_make: True to make the tables if the file has none.

    Returns:
        False if the file still has no tables.

    Raises:
        ValueError: The file has a version from which no step leads to the present one.
        OSError: The copy could not be written.
        sqlite3.Error: The file cannot be read or written.
    """
    form = _form_of(book)
    if form not in (0, FORM, *_STEPS):
        whose = " of a newer course" if form > FORM else ""
        raise ValueError(f"the file has version {form}{whose}, but this course uses version {FORM}")
    if form in _STEPS:
        _copy(book, path, path.with_name(f"{path.name}.version-{form}"))
        book.execute("BEGIN IMMEDIATE")
        for earlier in range(_form_of(book), FORM):  # another process may have done it meanwhile
            for statement in _STEPS[earlier]:
                book.execute(statement)
        book.execute(f"PRAGMA user_version = {FORM}")
        book.execute("COMMIT")
    elif may_make and not form:
        book.executescript(f"BEGIN IMMEDIATE; {TABLES} PRAGMA user_version = {FORM}; COMMIT;")
    return bool(form or may_make)


def _form_of(book: sqlite3.Connection) -> int:
    (form,) = book.execute("PRAGMA user_version").fetchone()
    return int(form)


def _copy(book: sqlite3.Connection, path: Path, to: Path) -> None:
    beside = path.with_name(f".{path.name}.{secrets.randbelow(10**12)}.new")
    try:
        with contextlib.closing(sqlite3.connect(beside)) as copy:
            book.backup(copy)
        keep_whole(beside, to)
    finally:
        beside.unlink(missing_ok=True)
