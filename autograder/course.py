"""Finds the course's own files: its chapters, and the labs of a chapter in order."""

from __future__ import annotations

import os
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import re2

if TYPE_CHECKING:
    from collections.abc import Sequence

VARIABLE = "AUTOGRADER_COURSE"
"""The environment variable for the path of the top folder of a course that does not contain this package."""
SOLUTIONS = "solutions"
"""The name of the folder that contains the chapters as authors write them."""
HANDED_OUT = "exercises"
"""The name of the folder that replaces ``solutions`` in a hand-out. It contains the judge's part of the chapters,
without masters.
"""
CHAPTERS = "chapters"
"""The name of the folder with the notebooks that students open. It has one folder for each chapter."""
CHAPTER = "chapter.toml"
"""The name of the file that describes a chapter beyond what the folders of its labs show."""
INTERFACES = "interfaces"
"""The name of a chapter's folder for interface packages, which the course's set-up builds."""
GITHUB = "https://github.com/"
BRANCH = "main"
"""The branch of the course's repository that links for readers open."""
COPY = "(your copy,"
"""The words by which a copy that `./course reset` kept is recognized; they are in its file name."""
LAB = "lab.md"
"""The name of the master in a lab's folder. The lab's notebook is derived from it."""
WHY = ".why.md"
"""The suffix of the file, next to an exercise, that contains the reasons for its reference solution."""
SOLUTION = ".solution.json"
"""The suffix of the file with an exercise's solution and its reasons, which students see with full marks."""


class NoCourse(LookupError):
    """No course, that is, no folder with ``solutions/`` and ``chapters/``, was found."""


class BrokenChapter(Exception):
    """The description of a chapter cannot be used. The message names the file and what is wrong."""


@dataclass(frozen=True)
class Chapter:
    """A chapter of the course.

    Attributes:
        folder: The folder that contains the chapter's description and a folder for each lab.
        title: The title of the chapter.
        labs: The folders of the chapter's labs, in reading order. Labs that the description does not name come last.
        exercises: For a lab whose exercises are not done in alphabetical order, their names in the right order.
        interfaces: The interface packages that come with the chapter, for its nodes to import. The course's set-up
            builds each, from the chapter's folder ``interfaces`` or from the course's environment.
    """

    folder: Path
    title: str
    labs: tuple[Path, ...]
    exercises: dict[str, tuple[str, ...]]
    interfaces: tuple[str, ...]

    def in_order(self, lab: Path, files: Sequence[Path]) -> list[Path]:
        """Return the files of a lab's exercises in the order in which they are done."""
        wanted = self.exercises.get(lab.name, ())
        return sorted(files, key=lambda file: wanted.index(file.stem) if file.stem in wanted else len(wanted))

    def exercises_of(self, lab: Path) -> dict[str, Path]:
        """Return the files of a lab's exercises by id, in the order in which they are done."""
        return {f"{lab.name}.{file.stem}": file for file in self.in_order(lab, sorted(lab.glob("[!_]*.py")))}


def root() -> Path:
    """Return the top folder of the course.

    It is the folder that the environment variable ``AUTOGRADER_COURSE`` names, or else the clone that contains this
    package.

    Raises:
        NoCourse: No course was found.
    """
    named = os.environ.get(VARIABLE)
    folder = Path(named or Path(__file__).resolve().parents[1]).absolute()
    if _written(folder).is_dir():
        return folder
    if named:
        raise NoCourse(f"{VARIABLE} is {folder}, which contains no folder {SOLUTIONS}")
    raise NoCourse(
        f"no course was found here: go to a folder with {SOLUTIONS}/ in it, or set {VARIABLE} to such a folder"
    )


def use(folder: Path) -> None:
    """Use a course in this process and its children, unless the environment names one or one contains this package."""
    if VARIABLE not in os.environ and not _written(Path(__file__).resolve().parents[1]).is_dir():
        os.environ[VARIABLE] = str(folder)


def use_the_one_around(folder: Path) -> None:
    """Use the course that contains a folder, if there is one, in this process and its children.

    This is meant for commands that run their user's own code. A command for a class must never search for a course,
    because a student's folder could contain one, too.
    """
    for candidate in (folder, *folder.parents):
        if _written(candidate).is_dir():
            use(candidate)
            return


def variables() -> dict[str, str]:
    """Return the environment variables with which another process finds the same course. No student's box gets them."""
    return {VARIABLE: str(root())}


def repository(folder: Path) -> str:
    """Return the address of a course's public repository, ``https://github.com/OWNER/NAME``; empty if it has none.

    The address is ``Repository`` in the table ``[project.urls]`` of the course's pyproject.toml, and is written
    nowhere else.

    Args:
        folder: The top folder of the course.

    Raises:
        BrokenChapter: The file cannot be read, or the address has another form.
    """
    file = folder / "pyproject.toml"
    try:
        said = tomllib.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    except (OSError, ValueError) as error:
        raise BrokenChapter(f"{file} cannot be read: {error}") from error
    address = str(said.get("project", {}).get("urls", {}).get("Repository", "")).removesuffix("/")
    name = address.removeprefix(GITHUB).removesuffix(".git")
    if not address:
        return ""
    if not address.startswith(GITHUB) or not re2.fullmatch(r"[\w.-]+/[\w.-]+", name):
        raise BrokenChapter(f"{file}: Repository is {address!r}, and has to be like {GITHUB}OWNER/NAME")
    return GITHUB + name


def archive(address: str) -> str:
    """Return the address of a zip with all files of a repository."""
    return f"{address}/archive/refs/heads/{BRANCH}.zip"


def chapters(folder: Path) -> tuple[Chapter, ...]:
    """Return the chapters of a course, sorted by the names of their folders.

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
    """Return the folder that contains the chapters: the authors' own folder, or that of a hand-out."""
    solutions, handed_out = folder / SOLUTIONS, folder / HANDED_OUT
    return handed_out if handed_out.is_dir() and not solutions.is_dir() else solutions


def released(lab: Path) -> Path:
    """Return the path of a lab's released notebook in a hand-out."""
    return lab / f"{lab.name}.ipynb"


def interfaces() -> tuple[str, ...]:
    """Return the interface packages that come with the course."""
    return tuple(name for chapter in chapters(root()) for name in chapter.interfaces)


def interface_modules() -> tuple[str, ...]:
    """Return the names of modules that may contain classes of these packages. A package need not have all of them."""
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
            f"{file}: title must be a text; labs, interfaces and each lab of the table exercises must be lists of names"
        )
    return said


def _are_names(said: object) -> bool:
    return isinstance(said, list) and all(isinstance(name, str) for name in said)


def _is_lab(folder: Path) -> bool:
    # A hand-out contains exercises and released notebooks but no masters.
    return folder.is_dir() and (
        (folder / LAB).is_file() or released(folder).is_file() or any(folder.glob("*.py"))
    )
