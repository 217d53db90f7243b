"""A student's progress: chapters, notebooks and exercises in order, with their points, and the page that shows them.

The course page is made as an HTML file that loads nothing else, and as text for a terminal.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any, Literal
from urllib.parse import quote

from autograder import check_journal, course, exercises
from autograder.cards.card_wording import points, points_of, with_solution
from autograder.cards.certificate import Certificate
from autograder.command_name import COMMAND
from autograder.student.lab import COURSE_PAGE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from jinja2 import Environment

    from autograder.check_journal import JournalEntry


State = Literal["new", "begun", "done"]


@dataclass(frozen=True)
class _ExerciseStanding:
    """An exercise, with the student's best check.

    Attributes:
        id: The exercise's id, such as ``"lab_1_2.talker"``.
        title: The title for people.
        points: The points of the best check.
        possible: The maximum points of the exercise.
        helped: True if the student had opened the worked solution before this check.
    """

    id: str
    title: str
    points: float
    possible: float
    helped: bool


@dataclass(frozen=True)
class NotebookStanding:
    """A notebook of a chapter, with the student's progress.

    Attributes:
        name: The name, such as ``"lab_1_2"``.
        title: The heading of the notebook.
        minutes: The time that it takes in minutes, as its first cell says; 0 if the cell does not say.
        path: The path relative to the folder of the notebooks; empty if the file does not exist.
        exercises: The exercises, in the order in which they are done.
        read: True if the student has marked it as read.
        touched: True if the notebook can be reset, because the student has checked, marked or changed something in it.
        worked: The Unix time in seconds at which the student last checked, marked, reset or saved it; 0 for never.
    """

    name: str
    title: str
    minutes: int
    path: str
    exercises: tuple[_ExerciseStanding, ...]
    read: bool
    touched: bool
    worked: float

    @property
    def points(self) -> float:
        """The points that were reached."""
        return sum(one.points for one in self.exercises)

    @property
    def possible(self) -> float:
        """The maximum points; 0 for a notebook that is only read."""
        return sum(one.possible for one in self.exercises)

    @property
    def helped(self) -> int:
        """The number of exercises whose points were reached with the worked solution."""
        return sum(one.helped for one in self.exercises)

    @property
    def state(self) -> State:
        """The state. A notebook is done if it has all points or, if it has no exercises, is marked as read."""
        if self.possible == 0:
            return "done" if self.read else "new"
        return "done" if self.points >= self.possible else "begun" if self.points > 0 else "new"


@dataclass(frozen=True)
class ChapterStanding:
    """A chapter, with the student's progress.

    Attributes:
        name: The name of the chapter's folder.
        title: The title for people.
        notebooks: The notebooks, in reading order.
        finished: The Unix time in seconds at which all points were reached; None if they have not been reached.
    """

    name: str
    title: str
    notebooks: tuple[NotebookStanding, ...]
    finished: float | None

    @property
    def points(self) -> float:
        """The points that were reached."""
        return sum(one.points for one in self.notebooks)

    @property
    def possible(self) -> float:
        """The maximum points."""
        return sum(one.possible for one in self.notebooks)

    @property
    def helped(self) -> int:
        """The number of exercises whose points were reached with the worked solution."""
        return sum(one.helped for one in self.notebooks)

    @property
    def certificate(self) -> Certificate | None:
        """The certificate; None if points are missing."""
        if self.finished is None:
            return None
        return Certificate(self.title, self.possible, self.finished, self.helped)

    @property
    def done(self) -> int:
        """The number of notebooks that are done."""
        return sum(one.state == "done" for one in self.notebooks)

    @property
    def minutes_left(self) -> int:
        """The total minutes of the notebooks that are not done."""
        return sum(one.minutes for one in self.notebooks if one.state != "done")


@dataclass(frozen=True)
class Standing:
    """The progress of a student.

    Attributes:
        chapters: The chapters, in order.
        following: The notebook to continue with; None if all are done.
        begun: True if the student has begun any notebook.
    """

    chapters: tuple[ChapterStanding, ...]
    following: NotebookStanding | None
    begun: bool


def standing(root: Path, folder: Path, entries: Sequence[JournalEntry]) -> Standing:
    """Return the progress of a student.

    Args:
        root: The top folder of the course.
        folder: The folder of the notebooks.
        entries: The lines of the journal.

    Raises:
        BrokenChapter: A chapter's description cannot be used.
        BrokenExercise: An exercise cannot be used.
    """
    reached = check_journal.best(entries)
    read = {entry.name: entry.kind == "read" for entry in entries if entry.kind != "check"}
    last = {entry.notebook: entry for entry in entries}
    chapters = tuple(_chapter(one, folder, reached, read, last) for one in course.chapters(root))
    notebooks = [notebook for chapter in chapters for notebook in chapter.notebooks]
    begun = any(notebook.worked for notebook in notebooks)
    return Standing(chapters, _following(notebooks), begun)


def _following(notebooks: Sequence[NotebookStanding]) -> NotebookStanding | None:
    """Return the notebook to continue with; None if all are done.

    This is the notebook that the student last worked on. If that is done, it is the next notebook that is not done, in
    reading order; after the last notebook, the search goes on with the first.
    """
    times = [notebook.worked for notebook in notebooks]
    here = times.index(max(times)) if times else 0
    in_order = [*notebooks[here:], *notebooks[:here]]
    return next((notebook for notebook in in_order if notebook.state != "done"), None)


def _chapter(
    chapter: course.Chapter,
    folder: Path,
    reached: dict[str, JournalEntry],
    read: dict[str, bool],
    last: dict[str, JournalEntry],
) -> ChapterStanding:
    notebooks = []
    for lab in chapter.labs:
        title, minutes = _head(lab)
        known = tuple(_exercise(exercise_id, reached) for exercise_id in chapter.exercises_of(lab))
        path = notebook_path(chapter, lab, folder)
        shown = path.relative_to(folder).as_posix() if path.is_file() else ""
        entry, saved = last.get(lab.name), path.stat().st_mtime if _is_changed(path, lab) else 0.0
        touched = bool(saved) or (entry is not None and entry.kind != "reset")
        worked = max(saved, entry.time if entry is not None else 0.0)
        marked = read.get(lab.name, False)
        notebooks.append(NotebookStanding(lab.name, title, minutes, shown, known, marked, touched, worked))
    finished = check_journal.finished(chapter, reached)
    return ChapterStanding(chapter.folder.name, chapter.title, tuple(notebooks), finished)


def _is_changed(notebook: Path, lab: Path) -> bool:
    """Return True if a notebook differs from the released one; False if the released one does not exist."""
    released = course.released(lab)
    return notebook.is_file() and released.is_file() and notebook.read_bytes() != released.read_bytes()


def notebook_path(chapter: course.Chapter, lab: Path, folder: Path) -> Path:
    """Return the path of a lab's notebook in ``folder``, or in the chapter's folder below it. It need not exist."""
    alone = folder / f"{lab.name}.ipynb"
    return alone if alone.is_file() else folder / chapter.folder.name / f"{lab.name}.ipynb"


def _exercise(exercise_id: str, reached: dict[str, JournalEntry]) -> _ExerciseStanding:
    exercise = exercises.get(exercise_id)
    best = reached.get(exercise_id)
    points, helped = (best.points, best.helped) if best else (0.0, False)
    return _ExerciseStanding(
        exercise_id, exercise.title, min(points, exercise.points), exercise.points, helped and points > 0
    )


def _head(lab: Path) -> tuple[str, int]:
    """Return the title of a notebook and its minutes, from its master or from the released notebook."""
    for file in (lab / course.LAB, course.released(lab)):
        if file.is_file():
            return _read_head(file, file.stat().st_mtime_ns)
    return lab.name, 0


@lru_cache(maxsize=200)
def _read_head(file: Path, changed: int) -> tuple[str, int]:
    """Read the title and the minutes. If the time of the file (``changed``) is another one, the file is read again."""
    del changed
    title, minutes = file.parent.name, 0
    for line in _lines(file):
        if line.startswith("# ") and title == file.parent.name:
            title = line[2:].replace("`", "").strip()
        if line.startswith("*"):
            number, _, rest = line[1:].partition(" ")
            if number.isdecimal() and rest.startswith("minutes"):
                return title, int(number)
    return title, minutes


def _lines(file: Path) -> Iterator[str]:
    """Yield the lines of a master, or those of the text cells of a notebook."""
    text = file.read_text(encoding="utf-8")
    if file.suffix != ".ipynb":
        yield from text.splitlines()
        return
    for cell in json.loads(text)["cells"]:
        if cell["cell_type"] == "markdown":
            yield from "".join(cell["source"]).splitlines()


def page_html(standing: Standing, base: str, token: str) -> str:
    """Return the course page as HTML.

    Args:
        base: The base address of the server. It ends with a slash.
        token: Proves to the server that a request comes from this page.
    """
    return _environment().get_template("page.html.j2").render(standing=standing, base=base, token=token)


def trouble_html(message: str, base: str) -> str:
    """Return the page that is shown if the course cannot be read.

    Args:
        message: The reason.
        base: The base address of the server. It ends with a slash.
    """
    return _environment().get_template("trouble.html.j2").render(message=message, base=base)


STATES = {"done": "done", "begun": "begun", "new": "not begun"}


@cache
def _environment() -> Environment:
    from markupsafe import Markup

    from autograder.cards.html_rendering import page_templates

    environment = page_templates("autograder.student")

    def own_file(name: str) -> Markup:
        return Markup(files("autograder.student").joinpath(name).read_text(encoding="utf-8"))

    helpers: dict[str, Any] = {
        "hours": hours,
        "own_file": own_file,
        "page_name": COURSE_PAGE,
        "points": points,
        "points_of": points_of,
        "quote": quote,
        "states": STATES,
        "with_solution": with_solution,
    }
    environment.globals.update(helpers)
    return environment


def standing_text(standing: Standing) -> str:
    """Return the course page as text for a terminal."""
    lines = [line for chapter in standing.chapters for line in (*_chapter_text(chapter), "")]
    if standing.following is not None:
        verb = "Go on" if standing.begun else "Begin"
        lines.append(f"{verb} with {standing.following.title} ({standing.following.name}): {COMMAND} lab")
    lines.append("The points come from your own checks on this machine. They are not a grade.")
    return "\n".join(lines)


MARKS = {"done": "[x]", "begun": "[~]", "new": "[ ]"}


def _chapter_text(chapter: ChapterStanding) -> list[str]:
    width = max((len(one.title) for one in chapter.notebooks), default=0)
    lines = [chapter.title, points_of(chapter.points, chapter.possible), ""]
    for one in chapter.notebooks:
        reached = points_of(one.points, one.possible) if one.possible else "to read"
        reached = ", ".join(filter(None, (reached, with_solution(one.helped))))
        minutes = f"{one.minutes} min" if one.minutes else ""
        lines.append(f"  {MARKS[one.state]} {one.title:<{width}}  {minutes:>7}  {reached}".rstrip())
    if chapter.certificate is not None:
        lines += ["", chapter.certificate.text()]
    elif chapter.minutes_left:
        lines += ["", f"About {hours(chapter.minutes_left)} to go."]
    return lines


def hours(minutes: int) -> str:
    """Return a rounded duration: ``"40 minutes"``, ``"2 hours"``, ``"8½ hours"``."""
    if minutes < 60:
        return f"{minutes} minutes"
    halves = round(minutes / 30)
    number = f"{halves // 2}{'½' if halves % 2 else ''}"
    return f"{number} hour{'' if halves == 2 else 's'}"
