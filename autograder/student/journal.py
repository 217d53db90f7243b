"""The journal of a student's checks: a small file beside their notebooks, and never a grade.

One line of JSON a line: a check that ended, a notebook that was marked as read, one that was begun anew. The course
page and ``./course progress`` read it. Nothing that a grader does depends on it: a check goes on where the file cannot
be written, and a line that is damaged is left out.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import stat
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
import platformdirs

from autograder import course

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from autograder.verdict import Verdict

VARIABLE = "AUTOGRADER_JOURNAL"
"""The variable with the path of this session's journal; empty for none."""
NAME = ".course-journal.jsonl"
"""The journal's name in the folder of the notebooks."""
MOST = 4_000_000
"""Bytes that are read, counted from the end: some forty thousand checks."""


@dataclass(frozen=True)
class Entry:
    """A line of the journal.

    Attributes:
        kind: What happened: a check ended, a notebook was marked as read or no longer so, or begun anew.
        name: The exercise's id for a check, such as ``"lab_1_2.talker"``; else the notebook's name.
        time: Seconds since the epoch.
        points: Points of a check.
        possible: Points that it could have had.
    """

    kind: Literal["check", "read", "unread", "reset"]
    name: str
    time: Annotated[float, msgspec.Meta(ge=0, le=4e9)]
    points: Annotated[float, msgspec.Meta(ge=0)] = 0.0
    possible: Annotated[float, msgspec.Meta(ge=0)] = 0.0

    @property
    def notebook(self) -> str:
        """The name of the notebook that it belongs to, such as ``"lab_1_2"``."""
        return self.name.partition(".")[0]

    @property
    def full(self) -> bool:
        """True if it is a check with all points."""
        return self.kind == "check" and self.points >= self.possible > 0


def place(folder: Path) -> Path:
    """The journal for the notebooks in a folder: beside them, or in the user's home where nothing can be written there.

    Args:
        folder: The folder that JupyterLab shows.
    """
    beside = folder / NAME
    if os.access(beside if beside.exists() else folder, os.W_OK):
        return beside
    key = hashlib.sha256(str(folder.resolve()).encode()).hexdigest()[:12]
    return platformdirs.user_data_path("ros2-course") / f"journal-{key}.jsonl"


def own_place() -> Path | None:
    """This session's journal: the one that ``./course lab`` has named, else the one of the course's own chapters."""
    named = os.environ.get(VARIABLE)
    if named is not None:
        return Path(named) if named else None
    with contextlib.suppress(course.NoCourse):
        return place(course.root() / course.CHAPTERS)
    return None


def note_check(verdict: Verdict, journal: Path | None = None) -> None:
    """Keep a check that has ended; nothing is kept of one that could not be made.

    Args:
        verdict: What the judge found.
        journal: Where; this session's own where not given.
    """
    if verdict.state != "not_checked":
        note(Entry("check", verdict.exercise, time.time(), verdict.score, verdict.max_score), journal)


def note(entry: Entry, journal: Path | None = None) -> bool:
    """Append a line, and say whether that was possible.

    Args:
        entry: The line.
        journal: Where; this session's own where not given.
    """
    try:
        journal = journal or own_place()
        if journal is None:
            return False
        journal.parent.mkdir(parents=True, exist_ok=True)
        with _opened(journal, os.O_RDWR | os.O_APPEND | os.O_CREAT) as number:
            size = os.fstat(number).st_size
            torn = size and os.pread(number, 1, size - 1) != b"\n"  # a full disk, a machine that went off
            os.write(number, (b"\n" if torn else b"") + msgspec.json.encode(entry) + b"\n")
    except (OSError, RuntimeError):  # pathlib raises the second where there is no home
        return False
    return True


def entries(journal: Path | None) -> list[Entry]:
    """The lines that can be read, the oldest first; none where there is no journal."""
    try:
        if journal is None:
            return []
        with _opened(journal, os.O_RDONLY) as number:
            size = os.fstat(number).st_size
            text = os.pread(number, MOST, max(0, size - MOST))
    except OSError:
        return []
    found = []
    for line in text.splitlines():
        with contextlib.suppress(msgspec.MsgspecError, UnicodeDecodeError):
            found.append(msgspec.json.decode(line, type=Entry))
    return found


def best(lines: Iterable[Entry]) -> dict[str, Entry]:
    """For each exercise the first of its best checks since its notebook was last begun anew."""
    found: dict[str, dict[str, Entry]] = {}
    for entry in lines:
        if entry.kind == "reset":
            found.pop(entry.name, None)
        elif entry.kind == "check":
            of_notebook = found.setdefault(entry.notebook, {})
            if entry.name not in of_notebook or of_notebook[entry.name].points < entry.points:
                of_notebook[entry.name] = entry
    return {name: entry for of_notebook in found.values() for name, entry in of_notebook.items()}


def finished(chapter: course.Chapter, reached: dict[str, Entry]) -> float | None:
    """The time at which the last of all points of a chapter was reached; None before that.

    Args:
        chapter: The chapter.
        reached: Its best checks.

    Returns:
        Seconds since the epoch.
    """
    wanted = [exercise for lab in chapter.labs for exercise in chapter.exercises_of(lab)]
    if not wanted or not all(name in reached and reached[name].full for name in wanted):
        return None
    return max(reached[name].time for name in wanted)


@contextlib.contextmanager
def _opened(path: Path, flags: int) -> Iterator[int]:
    # The folder may be another's, whose work somebody looks at: what is no file must not keep a check waiting, and a
    # link have no line written into a file elsewhere.
    number = os.open(path, flags | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    try:
        if not stat.S_ISREG(os.fstat(number).st_mode):
            raise OSError(f"{path} is no file")
        yield number
    finally:
        os.close(number)
