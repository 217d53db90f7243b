"""Reads a class directory: its configuration, secret, assignments and submissions."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

import msgspec
from traitlets.config.loader import PyFileConfigLoader

from autograder import course
from autograder.command_name import COMMAND
from autograder.grading.classes.class_file import NAME as CLASS_FILE
from autograder.grading.classes.class_file import read_class_file, read_overlays
from autograder.grading.classes.class_lock import held
from autograder.grading.classes.class_secret import create_secret, read_secret
from autograder.grading.classes.student_folders import RefusedFile, folders_in, odd_files
from autograder.grading.grading_errors import GradingError, NotAClass, clear_disk_errors
from autograder.safe_files import remove_unfinished
from autograder.student import known_classes
from course_runtime.own_interfaces import CannotBuildInterfaces, built_interfaces

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from datetime import datetime, tzinfo

    from nbformat import NotebookNode
    from traitlets.config import Config

    from autograder.grading.rebuilding.named_cells import NamedCells


CONFIG_NAME = known_classes.CONFIG_NAME
STATE_NAME = ".autograder"
COURSE_NAME = "course"
"""The name of a file in the class's state folder. The file contains the path of the course's top folder, because an
installed package cannot find that folder otherwise.
"""
SUFFIX = ".ipynb"
TIMESTAMP = "timestamp.txt"
"""The name of nbgrader's timestamp file, which lies next to the notebooks of a submission."""
_STUDENTS_FILES = ("submitted", "autograded", "feedback", "downloaded")
"""nbgrader's names for the folders of a class that contain students' files."""


@dataclass(frozen=True)
class Submission:
    """The folder with the files that one student submitted for one assignment."""

    student: str
    assignment: str
    folder: Path

    @property
    def key(self) -> tuple[str, str]:
        """The student and the assignment, which together identify the submission in the gradebook."""
        return self.student, self.assignment

    @property
    def label(self) -> str:
        """The name of the submission in messages, such as ``ada/lab_1_2``."""
        return f"{self.student}/{self.assignment}"


class ClassDirectory:
    """An nbgrader course directory, which this package grades.

    Args:
        path: The folder that contains ``nbgrader_config.py``.

    Raises:
        NotAClass: The folder is not a class; the message says what is missing.
    """

    def __init__(self, path: Path) -> None:
        self.path = path.absolute()
        if not self.path.is_dir():
            raise NotAClass(path, "the folder does not exist")
        if not (self.path / CONFIG_NAME).is_file():
            raise NotAClass(path, f"the folder contains no {CONFIG_NAME}")
        if not (self.path / "source").is_dir():
            raise NotAClass(path, "the folder contains no folder named source")
        refuse_students_folder(self.path)
        with contextlib.suppress(OSError):
            course.use(Path((self.state / COURSE_NAME).read_text(encoding="utf-8")))

    @property
    def state(self) -> Path:
        """The folder ``.autograder`` for the grader's own files about the class: secret, lock, store and log."""
        return self.path / STATE_NAME

    @property
    def gradebook_url(self) -> str:
        """The database URL with which SQLAlchemy opens the gradebook."""
        return str(
            self._as_written.CourseDirectory.get("db_url") or f"sqlite:///{self.path / 'gradebook.db'}"
        )

    @functools.cached_property
    def config(self) -> Config:
        """The class's nbgrader configuration, with the present path of the class as ``CourseDirectory.root``.

        Raises:
            GradingError: The configuration is not valid Python, or does not use the judge for grading.
        """
        config = self._as_written
        steps = [str(step) for step in config.Autograde.get("autograde_preprocessors", ())]
        if not any("WireExecute" in step for step in steps):
            raise GradingError(
                f"{self.path / CONFIG_NAME} does not use the judge for grading. Make another class with "
                f"`{COMMAND} new-class` and copy the lines with c.Autograde from its {CONFIG_NAME}."
            )
        url = str(config.CourseDirectory.get("db_url") or "sqlite:")
        if not url.startswith("sqlite:") and not config.CourseDirectory.get("course_id"):
            # nbgrader stores the course's id as a foreign key. If no id is set, only SQLite accepts this key.
            raise GradingError(
                f"A gradebook on a database server needs a name of the course. Add a line to "
                f'{self.path / CONFIG_NAME}: c.CourseDirectory.course_id = "ros2"'
            )
        config.CourseDirectory.root = str(self.path)
        self._take_late_rule(config)
        return config

    def _take_late_rule(self, config: Config) -> None:
        """Give nbgrader the late rule of ``class.toml``.

        Raises:
            GradingError: The configuration has a late rule, too.
        """
        rule = read_class_file(self.path).late
        if rule is None:
            return
        for section in ("LatePolicy", "LateSubmissionPlugin", "AssignLatePenalties"):
            if options := config.get(section):
                option, value = next(iter(options.items()))
                raise GradingError(
                    f"Both {self.path / CONFIG_NAME} and {CLASS_FILE} have a late rule. Remove c.{section}.{option} = "
                    f"{value!r} from {CONFIG_NAME}; what is to stay of it belongs under [late] in {CLASS_FILE}: "
                    "percent_per_day, grace_minutes and cut_off_days."
                )
        config.AssignLatePenalties.plugin_class = "autograder.grading.table.late_policy.LatePolicy"
        config.LatePolicy.update(msgspec.structs.asdict(rule))

    @functools.cached_property
    def overlays(self) -> tuple[Path, ...]:
        """The installed workspaces that every box of the class sees.

        They are those that ``class.toml`` names, and the interface packages of a course in a repository of its own.

        Raises:
            GradingError: The file cannot be used, or names something else; or a package cannot be built.
        """
        try:
            return (*read_overlays(self.path), *built_interfaces(course.root()))
        except CannotBuildInterfaces as error:
            raise GradingError(str(error)) from error

    @property
    def time_zone(self) -> ZoneInfo:
        """The time zone of due dates in formgrader, and of all times that this package shows.

        nbgrader's option ``c.NbGraderAPI.timezone`` sets it; the default is UTC.

        Raises:
            GradingError: The zone does not exist.
        """
        name = self._as_written.NbGraderAPI.get("timezone") or "UTC"
        try:
            return ZoneInfo(str(name))
        except (ValueError, OSError, LookupError) as error:
            raise GradingError(
                f"{self.path / CONFIG_NAME} sets c.NbGraderAPI.timezone to {name!r}, but that zone does not exist. "
                "A name looks like Europe/Berlin."
            ) from error

    @property
    def is_sandbox_off(self) -> bool:
        """True if this class is graded without boxes, by its configuration or :func:`switch_sandbox_off`."""
        configured = self.config.WireExecute.get("unsafe_no_sandbox", False)
        return bool(configured) or self.path.resolve() in _unboxed

    @functools.cached_property
    def _as_written(self) -> Config:
        known_classes.remember(self.path)
        try:
            return PyFileConfigLoader(CONFIG_NAME, path=str(self.path)).load_config()
        except Exception as error:  # the configuration file is a program, so it may raise any error
            raise GradingError(
                f"{self.path / CONFIG_NAME} cannot be read: {type(error).__name__}: {error}"
            ) from error

    @functools.cached_property
    def secret(self) -> bytes:
        """The secret of the class, which is made and stored at its first use.

        Raises:
            GradingError: The file of the secret is damaged.
        """
        path = self.state / "secret"
        try:
            if not path.exists():
                path.parent.mkdir(exist_ok=True)
                create_secret(path)
            return read_secret(path)
        except ValueError as error:
            raise GradingError(
                f"{path} is damaged ({error}). Restore a backup of the file, or delete the file. "
                "After deleting it, every student gets different random inputs."
            ) from error

    def assignments(self) -> list[str]:
        """Return the names of the class's assignments, sorted."""
        return sorted(
            folder.name for folder in (self.path / "source").iterdir() if any(folder.glob(f"*{SUFFIX}"))
        )

    def notebooks(self, assignment: str) -> list[str]:
        """Return the names of an assignment's notebooks, sorted."""
        return sorted(path.stem for path in (self.path / "source" / assignment).glob(f"*{SUFFIX}"))

    def title(self, assignment: str, notebook: str) -> str:
        """Return the heading of a notebook; its name if the notebook does not begin with one."""
        try:
            file = self.path / "source" / assignment / f"{notebook}{SUFFIX}"
            lines = json.loads(file.read_bytes())["cells"][0]["source"]
        except (OSError, ValueError, LookupError, TypeError):
            return notebook
        first = "".join(lines).partition("\n")[0]
        return first.removeprefix("# ") if first.startswith("# ") else notebook

    def master(self, assignment: str, notebook: str) -> NotebookNode:
        """Return the trusted master of a notebook.

        Raises:
            MasterUnusable: The source notebook cannot be used for grading.
        """
        from autograder.grading.rebuilding.trusted_master import read_master

        return read_master(self.path / "source" / assignment / f"{notebook}{SUFFIX}", self.config)

    @functools.cached_property
    def named_cells(self) -> NamedCells:
        """The names of the cells in all source notebooks of the class."""
        from autograder.grading.rebuilding.named_cells import NamedCells

        return NamedCells(
            {
                (assignment, notebook): self.path / "source" / assignment / f"{notebook}{SUFFIX}"
                for assignment in self.assignments()
                for notebook in self.notebooks(assignment)
            }
        )

    def files(self, assignment: str) -> dict[str, bytes]:
        """Return the files next to an assignment's source notebooks, by relative path."""
        folder = self.path / "source" / assignment
        paths = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.suffix != SUFFIX)
        return {
            str(path.relative_to(folder)): path.read_bytes()
            for path in paths
            if not any(
                part.startswith(".") or part == "__pycache__" for part in path.relative_to(folder).parts
            )
        }

    def submissions(self) -> tuple[list[Submission], list[RefusedFile]]:
        """Return the submissions in ``submitted``, and the files and folders there that cannot be graded.

        A submission whose notebook is not an ordinary file, for example a link, is in both lists: it gets zero points,
        and the instructor gets a line with the reason.
        """
        notebooks = {assignment: self.notebooks(assignment) for assignment in self.assignments()}
        taken: list[Submission] = []
        refused: list[RefusedFile] = []
        for student in folders_in(self.path / "submitted", refused):
            for folder in folders_in(student, refused):
                if folder.name in notebooks:
                    taken.append(Submission(student.name, folder.name, folder))
                    refused += odd_files(folder / f"{name}{SUFFIX}" for name in notebooks[folder.name])
                else:
                    names = ", ".join(notebooks) or "none"
                    refused.append(
                        RefusedFile(
                            folder,
                            f"the class has no assignment with this name (the class's assignments: {names})",
                        )
                    )
        return taken, refused

    def folder(self, step: str, submission: Submission) -> Path:
        """Return the folder of a submission in ``autograded`` or ``feedback``."""
        return self.path / step / submission.student / submission.assignment

    def has_converted(self, submission: Submission, notebooks: Iterable[str]) -> bool:
        """Return True if ``autograded`` contains all of these notebooks of a submission."""
        folder = self.folder("autograded", submission)
        return all((folder / f"{notebook}{SUFFIX}").is_file() for notebook in notebooks)

    def has_pages(self, submission: Submission, notebooks: Iterable[str]) -> bool:
        """Return True if ``feedback`` contains a page for each of these notebooks of a submission."""
        folder = self.folder("feedback", submission)
        return all((folder / f"{notebook}.html").is_file() for notebook in notebooks)

    @contextlib.contextmanager
    def lock(self) -> Iterator[None]:
        """Lock the class during the block, so that only one process grades it.

        If the previous holder of the lock was killed, remove its unfinished files before the block. The lock ends with
        this process, even if the process is killed.

        Raises:
            ClassBusy: Another process holds the lock.
            GradingError: The disk or the gradebook failed in the block.
        """
        with clear_disk_errors(self.path):
            self.state.mkdir(mode=0o700, exist_ok=True)
            with held(self.state / "lock", self.path) as was_killed:
                if was_killed:
                    remove_unfinished(self.path)
                yield

    @property
    def scratch_prefix(self) -> str:
        """The prefix of this class's temporary folders, which is short because the path of a socket must be short."""
        return f"autograder-{hashlib.sha256(str(self.path).encode()).hexdigest()[:8]}-"


_unboxed: set[Path] = set()
"""The folders of the classes that this process grades without boxes. Folders are stored, and not ``ClassDirectory``
objects, because several such objects may represent one class.
"""


def switch_sandbox_off(path: Path) -> None:
    """Let this process grade the class in the folder ``path`` without boxes, as ``--unsafe-no-sandbox`` does."""
    _unboxed.add(path.resolve())


def refuse_students_folder(folder: Path) -> None:
    """Raise an error if a folder is inside a class's folder for students' files.

    Otherwise, a student could hand in a class directory, and a command would run its configuration file, which is a
    program.

    Raises:
        GradingError: The folder is among students' files, in the class that the message names.
    """
    place = folder.resolve()
    for outer in place.parents:
        if place.relative_to(outer).parts[0] in _STUDENTS_FILES and (outer / CONFIG_NAME).is_file():
            raise GradingError(
                f"{folder} is among students' files, so it cannot be a class. Use the class that contains it: "
                f"{outer}"
            )


def timestamp_text(when: datetime) -> str:
    """Return a time as text in the format of nbgrader's timestamp file.

    Args:
        when: A time in UTC.
    """
    return f"{when:%Y-%m-%d %H:%M:%S.%f} UTC"


def in_zone(when: datetime, zone: tzinfo) -> str:
    """Return a time as text in a time zone, such as ``2026-01-31 12:00 Europe/Berlin``."""
    return f"{when.astimezone(zone):%Y-%m-%d %H:%M} {zone}"
