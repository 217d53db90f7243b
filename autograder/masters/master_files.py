"""Finds masters and the notebooks that are built from them. Defines the errors for a master that cannot be used."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import re2

from autograder import course
from autograder.course import CHAPTERS, COPY, LAB, SOLUTIONS

if TYPE_CHECKING:
    from collections.abc import Callable


FAULTS: dict[str, dict[str, str]] = tomllib.loads(
    Path(__file__).with_name("faults.toml").read_text(encoding="utf-8")
)
"""For each fault of a master, by its name: the texts ``problem`` and ``remedy``."""


class MasterError(Exception):
    """A master, or the folder of masters, cannot be used.

    Attributes:
        path: The path of the file or folder.
        line: The line, counted from 1; None for the whole file.
        problem: What is wrong, as a sentence.
        remedy: What to do about it, as a sentence.
    """

    def __init__(self, path: Path, line: int | None, fault: str, /, **words: object) -> None:
        """Say what is wrong.

        Args:
            path: The path of the file or folder.
            line: The line, counted from 1; None for the whole file.
            fault: The name of the fault in ``faults.toml``.
            words: The words that the fault's texts need.
        """
        self.path, self.line = path, line
        self.problem, self.remedy = (FAULTS[fault][part].format(**words) for part in ("problem", "remedy"))
        place = str(path) if line is None else f"{path}:{line}"
        super().__init__(f"{place}: {self.problem} {self.remedy}")


class CellError(ValueError):
    """A cell cannot be read. Code that knows the master turns this into a :class:`MasterError`.

    Attributes:
        offset: The line within the cell, counted from 0.
        fault: The name of the fault in ``faults.toml``.
        words: The words that its texts need.
    """

    def __init__(self, offset: int, fault: str, /, **words: object) -> None:
        super().__init__(fault)
        self.offset, self.fault, self.words = offset, fault, words

    def at(self, path: Path, body_line: int) -> MasterError:
        """Return the error for the master ``path``, given the line on which the text of the cell begins."""
        return MasterError(path, body_line + self.offset, self.fault, **self.words)


_LINK = re2.compile(r"\[([^\[\]]+)\]\((?:\.\./[\w-]+/)?([\w-]+)\.ipynb(#[^)]*)?\)")
"""Matches a Markdown link to another notebook, in the folder of the chapter or in that of another chapter."""


def masters(root: Path) -> list[Path]:
    """Return the masters of the course in ``root``, in reading order: ``solutions/<chapter>/<lab>/lab.md``.

    Raises:
        MasterError: ``root`` has no folder ``solutions``, a chapter's description cannot be used, or there is no
            master.
    """
    folder = root / SOLUTIONS
    if not folder.is_dir():
        raise MasterError(root, None, "no_solutions")
    try:
        labs = [lab for chapter in course.chapters(root) for lab in chapter.labs]
    except course.BrokenChapter as error:
        raise MasterError(folder, None, "broken_file", error=error) from error
    found = [lab / LAB for lab in labs if (lab / LAB).is_file()]
    if not found:
        raise MasterError(folder, None, "no_masters")
    return found


def lab_name(master: Path) -> str:
    """Return the name of a master's lab, such as ``"lab_1_2"``. The lab's folder and notebook have the same name."""
    return master.parent.name


def before_and_after(master: Path) -> tuple[Path | None, Path | None]:
    """Return the previous and the next master in the course of ``master``; None if there is none."""
    chapters = course.chapters(master.parents[3])
    found = [lab / LAB for chapter in chapters for lab in chapter.labs if (lab / LAB).is_file()]
    if master not in found:
        return None, None
    here = found.index(master) + 1
    ends = [None, *found, None]
    return ends[here - 1], ends[here + 1]


def chapter_path(root: Path, master: Path) -> Path:
    """Return the path of the chapter notebook that is built from ``master``."""
    return root / CHAPTERS / master.parents[1].name / f"{lab_name(master)}.ipynb"


def chapter_notebooks(root: Path) -> list[Path]:
    """Return the chapter notebooks that exist, without JupyterLab's checkpoints and `./course reset`'s copies."""
    found = sorted((root / CHAPTERS).rglob("*.ipynb"))
    return [path for path in found if ".ipynb_checkpoints" not in path.parts and COPY not in path.name]


def relinked(text: str, place: Callable[[str], str]) -> str:
    """Return a text with its links to other notebooks changed, for a copy of the text in another folder.

    Args:
        text: Markdown, or the content of a notebook file that contains Markdown.
        place: Takes the name of a lab, and returns the path of its notebook from the other folder. If it returns an
            empty text, the link is replaced by its words.
    """

    def there(link: Any) -> str:
        words, name, anchor = link.groups()
        return f"[{words}]({found}{anchor or ''})" if (found := place(name)) else str(words)

    return str(_LINK.sub(there, text))
