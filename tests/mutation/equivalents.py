"""Mutants that do what the task asks for, each with the reason: ``equivalent.toml``."""

from __future__ import annotations

import fnmatch
import tomllib
from functools import cache
from pathlib import Path

TABLE = Path(__file__).with_name("equivalent.toml")


@cache
def table() -> dict[str, str]:
    """Reasons by id; an id may have ``*`` in it where a whole kind is meant."""
    entries: dict[str, str] = tomllib.loads(TABLE.read_text(encoding="utf-8"))
    return entries


def reason(identity: str) -> str:
    """Why a mutant is equivalent; empty where nothing is entered for it."""
    entries = table()
    if identity in entries:
        return entries[identity]
    return next((why for form, why in entries.items() if "*" in form and fnmatch.fnmatch(identity, form)), "")
