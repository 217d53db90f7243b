"""A tiny class: one notebook, two exercises, a check that only tells the fake judge a number."""

from __future__ import annotations

import contextlib
import csv
import io
import sqlite3
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat
import pytest
from nbgrader.api import Gradebook
from rich.console import Console

from autograder.boxes.run_limits import Ended
from autograder.execution.executed_cells import CellRun, Execution
from autograder.execution.verdicts_without_judge import grader_trouble, zero_points
from autograder.grading.batch import grade
from autograder.grading.new_classes.new_class import new_class
from autograder.grading.reporting.grade_report import show
from autograder.grading.running import execution_backends
from autograder.grading.running.task_dispatcher import Done

sys.path.insert(0, str(Path(__file__).parent))  # for fake_judge, which a worker imports by that name
from fake_judge import verdict

from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from autograder.grading.grading_task import Task
    from autograder.grading.reporting.grade_report import GradeReport

MASTER = cases(__file__, "MASTER")

COURSE = {
    "autograder/judge/check_server.py": b"the judge",
    "autograder/cards/card_wording.py": b"the words of cards",
    "solutions/chapter/lab_1_2/talker.py": b"an exercise",
    "solutions/chapter/lab_1_3/server.py": b"an exercise of another lab",
}
"""The files of the course on which results depend in these tests: they stand still while somebody edits the course."""
TALKER, LISTENER = "lab_1_2-talker", "lab_1_2-listener"
STANDS_STILL = f"""
from autograder.grading import course_version

course_version.course_files = lambda: course_version.CourseFiles({COURSE!r}.items())
"""
GRADE = f"{STANDS_STILL}\n{cases(__file__, 'GRADE')}"
"""A batch in a process of its own: the class, and what makes a judge."""
QUIET = Console(quiet=True)


@dataclass
class TinyClass:
    """A class in a test's own folder."""

    path: Path

    def released(self) -> Any:
        return nbformat.read(self.path / "release" / "lab_1_2" / "lab_1_2.ipynb", as_version=4)

    def submit(self, student: str, talker: object = 10, listener: object = 10) -> Path:
        """Hand in a notebook whose answers return these (code, so "1/0" raises)."""
        notebook = self.released()
        for cell in notebook.cells:
            name = cell.metadata.get("nbgrader", {}).get("grade_id")
            if name == "Talker":
                cell.source = f"def Talker():\n    return {talker}"
            elif name == "Listener":
                cell.source = f"def Listener():\n    return {listener}"
        return self.hand_in(student, notebook)

    def hand_in(self, student: str, notebook: Any) -> Path:
        text = notebook if isinstance(notebook, str) else nbformat.writes(notebook)
        path = self.path / "submitted" / student / "lab_1_2" / "lab_1_2.ipynb"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def configure(self, *lines: str) -> None:
        """Write lines to the end of the class's configuration."""
        with (self.path / "nbgrader_config.py").open("a") as config:
            config.writelines(f"{line}\n" for line in lines)

    def grade(self, **options: Any) -> GradeReport:
        return grade(self.path, **{"console": QUIET, "feedback": False, **options})

    def table(self, name: str = "grades.csv") -> list[dict[str, str]]:
        """The lines of a table of the class, as any program for CSV reads them."""
        with (self.path / name).open(encoding="utf-8-sig", newline="") as lines:
            return list(csv.DictReader(lines))

    def scores(self, student: str) -> dict[str, float | None]:
        """What the gradebook says."""
        with Gradebook(f"sqlite:///{self.path / 'gradebook.db'}") as book:
            notebook = book.find_submission_notebook("lab_1_2", "lab_1_2", student)
            return {grade.name: grade.auto_score for grade in notebook.grades}


def read_scores(path: Path) -> dict[str, dict[str, float | None]]:
    """What the gradebook of a class says, read as a file by somebody who knows nothing of nbgrader."""
    found: dict[str, dict[str, float | None]] = {}
    with contextlib.closing(sqlite3.connect(path / "gradebook.db")) as book:
        for student, cell, score in book.execute(cases(__file__, "SCORES")):
            found.setdefault(student, {})[cell] = score
    return found


def write_master(course: Path, lab: str, text: str) -> None:
    """Write the master of a lab into a course of one chapter."""
    folder = course / "solutions" / "chapter" / lab
    folder.mkdir(parents=True)
    (folder / "lab.md").write_text(text)


def make_version_5(store: Path) -> None:
    """Give a class's store the tables of the course that kept a table of results after each run."""
    with contextlib.closing(sqlite3.connect(store)) as book, book:
        book.executescript(
            """
            CREATE TABLE run (name TEXT PRIMARY KEY, course TEXT NOT NULL, report BLOB NOT NULL);
            INSERT INTO run VALUES ('2026-11-29T10-15-20.000000', 'v1', '[]');
            PRAGMA user_version = 5;
            """
        )


def shown(report: GradeReport, width: int = 200) -> str:
    """What a report says in a terminal of that width."""
    out = io.StringIO()
    show(report, Console(file=out, width=width))
    return out.getvalue()


def make_tiny_class(folder: Path) -> Path:
    """A class without submissions in a folder of that one."""
    write_master(folder / "course", "lab_1_2", MASTER)
    new_class(folder / "tiny-class", folder / "course", timezone="UTC")
    return folder / "tiny-class"


@contextlib.contextmanager
def mounted(folder: Path, *options: str) -> Iterator[None]:
    """Mount something on a folder, as long as a test needs it."""
    if subprocess.run(["mount", *options, str(folder)], capture_output=True, check=False).returncode:
        pytest.skip("only root can mount")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


class FakeEngine:
    """Stands for the workers: the answers' text says what comes of them, at once."""

    def __init__(self) -> None:
        self.ran: list[str] = []
        self.evidence: dict[str, bytes] = {}
        self.before: Callable[[Task], None] = lambda _: None

    @contextlib.contextmanager
    def at_work(self) -> Iterator[None]:
        """Nothing is executed meanwhile."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(execution_backends, "execute_all", self.execute_all)
            yield

    def execute_all(self, tasks: Sequence[Task], *_: object, **options: Any) -> Iterator[Done]:
        for task in tasks:
            options["on_start"](task)
            self.before(task)
            self.ran.append(task.student)
            yield Done(task, self.execute(task))

    def execute(self, task: Task) -> Execution:
        verdicts = {}
        trouble = ""
        answers = {cell.name: cell.source.rpartition("return ")[2] for cell in task.cells}
        for index, cell in enumerate(task.cells):
            if cell.check is None:
                continue
            said = answers["Talker" if cell.name == TALKER else "Listener"]
            if said == "'die'":
                trouble = "the judge is gone"
                verdicts[index] = grader_trouble(cell.check, trouble)
            elif said.isdigit():
                verdicts[index] = verdict(cell.check.exercise, float(said), task.seed)
            else:
                verdicts[index] = zero_points(cell.check, "crashed", "It raised.", "Mend it.")
        runs = tuple(CellRun(Ended.DONE) for _ in task.cells)
        return Execution(runs, verdicts, trouble, evidence=dict(self.evidence))
