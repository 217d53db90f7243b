"""The places of the course's own files: its chapters, and the labs of a chapter in their order."""

from __future__ import annotations

import os
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

VARIABLE = "AUTOGRADER_COURSE"
"""Names the top folder of a course that is elsewhere than the package."""
SOLUTIONS = "solutions"
"""The folder of the chapters as their authors write them."""
HANDED_OUT = "exercises"
"""The folder in its place in what students are handed: the judge's part of the chapters, and no master."""
CHAPTERS = "chapters"
"""The folder of the notebooks that students open, one folder a chapter."""
CHAPTER = "chapter.toml"
"""The file of facts about a chapter that the folders of its labs do not show."""
INTERFACES = "interfaces"
"""The folder of a chapter with its own packages of interfaces, which the set-up of the course builds."""
COPY = "(your copy,"
"""In the name of each notebook that `./course reset` has kept."""
LAB = "lab.md"
"""The master in a lab's folder, from which its notebook is derived."""
WHY = ".why.md"
"""The ending of the file beside an exercise that says why its reference solution is written so."""
SOLUTION = ".solution.json"
"""The ending of the file that is derived from that and from the master, for students with full marks."""


class NoCourse(LookupError):
    """The folder with ``solutions/`` and ``chapters/`` was not found."""


class BrokenChapter(Exception):
    """A chapter's description cannot be used. The message names the file and what is wrong."""


@dataclass(frozen=True)
class Chapter:
    """A chapter of the course.

    Attributes:
        folder: With its description, and a folder for each lab.
        title: Of the chapter.
        labs: The folders of its labs, in the order in which they are read. Those that the description does not name
            come last.
        exercises: For a lab, the names of its exercises in the order in which they are done, where that is not the
            order of the alphabet.
        interfaces: The packages with interfaces that come with the chapter, for its nodes to import. The set-up builds
            each, from the chapter's folder ``interfaces`` or from the course's environment.
    """

    folder: Path
    title: str
    labs: tuple[Path, ...]
    exercises: dict[str, tuple[str, ...]]
    interfaces: tuple[str, ...]

    def in_order(self, lab: Path, files: Sequence[Path]) -> list[Path]:
        """The files of a lab's exercises in the order in which they are done."""
        wanted = self.exercises.get(lab.name, ())
        return sorted(files, key=lambda file: wanted.index(file.stem) if file.stem in wanted else len(wanted))

    def exercises_of(self, lab: Path) -> dict[str, Path]:
        """The files of a lab's exercises by their ids, in the order in which they are done."""
        return {f"{lab.name}.{file.stem}": file for file in self.in_order(lab, sorted(lab.glob("[!_]*.py")))}


def root() -> Path:
    """Return the top folder of the course.

    It is the folder in the environment variable ``AUTOGRADER_COURSE``, or else the clone that this package is in.

    Raises:
        NoCourse: There is no course.
    """
    named = os.environ.get(VARIABLE)
    folder = Path(named or Path(__file__).resolve().parents[1]).absolute()
    if _written(folder).is_dir():
        return folder
    if named:
        raise NoCourse(f"{VARIABLE} is {folder}, and there is no folder {SOLUTIONS} in it")
    raise NoCourse(
        f"there is no course here: go to a folder with {SOLUTIONS}/ in it, or set {VARIABLE} to such a folder"
    )


def use(folder: Path) -> None:
    """Use a course from now on, in this process and its children, if none is named and this package is in none."""
    if VARIABLE not in os.environ and not _written(Path(__file__).resolve().parents[1]).is_dir():
        os.environ[VARIABLE] = str(folder)


def use_the_one_around(folder: Path) -> None:
    """Use the course that a folder is in, if it is in one.

    For commands that run what their user wrote. A command for a class never looks around: a student's folder could
    hold a course, too.
    """
    for candidate in (folder, *folder.parents):
        if _written(candidate).is_dir():
            use(candidate)
            return


def variables() -> dict[str, str]:
    """The variables with which another process finds the same course. No box of a student's gets it."""
    return {VARIABLE: str(root())}


def chapters(folder: Path) -> tuple[Chapter, ...]:
    """The chapters of a course, in the order of their folders' names.

    Args:
        folder: The top folder of the course.

    Raises:
        BrokenChapter: A description cannot be used.
    """
    written = _written(folder)
    found = {file.parent for file in written.glob(f"*/{CHAPTER}")}
    found |= {file.parents[1] for file in written.glob(f"*/*/{LAB}")}
    return tuple(_chapter(chapter) for chapter in sorted(found))


def _written(folder: Path) -> Path:
    """The folder of the chapters: the authors' own, or that of what students are handed."""
    solutions, handed_out = folder / SOLUTIONS, folder / HANDED_OUT
    return handed_out if handed_out.is_dir() and not solutions.is_dir() else solutions


def released(lab: Path) -> Path:
    """The path of a lab's notebook as it was released, in what students are handed."""
    return lab / f"{lab.name}.ipynb"


def interfaces() -> tuple[str, ...]:
    """The packages with interfaces that come with the course."""
    return tuple(name for chapter in chapters(root()) for name in chapter.interfaces)


def interface_modules() -> tuple[str, ...]:
    """The modules in which their classes may be; a package need not have all three kinds."""
    return tuple(f"{package}.{kind}" for package in interfaces() for kind in ("msg", "srv", "action"))


def _chapter(folder: Path) -> Chapter:
    said = _description(folder / CHAPTER)
    present = {lab.name: lab for lab in sorted(folder.iterdir()) if _is_lab(lab)}
    order = [name for name in said.get("labs", ()) if name in present]
    return Chapter(
        folder,
        said.get("title", folder.name),
        tuple(present[name] for name in dict.fromkeys((*order, *present))),
        {lab: tuple(names) for lab, names in said.get("exercises", {}).items()},
        tuple(said.get("interfaces", ())),
    )


def _description(file: Path) -> dict[str, Any]:
    try:
        said = tomllib.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise BrokenChapter(f"{file} cannot be read: {error}") from error
    orders = said.get("exercises", {})
    named = isinstance(orders, dict) and all(
        map(_are_names, (said.get("labs", []), said.get("interfaces", []), *orders.values()))
    )
    if not named or not isinstance(said.get("title", ""), str):
        raise BrokenChapter(
            f"{file}: title is a text; labs, interfaces and each lab of the table exercises are lists of names"
        )
    return said


def _are_names(said: object) -> bool:
    return isinstance(said, list) and all(isinstance(name, str) for name in said)


def _is_lab(folder: Path) -> bool:
    # What students are handed has exercises and the notebook as it was released, and no master.
    return folder.is_dir() and (
        (folder / LAB).is_file() or released(folder).is_file() or any(folder.glob("*.py"))
    )
