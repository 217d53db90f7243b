"""Makes the sample class of ``demo``, twenty students and three weeks of labs, as a data file describes them."""

from __future__ import annotations

import hashlib
import itertools
import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from autograder import course, standard_output
from autograder.boxes import sandbox
from autograder.command_name import COMMAND
from autograder.grading.batch import grade
from autograder.grading.classes.class_directory import CONFIG_NAME, STATE_NAME, SUFFIX, switch_sandbox_off
from autograder.grading.grading_errors import GradingError
from autograder.grading.new_classes.new_class import CONFIG, new_class
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.notebook_rebuilding import grade_id
from autograder.grading.reporting.grade_report import show
from autograder.grading.reporting.report_page import write_report
from autograder.grading.table.roster import NAME as STUDENTS
from autograder.masters.master_files import lab_name, masters

if TYPE_CHECKING:
    from rich.console import Console

    from autograder.grading.reporting.grade_report import GradeReport

DATA = Path(__file__).with_suffix(".toml")
CELL_SECONDS = 8.0
"""The time limit of a cell in seconds. It is short, so that a student with an endless loop keeps no visitor waiting."""
NOTEBOOK_SECONDS = 120.0
_STAMP = "sample"


@dataclass(frozen=True)
class SampleNotebook:
    """The description of one student's notebook, with the fields that the data file explains."""

    student: str
    assignment: str
    about: str = "Everything is right."
    expected: dict[str, tuple[float, str]] = field(default_factory=dict)
    change: dict[str, tuple[str, str]] = field(default_factory=dict)
    unsolved: bool = False
    missing: bool = False


class _SampleData(msgspec.Struct):
    """The content of a data file: its notebooks, the students who hand in each assignment, and whose page to open."""

    notebook: tuple[SampleNotebook, ...]
    students: dict[str, str] = {}
    assignments: tuple[str, ...] = ()
    shown: tuple[str, str] = ("", "")


def sample_data(file: Path) -> _SampleData:
    """Return the content of a data file, such as ``DATA``."""
    return msgspec.toml.decode(file.read_bytes(), type=_SampleData)


def sample_notebooks(file: Path) -> tuple[SampleNotebook, ...]:
    """Return the descriptions of all notebooks that the students of a data file hand in."""
    data = sample_data(file)
    described = {(one.student, one.assignment): one for one in data.notebook}
    for student, assignment in itertools.product(data.students, data.assignments):
        described.setdefault((student, assignment), SampleNotebook(student, assignment))
    return tuple(one for one in described.values() if not one.missing)


def _submit_sample(path: Path) -> None:
    """Write every sample notebook into ``submitted`` of the class at ``path``, and its list of students."""
    if students := sample_data(DATA).students:
        lines = [f"{student},{name.replace(' ', ',')}\n" for student, name in students.items()]
        (path / STUDENTS).write_text("".join(["id,first_name,last_name\n", *lines]), encoding="utf-8")
    for notebook in sample_notebooks(DATA):
        folder = path / "submitted" / notebook.student / notebook.assignment
        folder.mkdir(parents=True, exist_ok=True)
        text = sample_text(path, notebook)
        (folder / f"{notebook.assignment}{SUFFIX}").write_text(text, encoding="utf-8")


def demo(path: Path, *, console: Console | None = None) -> GradeReport:
    """Make the sample class, grade it, write its report page, and print which pages to open.

    If an earlier call made the class from the same version of the course, the class is only graded again, which takes
    seconds. If this machine cannot run sandboxes, the class is graded without them, which is safe because the course's
    own samples are harmless.

    Args:
        path: The class directory, which is made if it does not exist.
        console: The console to print on; by default standard output.

    Raises:
        GradingError: ``path`` contains something other than the sample class, or grading is not possible.
    """
    console = console or standard_output.console()
    if sandbox.why_impossible():
        switch_sandbox_off(path)
    _make(path, console)
    report = grade(path)
    if report.exit_code or report.note:
        show(report, console)
    data = sample_data(DATA)
    student, assignment = data.shown
    page = report.feedback / student / assignment / f"{assignment}.html"
    for line in (
        f"{report.executed} notebooks graded in {report.seconds:.0f} s, {report.reused} unchanged.",
        f"Open this page about the class:   {write_report(path)}",
        f"Open {data.students.get(student, '').partition(' ')[0]}'s page, as he gets it:   {page.absolute()}",
        f"Type this next, for your class:   {COMMAND} new-class ~/my-class",
    ):
        console.print(line, highlight=False, soft_wrap=True)
    return report


def _make(path: Path, console: Console) -> None:
    stamp = path / STATE_NAME / _STAMP
    version = _version(course.root())
    if stamp.is_file():
        if stamp.read_text() == version:
            return
        console.print(f"The course has changed: making {path} again.", highlight=False)
        shutil.rmtree(path)
    elif (path / CONFIG_NAME).exists():
        raise GradingError(
            f"{path} contains a class that is not the sample. Choose another folder: autograder demo FOLDER"
        )
    new_class(
        path,
        course.root(),
        assignments=sorted({notebook.assignment for notebook in sample_notebooks(DATA)}),
        cell_seconds=CELL_SECONDS,
        notebook_seconds=NOTEBOOK_SECONDS,
    )
    _submit_sample(path)
    stamp.write_text(version)


def _version(root: Path) -> str:
    """Return a hash of all files from which the sample class is made."""
    digest = hashlib.sha256(DATA.read_bytes() + CONFIG.encode())
    names = {notebook.assignment for notebook in sample_notebooks(DATA)}
    for path in (path for path in masters(root) if lab_name(path) in names):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def sample_text(path: Path, wanted: SampleNotebook) -> str:
    """Return the text of a sample student's notebook.

    Args:
        path: The class, with notebooks in ``source`` and ``release``.
        wanted: The description of the notebook.
    """
    name = f"{wanted.assignment}{SUFFIX}"
    notebook = nbformat_nodes.read((path / "release" / wanted.assignment / name).read_text(encoding="utf-8"))
    source = nbformat_nodes.read((path / "source" / wanted.assignment / name).read_text(encoding="utf-8"))
    right = {grade_id(cell): _without_markers(cell.source) for cell in source.cells}
    changed = {name: right[name].replace(*pair) for name, pair in wanted.change.items()}
    for cell in filter(grade_id, notebook.cells):
        given = cell.source if wanted.unsolved else right.get(grade_id(cell), cell.source)
        cell.source = changed.get(grade_id(cell), given)
    return nbformat_nodes.text(notebook)


def _without_markers(source: str) -> str:
    return "\n".join(line for line in source.split("\n") if not line.strip().startswith("### "))
