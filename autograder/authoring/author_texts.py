"""Texts of commands for authors. Each text stands on one line of ``author_texts.toml``, under its name."""

from __future__ import annotations

import tomllib
from pathlib import Path

TEXTS: dict[str, str] = tomllib.loads(
    Path(__file__).with_name("author_texts.toml").read_text(encoding="utf-8")
)


def author_text(name: str, /, **words: object) -> str:
    """Return the text with a name, with the words that it needs."""
    return TEXTS[name].format(**words)
