"""The inbox of a class: every file that ``collect`` was given, stored by the hash of its bytes, with its origin.

Each ``collect`` command makes one delivery, which is one file on the disk: a zip with the new bytes and a list of the
files that came. The zip is written completely or not at all, and never changes. If the same command is run again with
the same files, it makes the same zip.
"""

from __future__ import annotations

import contextlib
import hashlib
import secrets
import zipfile
from dataclasses import dataclass
from datetime import datetime  # noqa: TC003  (msgspec reads the annotations)
from typing import TYPE_CHECKING

import msgspec

from autograder.regular_files import keep_whole

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

FOLDER = "inbox"
BY_HAND = "by hand"
"""The value of ``form`` for files that a person has put into ``submitted``."""
_LIST = "delivery.json"
_KEY_LENGTH = 10


@dataclass(frozen=True)
class Arrival:
    """A file that came in a delivery.

    Attributes:
        source: The name of the zip in which it came; empty for a folder or a single file.
        parts: The path inside the zip. For a file inside a student's archive, the path of that archive.
        inner: The path inside the student's archive; the student chose this path.
        content: The hash of the bytes; empty if they could not be read.
        refused: The reason why the bytes could not be read; empty if they could be read.
        levels: The number of names, from the top of the path, that may name a student.
        is_own: True if the instructor named this file or folder as the work of one student.
        is_list: True if the file is a list made by the system and not a student's work.
        is_archive: True if the file is a student's archive. The files in the archive have arrivals of their own.
    """

    source: str
    parts: tuple[str, ...]
    inner: tuple[str, ...] = ()
    content: str = ""
    refused: str = ""
    levels: int = 1
    is_own: bool = False
    is_list: bool = False
    is_archive: bool = False

    @property
    def name(self) -> str:
        """The name of the file without its path."""
        return (self.source, *self.parts, *self.inner)[-1]

    @property
    def path(self) -> str:
        """The path of the file without the name of the zip."""
        return "/".join((*self.parts, *self.inner))

    @property
    def label(self) -> str:
        """The name of the file for messages."""
        return "/".join(part for part in (self.source, self.path) if part)

    @property
    def key(self) -> str:
        """The key of the file in ``collected.csv``; the same for all files with equal bytes and an equal name."""
        named = f"{self.content}\0{self.path or self.source}".encode("utf-8", "replace")
        return f"#{hashlib.sha256(named).hexdigest()[:_KEY_LENGTH]}"


@dataclass(frozen=True)
class Delivery:
    """The files that one command took in, with its options.

    Attributes:
        arrivals: The files.
        form: The system that the instructor named, or :data:`BY_HAND`; empty if the names show it.
        names: The pattern given with ``--names``.
        zone: The time zone given with ``--timezone``; empty for that of the class.
        assignment: The assignment given with ``--assignment``.
        handed_in: The time given with ``--handed-in``.
    """

    arrivals: tuple[Arrival, ...]
    form: str = ""
    names: str = ""
    zone: str = ""
    assignment: str = ""
    handed_in: datetime | None = None

    @property
    def id(self) -> str:
        """Return the id of the delivery, which is equal for equal files and options in any order."""
        return hashlib.sha256(msgspec.json.encode(self)).hexdigest()[:16]


class Inbox:
    """The deliveries of a class.

    Args:
        state: The class's folder for the autograder's own files.
    """

    def __init__(self, state: Path) -> None:
        self._folder = state / FOLDER
        self._where: dict[str, Path] = {}
        self._deliveries: dict[str, Delivery] = {}
        for path in sorted(self._folder.glob("*.zip")):
            with zipfile.ZipFile(path) as archive:
                self._deliveries[path.stem] = msgspec.json.decode(archive.read(_LIST), type=Delivery)
                self._where |= {name: path for name in archive.namelist() if name != _LIST}

    @property
    def deliveries(self) -> dict[str, Delivery]:
        """Return all deliveries by their ids, in an order that does not depend on when they came."""
        return dict(sorted(self._deliveries.items()))

    def __contains__(self, content: str) -> bool:
        return content in self._where

    def read(self, content: str) -> bytes:
        """Return the bytes with this hash.

        Raises:
            KeyError: The inbox does not contain them.
        """
        with zipfile.ZipFile(self._where[content]) as archive:
            return archive.read(content)

    @contextlib.contextmanager
    def receiving(self) -> Iterator[Receiving]:
        """Take in a delivery within a ``with`` block, and store it if the block ends without an error.

        Raises:
            OSError: The delivery could not be written.
        """
        self._folder.mkdir(parents=True, exist_ok=True)
        beside = self._folder / f".delivery.{secrets.randbelow(10**12)}.new"
        try:
            with zipfile.ZipFile(beside, "x", zipfile.ZIP_DEFLATED) as archive:
                receiving = Receiving(self, archive)
                yield receiving
                delivery = receiving.delivery
                archive.writestr(_LIST, msgspec.json.encode(delivery))
            path = self._folder / f"{delivery.id}.zip"
            if delivery.arrivals and not path.exists():
                keep_whole(beside, path)
                self._deliveries[delivery.id] = delivery
                self._where |= dict.fromkeys(receiving.new, path)
        finally:
            beside.unlink(missing_ok=True)


class Receiving:
    """A delivery while it is being taken in.

    Attributes:
        delivery: The files with the options of the command, to be set before the block ends.
        new: The hashes of bytes that the inbox did not have before.
    """

    def __init__(self, inbox: Inbox, archive: zipfile.ZipFile) -> None:
        self._inbox = inbox
        self._archive = archive
        self.delivery = Delivery(())
        self.new: set[str] = set()

    def keep(self, data: bytes) -> str:
        """Store these bytes in the inbox, and return their hash."""
        content = hashlib.sha256(data).hexdigest()
        if content not in self._inbox and content not in self.new:
            self.new.add(content)
            self._archive.writestr(zipfile.ZipInfo(content), data, zipfile.ZIP_DEFLATED)
        return content
