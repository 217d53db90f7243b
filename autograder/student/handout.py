"""Makes the hand-out: a copy of the course for students, with notebooks and judge, without solutions and grader.

The repository contains every solution, so it cannot be given to a class. The hand-out is a separate course with the
same ``./course``. Its exercises and reference outputs are in ``exercises/``, and it has no folder ``solutions``.
"""

from __future__ import annotations

import io
import shutil
import stat
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from jinja2 import Template

from autograder import course
from autograder.command_name import COMMAND
from autograder.course import HANDED_OUT
from autograder.exercises import MUTANTS, REFERENCE
from autograder.masters.chapter_building import holds_work
from autograder.masters.master_files import relinked
from autograder.packed_files import packed
from autograder.safe_files import write_whole
from course_runtime.installation import PACKAGE

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence


WHOLE = (
    "course",
    "pyproject.toml",
    "LICENSE",
    "course_runtime",
    "environment",
    "autograder",
    ".devcontainer",
    ".dockerignore",
)
"""Files and folders that are handed out unchanged, except for those in :data:`KEPT_BACK`."""
KEPT_BACK = (
    "autograder/authoring",
    "autograder/grading",
    "autograder/student/handout.py",
    "autograder/student/handout_readme.md.j2",
    "autograder/masters",
)
"""Parts of the files in :data:`WHOLE` that make notebooks, contain solutions or grade a class. They are not handed out.
"""
PAGES = (
    "students-guide.md",
    "learning-outcomes.md",
    "mistakes.md",
    "fairness.md",
    "glossary.md",
    "ros2-command.md",
    "robot.md",
)
"""The pages of ``docs/`` that are handed out."""
_MADE = frozenset({"__pycache__", ".ipynb_checkpoints"})
_MADE_BY_COLCON = frozenset({"build", "install", "log"})
"""Folders with generated files, which colcon makes next to the folder ``src`` of a workspace."""
README = Path(__file__).with_name("handout_readme.md.j2")
"""The hand-out's README. A course in another repository has neither ``./course`` nor the pages in ``docs/``; its
students install this package with pip.
"""


class CannotHandOut(Exception):
    """The hand-out cannot be made. The message says why, and what to do."""


@dataclass(frozen=True)
class HandOut:
    """A hand-out that was made.

    Attributes:
        place: The path of the folder or zip.
        files: The number of files in it.
        size: The total size of the files, in bytes.
    """

    place: Path
    files: int
    size: int


def hand_out(
    place: Path,
    root: Path,
    *,
    assignments: Collection[str] = (),
    as_zip: bool = False,
    with_solutions: bool = False,
) -> HandOut:
    """Make the hand-out for a class.

    Args:
        place: The folder to make, which must be empty or not exist; with ``as_zip``, the zip file to make.
        root: The top folder of the whole course.
        assignments: The names of the notebooks to hand out, graded or not; all if empty.
        as_zip: True to make a zip file.
        with_solutions: True to add the reference solutions and explanations that cards show with full marks, or offer
            after enough failures. Students can then also read them earlier, in the folder ``exercises``. The causes of
            a bug hunt, and without this also its repairs, are packed there.

    Raises:
        CannotHandOut: The place is not empty, a name is not that of a notebook, a notebook of the chapters was
            changed, or this course is itself a hand-out.
        OSError: The hand-out cannot be written.
    """
    if not (root / course.SOLUTIONS).is_dir():
        raise CannotHandOut(
            f"{root} is itself a hand-out: make a new one from the course that contains the masters"
        )
    if place.is_file() or (place.is_dir() and (as_zip or any(place.iterdir()))):
        raise CannotHandOut(f"{place} already exists and is not overwritten: name another path")
    chapters = _wanted(course.chapters(root), assignments)
    if not chapters:
        raise CannotHandOut(f"{root} has no notebook yet: there is nothing to hand out")
    files = dict(_files(root, chapters, with_solutions=with_solutions))
    files["README.md"] = readme(chapters, of_a_clone="course" in files).encode()
    write = _pack if as_zip else _copy
    write(place, files)
    sizes = [
        len(content) if isinstance(content, bytes) else content.stat().st_size for content in files.values()
    ]
    return HandOut(place, len(files), sum(sizes))


def readme(chapters: Sequence[course.Chapter], *, of_a_clone: bool) -> str:
    """Return the README of a hand-out.

    Args:
        chapters: The chapters that are handed out.
        of_a_clone: True if the hand-out has ``./course``.
    """
    text = Template(README.read_text(encoding="utf-8"), trim_blocks=True, keep_trailing_newline=True)
    title = " · ".join(one.title for one in chapters)
    extras = ["ros", "notebooks", *(["interfaces"] if any(one.interfaces for one in chapters) else [])]
    return text.render(title=title, of_a_clone=of_a_clone, install=f"{PACKAGE}[{','.join(extras)}]")


def _wanted(chapters: Sequence[course.Chapter], names: Collection[str]) -> list[course.Chapter]:
    """Return the chapters with only the named labs; if no name is given, with all labs."""
    known = [lab.name for chapter in chapters for lab in chapter.labs]
    for name in names:
        if name not in known:
            raise CannotHandOut(f"no notebook is named {name}. The notebooks are: {', '.join(known)}")
    found = [
        replace(chapter, labs=tuple(lab for lab in chapter.labs if not names or lab.name in names))
        for chapter in chapters
    ]
    return [chapter for chapter in found if chapter.labs]


def _files(
    root: Path, chapters: Sequence[course.Chapter], *, with_solutions: bool
) -> Iterator[tuple[str, Path | bytes]]:
    """Yield the files of the hand-out, each with its path in the hand-out."""
    for name in WHOLE:
        yield from ((path.relative_to(root).as_posix(), path) for path in _below(root / name, root))
    yield from _pages(root)
    names = {lab.name: chapter.folder.name for chapter in chapters for lab in chapter.labs}
    to_pack = (course.TICKET,) if with_solutions else (course.TICKET, course.SOLUTION)
    for chapter in chapters:
        for path in [chapter.folder / course.CHAPTER, *_judges_part(chapter, with_solutions=with_solutions)]:
            if path.is_file():
                content = packed(path.read_bytes()) if path.name.endswith(to_pack) else path
                yield f"{HANDED_OUT}/{path.relative_to(chapter.folder.parent).as_posix()}", content
        for lab in chapter.labs:
            yield from _notebook(root, chapter, lab, names)


def _pages(root: Path) -> Iterator[tuple[str, Path]]:
    """Yield the pages and the pictures that they show. Other pictures, such as those in README, may show a solution."""
    pages = [page for name in PAGES if (page := root / "docs" / name).is_file()]
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    shown = (path for path in _below(root / "docs" / "images", root) if f"(images/{path.name})" in text)
    yield from ((path.relative_to(root).as_posix(), path) for path in [*pages, *shown])


def _notebook(
    root: Path, chapter: course.Chapter, lab: Path, folders: Mapping[str, str]
) -> Iterator[tuple[str, bytes]]:
    """Yield a lab's notebook twice: for students to work in, and for `./course reset` to restore.

    ``folders`` has the chapter's folder of each lab that is handed out.
    """
    notebook = root / course.CHAPTERS / chapter.folder.name / f"{lab.name}.ipynb"
    if not notebook.is_file():
        return
    if holds_work(notebook):
        raise CannotHandOut(
            f"{notebook} contains changes, which would be handed out. Reset it first: {COMMAND} reset {lab.name}"
        )
    # A link to a notebook that is not handed out would be broken, so only the text of the link stays.
    here = chapter.folder.name
    beside = {
        name: f"{name}.ipynb" if folder == here else f"../{folder}/{name}.ipynb"
        for name, folder in folders.items()
    }
    content = relinked(notebook.read_bytes().decode(), lambda name: beside.get(name, "")).encode()
    yield notebook.relative_to(root).as_posix(), content
    yield f"{HANDED_OUT}/{course.released(lab).relative_to(chapter.folder.parent).as_posix()}", content


def _judges_part(chapter: course.Chapter, *, with_solutions: bool) -> Iterator[Path]:
    for lab in chapter.labs:
        yield from sorted(lab.glob("*.py"))
        yield from sorted(lab.glob(f"*{REFERENCE}"))
        yield from sorted(lab.glob(f"*{MUTANTS}"))
        yield from (tickets := sorted(lab.glob(f"*{course.TICKET}")))
        # The card of a ticket shows our repair beside the student's.
        if with_solutions or tickets:
            yield from sorted(lab.glob(f"*{course.SOLUTION}"))
    yield from _below(chapter.folder / course.INTERFACES, chapter.folder)


def _below(place: Path, root: Path) -> Iterator[Path]:
    """Yield the files to hand out from a file or folder: none that is kept back, hidden or generated."""
    kept_back = any(place == root / name for name in KEPT_BACK)
    made = place.name in _MADE or (place.name in _MADE_BY_COLCON and (place.parent / "src").is_dir())
    hidden = place.name.startswith(".") and place != root and place.name not in WHOLE
    if kept_back or made or hidden:
        return
    if place.is_dir():
        for inside in sorted(place.iterdir()):
            yield from _below(inside, root)
    elif place.is_file():
        yield place


def _copy(place: Path, files: dict[str, Path | bytes]) -> None:
    for name, content in files.items():
        target = place / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, bytes):
            target.write_bytes(content)
        else:
            shutil.copy(content, target)


def _pack(place: Path, files: dict[str, Path | bytes]) -> None:
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in files.items():
            # ZipInfo has a fixed date, so that the same files always give the same zip.
            entry = zipfile.ZipInfo(f"{place.stem}/{name}")
            entry.compress_type = zipfile.ZIP_DEFLATED
            runs = isinstance(content, Path) and content.stat().st_mode & stat.S_IXUSR
            entry.external_attr = (0o755 if runs else 0o644) << 16
            packed.writestr(entry, content if isinstance(content, bytes) else content.read_bytes())
    write_whole(place, archive.getvalue())
