"""The database that the gradebook is: connections, each one transaction, and statements that are parsed once."""

from __future__ import annotations

import functools
from contextlib import contextmanager
from typing import TYPE_CHECKING

import sqlalchemy
from sqlalchemy.pool import NullPool

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sqlalchemy import Connection, Engine, TextClause


@contextmanager
def opened(url: str) -> Iterator[Connection]:
    """A connection whose block is one transaction, and that is closed behind it."""
    with _engine(url).begin() as connection:
        yield connection


@functools.lru_cache(maxsize=8)
def _engine(url: str) -> Engine:
    """Holds no connection, only what SQLAlchemy knows of the database and of our statements."""
    return sqlalchemy.create_engine(url, poolclass=NullPool)


@functools.lru_cache(maxsize=64)
def sql(statement: str) -> TextClause:
    """A statement, parsed once."""
    return sqlalchemy.text(statement)


def has_tables(book: Connection) -> bool:
    """True if nbgrader has made its tables in this database."""
    return sqlalchemy.inspect(book).has_table("grade")
