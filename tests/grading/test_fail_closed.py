"""Whatever fails, nobody gets points for it and nobody loses any for good."""

from __future__ import annotations

import contextlib
import os
import shutil
import sqlite3
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass, mounted, read_scores

from autograder.grading.grading_errors import DiskFull, GradebookTrouble

if TYPE_CHECKING:
    from collections.abc import Iterator


def points(tiny: TinyClass) -> dict[str, float | None]:
    """The talker's points of everybody, read without nbgrader."""
    return {student: scores.get(TALKER) for student, scores in read_scores(tiny.path).items()}


# -- the gradebook
# ---------------------------------------------------------------------------------------------------------


def test_a_gradebook_that_may_only_be_read(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada", 4)
    tiny.grade()
    config = tiny.path / "nbgrader_config.py"
    usual = config.read_text()
    url = f"sqlite:///file:{tiny.path / 'gradebook.db'}?mode=ro&uri=true"
    config.write_text(f"{usual}\nc.CourseDirectory.db_url = {url!r}\n")
    tiny.submit("ada", 9)
    fake_engine.ran.clear()
    with pytest.raises(GradebookTrouble, match=r"readonly database.*Check the owner"):
        tiny.grade()
    assert fake_engine.ran == [], "what cannot be taken back is not run"
    config.write_text(usual)
    assert tiny.grade().exit_code == 0
    assert points(tiny) == {"ada": 9}


def test_a_gradebook_that_another_program_holds(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    # SQLite waits five seconds for another program, if nothing else is said.
    tiny.configure(f"c.CourseDirectory.db_url = 'sqlite:///{tiny.path / 'gradebook.db'}?timeout=0.1'")
    for student in ("ada", "ben"):
        tiny.submit(student, 4)
    tiny.grade()
    for student in ("ada", "ben"):
        tiny.submit(student, 9)
    other = sqlite3.connect(tiny.path / "gradebook.db", isolation_level=None)

    def hold(_: object) -> None:
        if not other.in_transaction:
            other.execute("BEGIN EXCLUSIVE")

    fake_engine.before = hold
    with pytest.raises(GradebookTrouble, match=r"locked.*Another program has the file open"):
        tiny.grade()
    other.execute("ROLLBACK")
    other.close()
    assert points(tiny) == {"ada": 0, "ben": 0}
    fake_engine.before = lambda _: None
    fake_engine.ran.clear()
    assert tiny.grade().exit_code == 0
    assert "ada" not in fake_engine.ran, "it was graded, only not written down"
    assert points(tiny) == {"ada": 9, "ben": 9}


def test_a_gradebook_that_is_damaged(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada", 4)
    tiny.grade()
    book = tiny.path / "gradebook.db"
    good = book.read_bytes()
    book.write_bytes(b"no more" * 1000)
    with pytest.raises(GradebookTrouble, match=r"not a database.*Restore a backup"):
        tiny.grade()
    book.write_bytes(good)
    assert tiny.grade().exit_code == 0
    assert points(tiny) == {"ada": 4}


# -- the disk
# --------------------------------------------------------------------------------------------------------------


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of four megabytes."""
    folder = tmp_path / "disk"
    folder.mkdir()
    with mounted(folder, "-t", "tmpfs", "-o", "size=4m", "tmpfs"):
        yield folder


def fill(disk: Path, but: int) -> Path:
    """A file that leaves so many bytes."""
    filler = disk / "filler"
    free = os.statvfs(disk)
    filler.write_bytes(bytes(max(0, free.f_bavail * free.f_frsize - but)))
    return filler


@pytest.mark.parametrize("when", ["before the run", "in its middle"])
@pytest.mark.parametrize("free", [0, 8, 32, 200])
def test_a_disk_that_is_full_at_any_moment(
    tiny: TinyClass, fake_engine: FakeEngine, small_disk: Path, free: int, when: str
) -> None:
    """Free kilobytes; at some of them what is written first fits, and what comes then does not."""
    small = TinyClass(Path(shutil.copytree(tiny.path, small_disk / "class")))
    right: dict[str, float | None] = {f"student-{number}": number + 1 for number in range(4)}
    for student in right:
        small.submit(student, 10)
    small.grade(feedback=when == "in its middle")
    for student, worth in right.items():
        small.submit(student, worth)
    before = (small.path / "grades.csv").read_text()
    fillers = []
    if when == "before the run":
        fillers.append(fill(small_disk, free * 1024))
    else:
        fake_engine.before = lambda _: None if fillers else fillers.append(fill(small_disk, free * 1024))
    with contextlib.suppress(DiskFull):
        small.grade(feedback=True)
        pytest.fail("it was not full")
    untouched = all(score == 10 for score in points(small).values())
    assert untouched or all(score in (0, None, right[who]) for who, score in points(small).items())
    assert (small.path / "grades.csv").read_text() == before
    fillers[0].unlink()
    fake_engine.before = lambda _: None
    assert small.grade(feedback=True).exit_code == 0
    assert points(small) == right
    rows = [row for row in small.table() if row["exercise"] == "lab_1_2.talker"]
    assert {row["student"]: float(row["score"]) for row in rows} == right
    for student in right:
        page = small.path / "feedback" / student / "lab_1_2" / "lab_1_2.html"
        assert page.stat().st_size > 1000


# -- a submission that is not there any more
# ----------------------------------------------------------------------------------


@pytest.mark.parametrize("what", ["notebook", "everything"])
def test_a_submission_that_vanishes_while_it_runs(
    tiny: TinyClass, fake_engine: FakeEngine, tmp_path: Path, what: str
) -> None:
    path = tiny.submit("ada", 7, 8)
    tiny.submit("zoe", 3, 4)
    gone = path if what == "notebook" else path.parents[2]
    aside = tmp_path / "aside"
    fake_engine.before = lambda _: gone.rename(aside) if gone.exists() else None
    report = tiny.grade()
    assert report.exit_code == 2
    assert any("ada/lab_1_2" in problem for problem in report.problems)
    assert not points(tiny).get("ada")
    if what != "everything":
        assert points(tiny)["zoe"] == 3
    fake_engine.before = lambda _: None
    aside.rename(gone)
    assert tiny.grade().exit_code == 0
    assert tiny.scores("ada") == {TALKER: 7, LISTENER: 8}
    assert tiny.scores("zoe") == {TALKER: 3, LISTENER: 4}
