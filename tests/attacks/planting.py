"""Plants a text of its own in each place of `planted.toml`, and finds the texts in what a batch has made."""

from __future__ import annotations

import base64
import contextlib
import os
import re
import secrets
import sqlite3
import tomllib
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

HERE = Path(__file__).parent
FORM = "planted-[0-9a-f]{16}"
"""The form of each text, as a regular expression."""
_GZIP = b"\x1f\x8b\x08"
_EMBEDDED = re.compile(rb";base64,([A-Za-z0-9+/]+=*)")
"""Matches a file that stands in a page, such as a picture."""
_ANY_HEADER = 47
"""The value of zlib's ``wbits`` for the header of zlib or of gzip."""


@dataclass(frozen=True)
class Planted:
    """What was planted.

    Attributes:
        secrets: The text in each place, by the name of the place.
        paths: The files.
        variables: The variables of the terminal.
    """

    secrets: Mapping[str, str]
    paths: tuple[Path, ...]
    variables: Mapping[str, str]


def plant(words: Mapping[str, str], at_end: contextlib.ExitStack) -> Planted:
    """Plant a text in each place.

    Args:
        words: What the words in double angle brackets mean.
        at_end: Removes every file that is made.
    """
    texts: dict[str, str] = {}
    paths: list[Path] = []
    variables: dict[str, str] = {}
    for place in tomllib.loads((HERE / "planted.toml").read_text(encoding="utf-8"))["place"]:
        text = texts[place["name"]] = f"planted-{secrets.token_hex(8)}"
        if variable := place.get("variable"):
            variables[variable] = text
            continue
        name = place["path"]
        for word, meaning in words.items():
            name = name.replace(word, meaning)
        paths.append(path := Path(name))
        if place.get("own"):
            texts[place["name"]] = path.read_text(encoding="utf-8")
        elif path.suffix == ".db":
            with contextlib.closing(sqlite3.connect(path)) as database, database:
                database.execute("CREATE TABLE planted (text)")
                database.execute("INSERT INTO planted VALUES (?)", [text])
        else:
            _write(path, text, at_end)
    return Planted(texts, tuple(paths), variables)


def _write(path: Path, text: str, at_end: contextlib.ExitStack) -> None:
    assert not path.exists(), path
    made = [folder for folder in path.parents if not folder.exists()]

    def remove() -> None:
        path.unlink(missing_ok=True)
        with contextlib.suppress(OSError):  # another class, beside this one, may have planted something there
            for folder in made:
                folder.rmdir()

    at_end.callback(remove)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"SECRET = '{text}'\n", encoding="utf-8")


def everything_in(path: Path) -> Iterator[bytes]:
    """Yield what is in a file; of a database each value, unpacked."""
    if path.suffix != ".db":
        yield from unpacked(path.read_bytes())
        return
    with contextlib.closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as database:
        tables = [name for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        for table in tables:
            if table != "planted":
                for row in database.execute(f'SELECT * FROM "{table}"'):
                    for value in row:
                        yield from unpacked(value if isinstance(value, bytes) else str(value).encode())


def unpacked(data: bytes) -> Iterator[bytes]:
    """Yield data and, unpacked, all compressed and embedded data in it."""
    yield data
    for embedded in _EMBEDDED.findall(data):
        with contextlib.suppress(ValueError):
            yield from unpacked(base64.b64decode(embedded))
    with contextlib.suppress(zlib.error):
        yield from unpacked(zlib.decompress(data))
    at = data.find(_GZIP)
    while at >= 0:
        with contextlib.suppress(zlib.error):
            yield from unpacked(zlib.decompressobj(_ANY_HEADER).decompress(data[at:]))
        at = data.find(_GZIP, at + 1)


def overlay_of(home: Path, variables: Mapping[str, str] = os.environ) -> dict[str, str]:
    """Return the variables of a terminal in which the workspace in a home folder is sourced."""
    prefix = home / "reference_ws" / "install"
    (prefix / "share" / "ament_index").mkdir(parents=True, exist_ok=True)
    return {
        name: os.pathsep.join(filter(None, (str(prefix), variables.get(name))))
        for name in ("AMENT_PREFIX_PATH", "PYTHONPATH")
    }
