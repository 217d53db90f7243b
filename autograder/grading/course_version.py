"""One value that changes whenever something changes that decides a grade."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course

if TYPE_CHECKING:
    from collections.abc import Iterator

_PACKAGES = ("boxes", "exercises", "judge", "notebook")
_SUFFIXES = {".py", ".json", ".xml"}


@functools.cache
def course_version() -> str:
    """A hash of the code that runs and judges submissions and of the reference outputs.

    A release number would not do: an exercise that was mended must not leave yesterday's results standing.
    """
    digest = hashlib.sha256()
    for path in _files():
        data = path.read_bytes()
        digest.update(f"{path.name}:{len(data)};".encode())
        digest.update(data)
    return digest.hexdigest()[:16]


def _files() -> Iterator[Path]:
    package = Path(course.__file__).parent
    for name in _PACKAGES:
        yield from sorted(path for path in (package / name).rglob("*") if path.suffix in _SUFFIXES)
    yield from sorted((course.root() / "solutions").glob("*/reference/*.json"))
