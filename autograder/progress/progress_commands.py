"""``autograder progress`` and ``autograder reset``: the course page's words and its one action, in a terminal."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

_FOLDER = click.option(
    "--folder",
    type=click.Path(path_type=Path),
    help="The folder of your notebooks, where it is not chapters.",
)


def _fail(message: str) -> None:
    click.echo(f"autograder: {message}", err=True)
    sys.exit(2)


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print it as one JSON object.")
@_FOLDER
def progress(as_json: bool, folder: Path | None) -> None:
    """Say which points you have reached, and where to go on. It is no grade."""
    from autograder import course, exercises, journal
    from autograder.progress.progress_text import standing_json, standing_text
    from autograder.progress.standing import standing

    try:
        root = course.root()
        notebooks, kept = _places(root, folder)
        found = standing(root, notebooks, journal.entries(kept))
    except (course.NoCourse, course.BrokenChapter, exercises.BrokenExercise) as error:
        _fail(str(error))
    click.echo(standing_json(found) if as_json else standing_text(found))


@click.command()
@click.argument("notebook")
@_FOLDER
def reset(notebook: str, folder: Path | None) -> None:
    """Begin NOTEBOOK anew, such as lab_1_2: the released one is put back, and yours is kept as a copy beside it."""
    from autograder import course
    from autograder.progress import resetting

    try:
        root = course.root()
        notebooks, kept = _places(root, folder)
        done = resetting.reset(root, notebooks, notebook, kept)
    except (course.NoCourse, course.BrokenChapter, resetting.CannotReset) as error:
        _fail(str(error))
    click.echo(f"{done.notebook} is as it was released.")
    if done.copy is not None:
        click.echo(f"Yours is kept: {done.copy}")


def _places(root: Path, folder: Path | None) -> tuple[Path, Path | None]:
    """The folder of the notebooks, and its journal."""
    from autograder import course, journal
    from autograder.lab import NOTEBOOKS_VARIABLE

    if folder is not None:
        return folder.resolve(), journal.place(folder.resolve())
    session = os.environ.get(NOTEBOOKS_VARIABLE)
    return Path(session) if session else root / course.CHAPTERS, journal.own_place()
