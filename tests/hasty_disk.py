"""Files and SQLite databases of tests, without waiting for the disk: no test cuts the power.

Half of the time of a test that grades a class passed in such waits. Programs that a test starts do wait.
"""

from __future__ import annotations

import contextlib
import functools
import os
import sqlite3
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

_REAL = sqlite3.connect
_FULL = "PRAGMA synchronous = FULL"


class _Connection(sqlite3.Connection):
    """A connection whose transactions are done as soon as they are written."""

    def __init__(self, database: Any, timeout: float = 5.0, *args: Any, **options: Any) -> None:
        super().__init__(database, 0.0, *args, **options)
        # The test hears of a damaged or locked file at its first query.
        with contextlib.suppress(sqlite3.Error):
            super().execute("PRAGMA synchronous = OFF")
        super().execute(f"PRAGMA busy_timeout = {round(timeout * 1000)}")

    def execute(self, sql: str, *parameters: Any) -> sqlite3.Cursor:
        return super().execute("PRAGMA synchronous = OFF" if sql == _FULL else sql, *parameters)


@contextlib.contextmanager
def no_waiting() -> Iterator[None]:
    """Nothing in this process waits until the disk has stored what was written."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda _: None)
        for module in (sqlite3, sqlite3.dbapi2):
            patch.setattr(module, "connect", functools.partial(_REAL, factory=_Connection))
        yield


@contextlib.contextmanager
def waiting() -> Iterator[None]:
    """Databases that are opened meanwhile are those of a grader."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (sqlite3, sqlite3.dbapi2):
            patch.setattr(module, "connect", _REAL)
        yield
