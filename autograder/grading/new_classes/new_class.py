"""Makes a class, an nbgrader course directory with notebooks from the course's masters, and updates its notebooks."""

from __future__ import annotations

import contextlib
import copy
import os
import shlex
import shutil
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING
from zoneinfo import available_timezones

from alembic.config import Config
from alembic.script import ScriptDirectory
from jinja2 import Template
from nbgrader import api, dbutil
from nbgrader.converters import GenerateAssignment
from nbgrader.coursedir import CourseDirectory

from autograder.boxes.run_limits import Limits
from autograder.command_name import COMMAND
from autograder.grading.class_checks import note_origins
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import (
    CONFIG_NAME,
    COURSE_NAME,
    STATE_NAME,
    SUFFIX,
    ClassDirectory,
    refuse_students_folder,
)
from autograder.grading.classes.class_secret import create_secret
from autograder.grading.grading_errors import GradingError, check_known, clear_disk_errors, course_command
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.result_writer import quiet
from autograder.masters.master_files import MasterError, lab_name, masters, relinked
from autograder.masters.source_notebooks import source_notebook
from course_runtime.installation import IS_CLONE, ROOT

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Sequence

    from nbformat import NotebookNode

DEMO_NAME = "demo-class"

CONFIG = Path(__file__).with_name("nbgrader_config.py.j2").read_text(encoding="utf-8")
"""The template of a class's nbgrader configuration."""


@dataclass(frozen=True)
class NewClass:
    """A class that was just made.

    Attributes:
        path: The class directory.
        assignments: The assignments of the class. The notebooks for students are in ``release/``.
        timezone: The name of the class's time zone.
    """

    path: Path
    assignments: tuple[str, ...]
    timezone: str

    def summary(self) -> tuple[str, ...]:
        """Return lines for the instructor about the new class and the next steps."""
        return (
            f"{self.path} is a class with these assignments: {', '.join(self.assignments)}.",
            f"The time zone of due dates in formgrader is {self.timezone}: see {CONFIG_NAME}.",
            f"Hand out       {COMMAND} hand-out FOLDER makes the folder for students",
            f"Each week      cd {shlex.quote(str(self.path))}, then {COMMAND} week DOWNLOAD LIST",
            "               DOWNLOAD is what students handed in, as you got it from your LMS. LIST is the list of the",
            "               LMS into which points go; the first time, it is the list of students, too",
            f"or put notebooks in {self.path / 'submitted'}/<student>/<assignment>/<assignment>.ipynb, and type",
            f"               {course_command('grade', self.path)}",
        )


def new_class(
    path: Path,
    course_root: Path,
    *,
    assignments: Sequence[str] = (),
    timezone: str = "",
    cell_seconds: float = Limits.cell_seconds,
    notebook_seconds: float = Limits.notebook_seconds,
) -> NewClass:
    """Make a class directory with its gradebook, sources and release.

    Args:
        path: The folder for the class, which must be empty or not exist, and lie outside the course's repository.
        course_root: The top folder of the course, which contains ``solutions``.
        assignments: The names of the assignments; by default all labs with a graded cell.
        timezone: The name of the time zone of due dates, such as ``Europe/Berlin``; by default this machine's.
        cell_seconds: Time limit of a cell, in seconds of wall time.
        notebook_seconds: Time limit of a notebook, in seconds of wall time.

    Raises:
        GradingError: The folder is not empty or is inside the course's repository, an assignment does not exist, a
            master cannot be used, or nbgrader could not make the class.
    """
    path = path.absolute()
    _check_place(path, course_root)
    sources = _sources_of(course_root, assignments)
    timezone = timezone or machine_timezone()
    config = Template(CONFIG, keep_trailing_newline=True).render(
        command=COMMAND, timezone=timezone, cell_seconds=cell_seconds, notebook_seconds=notebook_seconds
    )
    made_folder = not path.exists()
    try:
        with clear_disk_errors(path):
            path.mkdir(parents=True, exist_ok=True)
            _fill(path, sources, config)
            (path / STATE_NAME / COURSE_NAME).write_text(str(course_root.resolve()), encoding="utf-8")
    except BaseException:
        # Remove an unfinished class, so that the folder is empty for the next attempt.
        for entry in path.iterdir() if path.is_dir() else ():
            shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
        if made_folder and path.is_dir():
            path.rmdir()
        raise
    return NewClass(path, tuple(sources), timezone)


def machine_timezone() -> str:
    """Return the name of this machine's time zone; ``UTC`` if it has no name (see ``man 5 localtime``)."""
    linked = os.path.realpath("/etc/localtime").partition("/zoneinfo/")[2]
    name = os.environ.get("TZ", "").removeprefix(":") or linked
    return name if name in available_timezones() else "UTC"


def _check_place(path: Path, course_root: Path) -> None:
    refuse_students_folder(path)
    if path.is_symlink() or (path.exists() and not path.is_dir()):
        raise GradingError(f"{path} already exists and is not a folder. Choose another name.")
    if path.is_dir() and any(path.iterdir()):
        raise GradingError(
            f"{path} is not empty. Choose another name, or grade the class in it: {course_command('grade', path)}"
        )
    repository = course_root.resolve()
    place = path.resolve()
    if place.is_relative_to(repository) and place != repository / DEMO_NAME:
        raise GradingError(
            f"{path} lies inside the course's repository, where students' work could be committed "
            f"by mistake. Choose a folder outside of {repository}."
        )


Sources = dict[str, "tuple[Path, NotebookNode]"]
"""For each assignment, the path of its master, and the source notebook made from the master."""


def _sources_of(course_root: Path, wanted: Sequence[str]) -> Sources:
    """Return the masters for a class's assignments, and a source notebook made from each.

    Args:
        course_root: The top folder of the course, which contains ``solutions``.
        wanted: The names of the assignments; by default all labs with a graded cell.

    Raises:
        GradingError: An assignment does not exist, or its master cannot be used.
    """
    try:
        labs = {lab_name(master): master for master in masters(course_root)}
        check_known(wanted, labs, "lab of the course")
        sources = {name: (labs[name], source_notebook(labs[name])) for name in wanted or labs}
    except MasterError as error:
        raise GradingError(str(error)) from error
    return {
        name: (master, notebook)
        for name, (master, notebook) in sources.items()
        if wanted or any(cell.metadata.get("nbgrader", {}).get("grade") for cell in notebook.cells)
    }


def _fill(path: Path, sources: Sources, config: str) -> None:
    (path / CONFIG_NAME).write_text(config, encoding="utf-8")
    (path / "submitted").mkdir()
    (path / STATE_NAME).mkdir(mode=0o700)
    create_secret(path / STATE_NAME / "secret")
    # Students' work, points and the secret must not be committed to a repository.
    (path / ".gitignore").write_text("*\n", encoding="utf-8")
    if IS_CLONE:  # so that `./course week` can be typed in the folder of the class
        launcher = path / "course"
        launcher.write_text(f'#!/bin/sh\nexec {shlex.quote(str(ROOT / "course"))} "$@"\n', encoding="utf-8")
        launcher.chmod(0o755)
    for name, (_, notebook) in sources.items():
        (path / "source" / name).mkdir(parents=True)
        _write_source(ClassDirectory(path), name, notebook, sources)
    release(ClassDirectory(path))
    with ClassStore(ClassDirectory(path)) as store:
        note_origins(store, sources)


def _write_source(
    directory: ClassDirectory, name: str, notebook: NotebookNode, assignments: Container[str]
) -> None:
    """Write a source notebook into a class, and adapt its links to other notebooks.

    The links have to change, because in a class, unlike in the course, each notebook has a folder of its own. A link to
    a notebook that the class does not have becomes plain text.

    Args:
        directory: The class. The assignment's folder must exist.
        notebook: The source notebook, made from the master.
        assignments: The names of all assignments of the class.

    Raises:
        OSError: The file could not be written.
    """

    def in_a_class(other: str) -> str:
        return f"../{other}/{other}.ipynb" if other in assignments else ""

    # The caller still needs the notebook as the master makes it: its digest is recorded as the origin.
    linked = copy.deepcopy(notebook)
    for cell in linked.cells:
        if cell.cell_type == "markdown":
            cell.source = relinked(cell.source, in_a_class)
    (directory.path / "source" / name / f"{name}{SUFFIX}").write_text(
        nbformat_nodes.text(linked), encoding="utf-8"
    )


def release(directory: ClassDirectory, assignments: Sequence[str] = ()) -> None:
    """Make the notebooks for students in ``release``, as ``nbgrader generate_assignment`` does.

    Args:
        assignments: The names of the assignments to release; by default all of the class.

    Raises:
        GradingError: nbgrader failed; the details are in the class's ``nbgrader.log``.
    """
    for assignment in assignments or directory.assignments():
        course = CourseDirectory(config=directory.config)
        course.assignment_id = assignment
        converter = GenerateAssignment(coursedir=course, config=directory.config)
        converter.force = True
        try:
            with quiet(directory.state), _version_read_here():
                converter.start()
        except Exception as error:
            raise GradingError(
                f"nbgrader could not generate the assignment {assignment}: {error}. "
                f"See {directory.state / 'nbgrader.log'}."
            ) from error


def renew(path: Path, course_root: Path, assignments: Sequence[str] = ()) -> list[str]:
    """Make the notebooks in ``source`` and ``release`` of a class again from the course's masters.

    Args:
        path: The class directory.
        course_root: The top folder of the course, which contains ``solutions``.
        assignments: The names of the assignments to renew; by default all that the course has.

    Returns:
        A line of text for each renewed assignment, and a line with the folder of the earlier notebooks.

    Raises:
        GradingError: The course or the class does not have an assignment, they have no assignment in common, or
            nbgrader rejects a notebook.
        OSError: The notebooks could not be written. After any error, the notebooks in ``source`` are unchanged.
    """
    directory = ClassDirectory(path)
    names = directory.assignments()
    check_known(assignments, names, "assignment of the class")
    sources = {name: one for name, one in _sources_of(course_root, assignments).items() if name in names}
    if not sources:
        raise GradingError(
            f"The class has only assignments that the course does not have: {', '.join(names)}."
        )
    backup = directory.state / "sources-before" / f"{datetime.now(tz=UTC):%Y-%m-%dT%H-%M-%S.%f}"
    with directory.lock(), ClassStore(directory) as store:
        for name in sources:
            shutil.copytree(directory.path / "source" / name, backup / name)
        try:
            for name, (_, notebook) in sources.items():
                _write_source(directory, name, notebook, names)
            release(directory, list(sources))
        except BaseException:  # restore the earlier notebooks after any error, also after Ctrl-C
            for name in sources:
                shutil.copytree(backup / name, directory.path / "source" / name, dirs_exist_ok=True)
            raise
        note_origins(store, sources)
    lines = [
        f"{name}: updated from the course; give students the new version: {directory.path / 'release' / name}"
        for name in sources
    ]
    return [*lines, f"the earlier source notebooks are in {backup}"]


@contextlib.contextmanager
def _version_read_here() -> Iterator[None]:
    """During the block, replace nbgrader's slow way to find the version of the gradebook's tables.

    For each new gradebook, nbgrader starts an Alembic command (``nbgrader.api.get_alembic_version``), which takes four
    seconds of processor time. Instead, the files that this command reads are read in this process, which is much
    faster.
    """
    theirs = api.get_alembic_version
    api.get_alembic_version = _newest_version
    try:
        yield
    finally:
        api.get_alembic_version = theirs


def _newest_version() -> str:
    """Return the version of the database tables in the installed nbgrader."""
    settings = Config()
    settings.set_main_option("script_location", dbutil.ALEMBIC_DIR.replace("%", "%%"))
    return str(ScriptDirectory.from_config(settings).get_current_head())
