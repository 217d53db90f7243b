"""The tables of a class's store, and the steps by which a file that an earlier course made gets the present tables.

To change the tables: change ``class_tables.sql``, raise :data:`FORM` by one, and add a step to :data:`_STEPS`.
"""

from __future__ import annotations

import contextlib
import secrets
import sqlite3
from pathlib import Path

from autograder.safe_files import keep_whole

FORM = 6
"""The version of the tables, as the file's ``user_version``."""
TABLES = Path(__file__).with_name("class_tables.sql").read_text(encoding="utf-8")
_STEPS = {5: ("DROP TABLE run",)}
"""For the earlier version, the statements that make the next version's tables from its tables."""


def bring_up_to_date(book: sqlite3.Connection, path: Path, *, may_make: bool) -> bool:
    """Make the tables if the file has none, or bring those of an earlier version to the present one.

    The steps are one transaction. Before it, the file is copied to ``class.db.version-5`` or the like, so that the
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
