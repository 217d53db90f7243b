"""Finds the files of the course: its chapters, and the labs and exercises of each chapter in order."""

from __future__ import annotations

import os
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import re2

VARIABLE = "AUTOGRADER_COURSE"
"""The environment variable for the path of the course's top folder, if the course does not contain this package."""
SOLUTIONS = "solutions"
"""The name of the folder in which authors write the chapters: masters, exercises and reference outputs."""
HANDED_OUT = "exercises"
"""The name of the folder that replaces ``solutions`` in the copy of a course for students. It contains the files that
the judge needs, and no masters.
"""
CHAPTERS = "chapters"
"""The name of the folder with the notebooks that students open. It has one folder for each chapter."""
CHAPTER = "chapter.toml"
"""The name of the file that describes a chapter: its title, and the order of its labs and exercises."""
INTERFACES = "interfaces"
"""The name of a chapter's folder with interface packages, which are built when the course is set up."""
GITHUB = "https://github.com/"
BRANCH = "main"
"""The branch of the course's repository to which links for readers lead."""
COPY = "(your copy,"
"""A part of the file name of each copy that `./course reset` makes of a student's notebook."""
LAB = "lab.md"
"""The name of the master in a lab's folder, from which the lab's notebook is made."""
WHY = ".why.md"
"""The suffix of the file next to an exercise that explains the reference solution."""
TICKET = ".ticket.toml"
"""The suffix of the file with the words of a ticket, which is two exercises without code: a repair and a question."""
CAUSE = "_why"
"""The end of the name of the exercise that asks for the cause."""
SOLUTION = ".solution.json"
"""The suffix of the file with an exercise's solution and explanation, which students see once they have full marks."""


class NoCourse(LookupError):
    """No course, that is, no folder with ``solutions/`` and ``chapters/``, was found."""


class BrokenChapter(Exception):
    """The description of a chapter is not valid. The message names the file and the fault."""


@dataclass(frozen=True)
class Chapter:
    """A chapter of the course.

    Attributes:
        folder: The folder that contains the chapter's description and a folder for each lab.
        title: The title of the chapter.
        labs: The folders of the chapter's labs, in the order in which students do them. Labs that the description does
            not name come last.
        exercises: The names of a lab's exercises in their order, by lab. A lab with exercises in alphabetical order
            need not be included.
        interfaces: The names of interface packages that the chapter's nodes import. They are built when the course is
            set up, from the chapter's folder ``interfaces`` or from the folder of the course's environment.
    """

    folder: Path
    title: str
    labs: tuple[Path, ...]
    exercises: dict[str, tuple[str, ...]]
    interfaces: tuple[str, ...]

    def exercises_of(self, lab: Path) -> dict[str, Path]:
        """Return the files of a lab's exercises by exercise id, in the order in which students do the exercises.

        An exercise of a ticket has no file; its path is the one that a file would have.
        """
        wanted = self.exercises.get(lab.name, ())
        tickets = {file.name.removesuffix(TICKET) for file in lab.glob(f"*{TICKET}")}
        written = {file.stem for file in lab.glob("[!_]*.py")}
        names = written | {f"{name}{end}" for name in tickets for end in ("", CAUSE)}
        in_order = [*(name for name in wanted if name in names), *sorted(names.difference(wanted))]
        return {f"{lab.name}.{name}": lab / f"{name}.py" for name in in_order}


def root() -> Path:
    """Return the top folder of the course.

    The environment variable ``AUTOGRADER_COURSE`` names this folder. If it is not set, the course is the repository
    that contains this package.

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
    """Use a course in this process and its children, unless ``root()`` already finds another one."""
    if VARIABLE not in os.environ and not _written(Path(__file__).resolve().parents[1]).is_dir():
        os.environ[VARIABLE] = str(folder)


def use_the_one_around(folder: Path) -> None:
    """Use the course that contains a folder, if there is one, in this process and its children.

    Call this only in commands that run the user's own code. A command for a class must not search the folders above for
    a course, because a student's folder could contain a false one.
    """
    for candidate in (folder, *folder.parents):
        if _written(candidate).is_dir():
            use(candidate)
            return


def variables() -> dict[str, str]:
    """Return the environment variables with which another process finds this course. No student's sandbox gets them."""
    return {VARIABLE: str(root())}


def repository(folder: Path) -> str:
    """Return the address of a course's public repository, ``https://github.com/OWNER/NAME``; empty if it has none.

    The address is read from ``Repository`` in the table ``[project.urls]`` of the course's pyproject.toml, the only
    place for it.

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
    """Return the address of a zip file with all files of a repository."""
    return f"{address}/archive/refs/heads/{BRANCH}.zip"


def chapters(folder: Path) -> tuple[Chapter, ...]:
    """Return the chapters of a course, sorted by the names of their folders.

    Args:
        folder: The top folder of the course.

    Raises:
        BrokenChapter: The description of a chapter is not valid.
    """
    written = _written(folder)
    found = {file.parent for file in written.glob(f"*/{CHAPTER}")}
    found |= {file.parents[1] for file in written.glob(f"*/*/{LAB}")}
    return tuple(_chapter(chapter) for chapter in sorted(found))


def _written(folder: Path) -> Path:
    """Return the folder that contains the chapters: ``solutions`` or, in a copy for students, ``exercises``."""
    solutions, handed_out = folder / SOLUTIONS, folder / HANDED_OUT
    return handed_out if handed_out.is_dir() and not solutions.is_dir() else solutions


def released(lab: Path) -> Path:
    """Return the path of a lab's notebook in a copy of the course for students."""
    return lab / f"{lab.name}.ipynb"


def interfaces() -> tuple[str, ...]:
    """Return the names of all interface packages of the course's chapters."""
    return tuple(name for chapter in chapters(root()) for name in chapter.interfaces)


def interface_modules() -> tuple[str, ...]:
    """Return the names of the modules that may contain the course's interfaces, such as ``my_robot_interfaces.msg``.

    A package need not have all of these modules.
    """
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
        isinstance(names, list) and all(isinstance(name, str) for name in names)
        for names in (said.get("labs", []), said.get("interfaces", []), *orders.values())
    )
    if not named or not isinstance(said.get("title", ""), str):
        raise BrokenChapter(
            f"{file}: title must be a text; labs, interfaces and each lab of the table exercises must be lists of names"
        )
    return said


def _is_lab(folder: Path) -> bool:
    # A copy of the course for students contains notebooks and exercises, but no masters.
    return folder.is_dir() and (
        (folder / LAB).is_file() or released(folder).is_file() or any(folder.glob("*.py"))
    )
