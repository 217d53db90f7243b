"""``new-exercise``: copies the example of a recipe into a new lab folder, which its author then changes."""

from __future__ import annotations

import importlib.util
import re  # noqa: TID251  (not what a student handed in)
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course, exercises
from autograder.authoring.author_texts import author_text
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Sequence

EXAMPLES = Path(__file__).with_name("examples")
"""The folder of a course that contains only examples. Each lab is the example for the recipe with the same name."""
_GENERATED = shutil.ignore_patterns("__pycache__", f"*{exercises.REFERENCE}")
"""Ignores files that must not be copied from an example, because commands generate them."""

_ID = re.compile(r"[a-z][a-z0-9_]*\.[a-z][a-z0-9_]*", re.ASCII)
_NUMBER = re.compile(r"_(\d+(?:_\d+)*)$")
_TITLE = re.compile(r"^# .*?: ", re.MULTILINE)
_MINUTES = re.compile(r"^\*\d+ minutes · .*\n\n", re.MULTILINE)
_CLOSING = "\n## Going further"


class CannotMake(ValueError):
    """The exercise cannot be made. The message says what to do instead. Nothing was written."""


def recipes() -> dict[str, Path]:
    """Return the folders of the examples, by the names of the recipes."""
    return {lab.name: lab for chapter in course.chapters(EXAMPLES) for lab in chapter.labs}


def new_exercise(
    root: Path,
    exercise_id: str,
    recipe: str,
    *,
    chapter: str | None = None,
    to_lab: bool = False,
) -> Sequence[Path]:
    """Make the folder of a lab with one exercise, or add the exercise to a lab.

    Args:
        root: The top folder of the course.
        exercise_id: The lab, a dot, and the exercise, such as ``"lab_8_1.battery"``.
        recipe: The kind of subject: a key of :func:`recipes`.
        chapter: The folder of the chapter in ``solutions/``, which is created if it does not exist; None for the last
            chapter.
        to_lab: True to add the exercise to a lab that exists, in whatever chapter: its cells come last.

    Returns:
        The new files and, if the lab existed, its changed master, in order.

    Raises:
        CannotMake: The id or the chapter is not valid; the lab already exists, or does not; or the recipe does not
            exist.
    """
    if not _ID.fullmatch(exercise_id):
        raise CannotMake(author_text("no_id", id=exercise_id))
    lab = exercise_id.partition(".")[0]
    known = recipes()
    if recipe not in known:
        raise CannotMake(author_text("no_recipe", recipe=recipe, known=", ".join(known)))
    example = known[recipe]
    folder = _existing_lab(root, exercise_id) if to_lab else _chapter(root, chapter) / lab
    if not to_lab:
        _refuse_existing(root, folder)
    # Make the lab in a temporary folder first, so that an error leaves no half lab in the course.
    with HeldFolder("autograder-new-") as scratch:
        made = scratch.path / lab
        shutil.copytree(example, made, ignore=_GENERATED)
        old_name = min(
            file.name.removesuffix(exercises.REFERENCE) for file in example.glob(f"*{exercises.REFERENCE}")
        )
        _rename(made, f"{example.name}.{old_name}", exercise_id)
        written = _described(folder.parent)
        if to_lab:
            _add_cells(folder / course.LAB, made / course.LAB)
        new = sorted(folder / path.relative_to(made) for path in made.rglob("*") if path.is_file())
        shutil.copytree(made, folder, dirs_exist_ok=True)
    return [*written, *new]


def _add_cells(lab: Path, example: Path) -> None:
    """Put the cells of a lab before the end of the example's master, and its own cells after them."""
    before, closing, after = lab.read_text(encoding="utf-8").partition(_CLOSING)
    text = example.read_text(encoding="utf-8").partition(_CLOSING)[0]
    task = _MINUTES.sub("", _TITLE.sub("## ", text[text.index("\n# ") + 1 :], count=1))
    example.write_text(f"{before.rstrip()}\n\n+++\n\n{task.rstrip()}\n{closing}{after}", encoding="utf-8")


def _described(chapter: Path) -> list[Path]:
    """Make the folder of a new chapter with an incomplete ``chapter.toml``. Return the new files."""
    if chapter.is_dir():
        return []
    chapter.mkdir(parents=True)
    description = chapter / course.CHAPTER
    title = chapter.name.lstrip("0123456789_-").replace("_", " ").capitalize() or chapter.name
    description.write_text(
        f'title = "{title}"\n\n# The folders of the labs, in the order in which they are read. A lab that is '
        "not listed here comes last.\nlabs = []\n",
        encoding="utf-8",
    )
    return [description]


def _chapter(root: Path, name: str | None) -> Path:
    chapters = course.chapters(root)
    if name is None:
        if not chapters:
            raise CannotMake(author_text("no_chapter", folder=root / course.SOLUTIONS))
        return chapters[-1].folder
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_-]*", name, re.ASCII):
        raise CannotMake(author_text("bad_chapter", name=name))
    return root / course.SOLUTIONS / name


def _refuse_existing(root: Path, folder: Path) -> None:
    # Two labs with the same name would be one Python package, and one notebook for nbgrader.
    others = [lab for chapter in course.chapters(root) for lab in chapter.labs if lab.name == folder.name]
    for lab in (folder, *others):
        if lab.exists():
            raise CannotMake(author_text("lab_exists", lab=lab.relative_to(root)))
    if _is_a_module(folder.name):
        raise CannotMake(author_text("module_exists", name=folder.name))


def _existing_lab(root: Path, exercise_id: str) -> Path:
    name, _, exercise = exercise_id.partition(".")
    labs = [lab for chapter in course.chapters(root) for lab in chapter.labs if lab.name == name]
    if not labs or not (labs[0] / course.LAB).is_file():
        raise CannotMake(author_text("no_lab", name=name))
    if there := sorted(labs[0].glob(f"{exercise}.*")):
        raise CannotMake(author_text("exercise_exists", file=there[0].relative_to(root)))
    return labs[0]


def _is_a_module(name: str) -> bool:
    return name in sys.stdlib_module_names or importlib.util.find_spec(name) is not None


def _rename(made: Path, old: str, new: str) -> None:
    """Replace the example's id by the new id in the copied lab, in the contents and names of its files."""
    old_name, new_name = old.partition(".")[2], new.partition(".")[2]
    # A part of the exercise, in a file of its own, is named after it with an underscore in front.
    part = old.replace(".", "._"), new.replace(".", "._")
    for path in sorted(made.rglob("*")):
        if path.is_file():
            text = path.read_text(encoding="utf-8").replace(old, new).replace(*part)
            if path.name == course.LAB:
                text = _TITLE.sub(f"# {_lab_title(new)}: ", text, count=1)
            path.write_text(text, encoding="utf-8")
    for path in made.glob(f"*{old_name}*"):
        path.rename(path.with_name(path.name.replace(old_name, new_name, 1)))


def _lab_title(exercise_id: str) -> str:
    """Return the title of a lab for its heading: ``Lab 9.1`` for ``lab_9_1``."""
    lab = exercise_id.partition(".")[0]
    number = _NUMBER.search(lab)
    words = (lab[: number.start()] if number else lab).replace("_", " ").strip().capitalize()
    return f"{words} {number[1].replace('_', '.')}" if number else words
