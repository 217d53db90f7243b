"""Where the course's own files are."""

from __future__ import annotations

import os
from pathlib import Path


class NoCourse(LookupError):
    """The folder with ``solutions/`` and ``chapters/`` was not found."""


def root() -> Path:
    """The top folder of the course: a clone of the repository.

    The environment variable ``AUTOGRADER_COURSE`` overrides the place of the installed package.

    Raises:
        NoCourse: There is no course there.
    """
    folder = Path(os.environ.get("AUTOGRADER_COURSE") or Path(__file__).resolve().parents[1])
    if not (folder / "solutions").is_dir():
        raise NoCourse(
            f"{folder} holds no course: set AUTOGRADER_COURSE to the folder with solutions/ and chapters/"
        )
    return folder
