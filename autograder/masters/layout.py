"""Where masters live and where the notebooks derived from them go."""

from __future__ import annotations

from typing import TYPE_CHECKING

from autograder.masters.errors import MasterError

if TYPE_CHECKING:
    from pathlib import Path

SOLUTIONS = "solutions"
CHAPTERS = "chapters"


def masters(root: Path) -> list[Path]:
    """The masters of the course in ``root``, in order: every ``solutions/<chapter>/<name>.md``.

    Raises:
        MasterError: ``root`` holds no ``solutions`` folder, or there is no master in it.
    """
    folder = root / SOLUTIONS
    if not folder.is_dir():
        raise MasterError(
            root,
            None,
            "There is no folder 'solutions' here.",
            "Name the folder that holds 'solutions' and 'chapters'.",
        )
    found = sorted(path for path in folder.glob("*/*.md") if path.name != "README.md")
    if not found:
        raise MasterError(
            folder, None, "No master was found.", "Masters are files such as solutions/<chapter>/<name>.md."
        )
    return found


def chapter_path(root: Path, master: Path) -> Path:
    """Where the chapter notebook of ``master`` belongs."""
    return root / CHAPTERS / master.parent.name / f"{master.stem}.ipynb"


def chapter_notebooks(root: Path) -> list[Path]:
    """The notebooks that are in the chapters now, in order; JupyterLab's checkpoints are not counted."""
    folder = root / CHAPTERS
    return sorted(path for path in folder.rglob("*.ipynb") if ".ipynb_checkpoints" not in path.parts)


def find_root(start: Path) -> Path:
    """The course that ``start`` lies in: the nearest folder at or above it with a ``solutions`` folder.

    Raises:
        MasterError: No folder at or above ``start`` has one.
    """
    for folder in (start, *start.parents):
        if (folder / SOLUTIONS).is_dir():
            return folder
    raise MasterError(
        start,
        None,
        "This folder lies in no course.",
        "Go to the folder that holds 'solutions' and 'chapters'.",
    )
