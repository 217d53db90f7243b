"""The gradebook in PostgreSQL has what it has in SQLite. With a real server, where the machine has one."""

from __future__ import annotations

import getpass
import os
import pwd
import shutil
import stat
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from nbgrader.api import Gradebook
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass, make_tiny_class

from autograder.grading.classes import gradebook_reading, gradebook_writing
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import GradingError
from autograder.grading.new_classes.new_class import release

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.usefixtures("fake_engine")


def _programs() -> Path:
    """Where PostgreSQL's own programs are; Debian keeps them off the path."""
    found = shutil.which("initdb")
    folders = [Path(found).parent] if found else []
    folders += sorted(Path("/usr/lib/postgresql").glob("*/bin"))
    if not folders:
        pytest.skip("there is no PostgreSQL server on this machine (Debian: apt-get install postgresql)")
    return folders[-1]


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    """The folder of the socket of a server of our own, run by an ordinary user."""
    pytest.importorskip("psycopg", reason="./course setup --with postgresql installs psycopg")
    programs = _programs()
    user = "postgres" if os.geteuid() == 0 else getpass.getuser()
    try:
        owner = pwd.getpwnam(user)
    except KeyError:
        pytest.skip("PostgreSQL does not run as root, and there is no user named postgres")
    with tempfile.TemporaryDirectory(prefix="pg-") as name:
        folder, data = Path(name), Path(name) / "data"
        os.chown(folder, owner.pw_uid, owner.pw_gid)
        # The suite's own folder for temporary files lets in nobody else (tests/nothing_left.py).
        folder.parent.chmod(stat.S_IMODE(folder.parent.stat().st_mode) | 0o011)

        def run(program: str, *arguments: str) -> None:
            command: list[str | Path] = [programs / program, "-D", data, *arguments]
            as_user: dict[str, Any] = {"user": user} if os.geteuid() == 0 else {}
            with (folder.parent / f"{folder.name}.log").open("ab") as log:
                subprocess.run(command, check=True, stdout=log, stderr=log, cwd=folder, **as_user)

        log = folder.parent / f"{folder.name}.log"
        try:
            run("initdb", "--auth=trust", "--username=postgres", "--no-sync")
            options = f"-k {folder} -c listen_addresses= -c fsync=off"
            run("pg_ctl", "-w", "-l", str(folder / "log"), "-o", options, "start")
            yield str(folder)
            run("pg_ctl", "-m", "immediate", "stop")
        except subprocess.CalledProcessError as error:
            raise AssertionError(f"{error}\n{log.read_text()}") from error
        finally:
            log.unlink()


def execute(server: str, *statements: str, database: str = "postgres") -> None:
    import psycopg

    with psycopg.connect(host=server, user="postgres", dbname=database, autocommit=True) as connection:
        for statement in statements:
            connection.execute(statement.encode())


def move(path: Path, server: str) -> str:
    """Have a class keep its gradebook in PostgreSQL; the gradebook's URL."""
    url = f"postgresql+psycopg://postgres@/ros2?host={server}"
    with (path / "nbgrader_config.py").open("a") as config:
        config.write(f'c.CourseDirectory.db_url = "{url}"\nc.CourseDirectory.course_id = "ros2"\n')
    return url


@dataclass(frozen=True)
class Moved:
    """The tiny class with its gradebook in PostgreSQL."""

    tiny: TinyClass
    url: str


@pytest.fixture(scope="module")
def _released(server: str, tmp_path_factory: pytest.TempPathFactory) -> Moved:
    """What docs/scale.md says: two lines in the configuration, then the assignments are entered."""
    path = make_tiny_class(tmp_path_factory.mktemp("moved"))
    url = move(path, server)
    (path / "gradebook.db").unlink()
    execute(server, "CREATE DATABASE ros2")
    release(ClassDirectory(path))
    execute(server, "ALTER DATABASE ros2 RENAME TO released")
    return Moved(TinyClass(path), url)


@pytest.fixture
def moved(_released: Moved, server: str, tmp_path: Path) -> Moved:
    """A fresh one."""
    execute(server, "DROP DATABASE IF EXISTS ros2", "CREATE DATABASE ros2 TEMPLATE released")
    shutil.copytree(_released.tiny.path, tmp_path / "moved")
    return Moved(TinyClass(tmp_path / "moved"), _released.url)


def scores(url: str) -> dict[str, dict[str, float | None]]:
    with Gradebook(url) as book:
        return {
            submission.student.id: {grade.name: grade.auto_score for grade in submission.notebooks[0].grades}
            for submission in book.find_assignment("lab_1_2").submissions
        }


def hand_in(tiny: TinyClass) -> None:
    for student, talker, listener in (("ada", 10, 6), ("ben", "1/0", 10), ("cleo", "'die'", 9)):
        tiny.submit(student, talker, listener)
    tiny.hand_in("dora", "this is no notebook")


def test_it_has_the_same_grades(tiny: TinyClass, moved: Moved) -> None:
    reports = []
    for there in (tiny, moved.tiny):
        hand_in(there)
        reports.append(there.grade(feedback=True))
    found = scores(moved.url)
    assert found["ada"] == {TALKER: 10, LISTENER: 6}
    assert found == scores(f"sqlite:///{tiny.path / 'gradebook.db'}")
    assert reports[0].rows == reports[1].rows
    entry = gradebook_reading.read_entries(moved.url)["ada", "lab_1_2"]
    assert {name: cell.judged for name, cell in entry.cells["lab_1_2"].items()} == found["ada"]
    assert not (moved.tiny.path / "gradebook.db").exists()
    gradebook_writing.rename(moved.url, {"ada": ".ben", "ben": ".ada"})
    gradebook_writing.rename(moved.url, {".ben": "ben", ".ada": "ada"})
    assert scores(moved.url) == {**found, "ada": found["ben"], "ben": found["ada"]}
    gradebook_writing.rename(moved.url, {"ada": "ben"})
    assert scores(moved.url) == {
        name: of for name, of in {**found, "ben": found["ada"]}.items() if name != "ada"
    }


def test_what_is_missing_is_said(tiny: TinyClass, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("psycopg", reason="./course setup --with postgresql installs psycopg")
    tiny.submit("ada", 3)
    config = tiny.path / "nbgrader_config.py"
    usual = config.read_text()
    config.write_text(f'{usual}c.CourseDirectory.db_url = "postgresql+psycopg://nobody@127.0.0.1:1/none"\n')
    with pytest.raises(GradingError, match=r"needs a name of the course.*course_id"):
        tiny.grade()
    config.write_text(f'{config.read_text()}c.CourseDirectory.course_id = "ros2"\n')
    with pytest.raises(GradingError, match="Check that the database server runs"):
        tiny.grade()
    monkeypatch.setitem(sys.modules, "psycopg", None)
    gradebook_reading._engine.cache_clear()  # as in another process
    with pytest.raises(GradingError, match=r"\./course setup --with postgresql"):
        tiny.grade()


def test_a_class_that_moves_is_entered_anew_and_not_executed(
    tiny: TinyClass, moved: Moved, server: str, fake_engine: FakeEngine
) -> None:
    hand_in(tiny)
    before = tiny.grade()
    fake_engine.ran.clear()
    url = move(tiny.path, server)
    after = tiny.grade()
    assert fake_engine.ran == ["cleo"]  # could not be checked, so it is tried again
    assert after.rows == before.rows
    assert scores(url) == scores(f"sqlite:///{tiny.path / 'gradebook.db'}")


def test_a_grade_that_cannot_be_entered_is_no_grade(moved: Moved, server: str) -> None:
    """The database refuses one student's row; the others are graded, and the old score is not left standing."""
    hand_in(moved.tiny)
    moved.tiny.grade()
    execute(server, "ALTER TABLE grade ADD CONSTRAINT no_threes CHECK (auto_score <> 3)", database="ros2")
    moved.tiny.submit("ada", 3, 3)
    moved.tiny.submit("ben", 4, 4)
    report = moved.tiny.grade()
    assert any("ada" in problem for problem in report.problems)
    found = scores(moved.url)
    assert set(found["ada"].values()) == {0}
    assert found["ben"] == {TALKER: 4, LISTENER: 4}
