"""Keeps the journal of a student's checks, a small file next to the notebooks. Grades never depend on it.

Each line is JSON: a check that ended, a worked solution that was opened, or a notebook that was marked as read or
reset. The course page and ``./course progress`` read the journal, and a card does, to know whether it offers the worked
solution. If the file cannot be written, checks still work. A damaged line is ignored.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import stat
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
import platformdirs

from autograder import course

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from autograder.verdict import Verdict


VARIABLE = "AUTOGRADER_JOURNAL"
"""The environment variable for the path of this session's journal; empty if there is none."""
NAME = ".course-journal.jsonl"
"""The name of the journal in the folder of the notebooks."""
MOST = 4_000_000
"""The maximum number of bytes to read from the end of the file: about thirty thousand checks."""
ATTEMPTS = 5
"""The number of failed checks, each of other code, after which a student may open the worked solution."""


class JournalEntry(msgspec.Struct, frozen=True, omit_defaults=True):
    """A line of the journal.

    Attributes:
        kind: What happened: a check ended, its worked solution was opened, or a notebook was marked as read, unmarked,
            or reset.
        name: For a check or solution, the exercise's id, such as ``"lab_1_2.talker"``; otherwise the name of the
            notebook.
        time: The Unix time in seconds.
        points: The points that the check earned.
        possible: The maximum points of the check.
        code: A digest of the code that was checked; empty if it is not known, as for a program in a terminal.
        nothing_seen: True if the check saw nothing of this code, as before its first line is written.
        helped: True if the student had opened the worked solution before this check. Only :func:`best` sets it.
    """

    kind: Literal["check", "solution", "read", "unread", "reset"]
    name: str
    time: Annotated[float, msgspec.Meta(ge=0, le=4e9)]
    points: Annotated[float, msgspec.Meta(ge=0)] = 0.0
    possible: Annotated[float, msgspec.Meta(ge=0)] = 0.0
    code: str = ""
    nothing_seen: bool = False
    helped: bool = False

    @property
    def notebook(self) -> str:
        """The name of the notebook, such as ``"lab_1_2"``."""
        return self.name.partition(".")[0]

    @property
    def full(self) -> bool:
        """True for a check that earned full marks."""
        return self.kind == "check" and self.points >= self.possible > 0


def journal_path(folder: Path) -> Path:
    """Return the path of the journal for a folder of notebooks: there or, if it is read-only, in the user's home.

    Args:
        folder: The folder that JupyterLab shows.
    """
    beside = folder / NAME
    if os.access(beside if beside.exists() else folder, os.W_OK):
        return beside
    key = hashlib.sha256(str(folder.resolve()).encode()).hexdigest()[:12]
    return platformdirs.user_data_path("ros2-course") / f"journal-{key}.jsonl"


def session_journal_path() -> Path | None:
    """Return the path of this session's journal.

    In a session of ``./course lab`` it is the journal that this command chose, otherwise the one beside the course's
    own chapters.
    """
    named = os.environ.get(VARIABLE)
    if named is not None:
        return Path(named) if named else None
    with contextlib.suppress(course.NoCourse):
        return journal_path(course.root() / course.CHAPTERS)
    return None


def note_check(verdict: Verdict, journal: Path | None = None, *, code: str = "") -> bool:
    """Record a check that has ended, unless it could not be made. Return False if the journal cannot be written.

    Args:
        journal: The journal to write to; by default this session's.
        code: A digest of the code that was checked; empty if it is not known.
    """
    if verdict.state == "not_checked":
        return True
    name, points, possible = verdict.exercise, verdict.score, verdict.max_score
    entry = JournalEntry("check", name, time.time(), points, possible, code, verdict.nothing_seen)
    return note(entry, journal)


def note_solution(exercise: str) -> bool:
    """Record that the student opens an exercise's worked solution. Return False if the journal cannot be written."""
    return note(JournalEntry("solution", exercise, time.time()))


def note(entry: JournalEntry, journal: Path | None = None) -> bool:
    """Append a line. Return True if it could be written.

    Args:
        entry: The line.
        journal: The journal to write to; by default this session's.
    """
    try:
        journal = journal or session_journal_path()
        if journal is None:
            return False
        journal.parent.mkdir(parents=True, exist_ok=True)
        with _opened(journal, os.O_RDWR | os.O_APPEND | os.O_CREAT) as number:
            size = os.fstat(number).st_size
            # The last line may be incomplete, because the disk was full or the machine was switched off.
            torn = size and os.pread(number, 1, size - 1) != b"\n"
            os.write(number, (b"\n" if torn else b"") + msgspec.json.encode(entry) + b"\n")
    except (OSError, RuntimeError):  # pathlib raises RuntimeError if the user has no home folder
        return False
    return True


def entries(journal: Path | None) -> list[JournalEntry]:
    """Return the readable lines, the oldest first; none if there is no journal."""
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
            found.append(msgspec.json.decode(line, type=JournalEntry))
    return found


def best(lines: Iterable[JournalEntry]) -> dict[str, JournalEntry]:
    """Return the best check of each exercise since its notebook was last reset; of equally good ones, the first."""
    found: dict[str, JournalEntry] = {}
    opened: set[str] = set()
    for entry in _since_reset(lines):
        if entry.kind == "solution":
            opened.add(entry.name)
        elif entry.kind == "check" and (entry.name not in found or found[entry.name].points < entry.points):
            found[entry.name] = msgspec.structs.replace(entry, helped=entry.name in opened)
    return found


def has_opened_solution(exercise: str, lines: Iterable[JournalEntry]) -> bool:
    """Return True if the student has opened an exercise's worked solution since its notebook was last reset."""
    return any(entry.kind == "solution" and entry.name == exercise for entry in _since_reset(lines))


def may_open_solution(exercise: str, lines: Iterable[JournalEntry]) -> bool:
    """Return True if enough checks of an exercise failed, each of other code, since its notebook was last reset.

    The cell as it was handed out is not one of them. If the checks of some code saw nothing, one of these codes is
    taken for that cell.
    """
    checks = [entry for entry in _since_reset(lines) if entry.kind == "check" and entry.name == exercise]
    failed = {entry.code for entry in checks if entry.code and not entry.full}
    return len(failed) - any(entry.nothing_seen for entry in checks) >= ATTEMPTS


def _since_reset(lines: Iterable[JournalEntry]) -> list[JournalEntry]:
    """Return the lines about notebooks and their exercises that no later reset of the notebook has made obsolete."""
    kept, reset = list[JournalEntry](), set[str]()
    for entry in reversed(list(lines)):
        if entry.kind == "reset":
            reset.add(entry.name)
        elif entry.notebook not in reset:
            kept.append(entry)
    return kept[::-1]


def finished(chapter: course.Chapter, reached: dict[str, JournalEntry]) -> float | None:
    """Return the time at which all points of a chapter were reached; None if they have not been reached.

    Args:
        reached: The best checks of the chapter's exercises.

    Returns:
        The Unix time in seconds.
    """
    wanted = [exercise for lab in chapter.labs for exercise in chapter.exercises_of(lab)]
    if not wanted or not all(name in reached and reached[name].full for name in wanted):
        return None
    return max(reached[name].time for name in wanted)


@contextlib.contextmanager
def _opened(path: Path, flags: int) -> Iterator[int]:
    # The folder may belong to another user. That user could put a pipe or a link there. A pipe must not block a check,
    # and a link must not make the check write to a file elsewhere.
    number = os.open(path, flags | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    try:
        if not stat.S_ISREG(os.fstat(number).st_mode):
            raise OSError(f"{path} is not a file")
        yield number
    finally:
        os.close(number)
