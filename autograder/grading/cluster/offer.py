"""What a machine offers to a cluster: which course it has, and whether it can execute in boxes."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path
from typing import TYPE_CHECKING

from autograder import course
from autograder.boxes.sandbox import why_impossible
from autograder.grading.cluster.messages import Offer

if TYPE_CHECKING:
    from collections.abc import Iterator

_CODE = {".py", ".json", ".xml", ".toml"}


def offer(slots: int) -> Offer:
    """What this machine offers.

    Args:
        slots: Notebooks at once.
    """
    obstacle = why_impossible()
    return Offer(version(), slots, sandbox=not obstacle, obstacle=obstacle)


@functools.cache
def version() -> str:
    """A hash of what two machines must have in common to give the same grades.

    Wider than :func:`autograder.grading.course_version.course_version`, which says whether a result is still valid:
    here the whole package counts, the masters, the reference outputs, and the sources of the interface package.
    """
    digest = hashlib.sha256()
    for name, path in _files():
        data = path.read_bytes()
        digest.update(f"{name}:{len(data)};".encode())
        digest.update(data)
    return digest.hexdigest()[:16]


def _files() -> Iterator[tuple[str, Path]]:
    package, root = Path(course.__file__).parent, course.root()
    for folder, pattern in (
        (package, "**/*"),
        (root / "solutions", "*/*.md"),
        (root / "solutions", "*/reference/*.json"),
        (root / "environment" / "ros2_ws" / "src", "**/*"),
    ):
        for path in sorted(folder.glob(pattern)):
            if path.is_file() and (folder != package or path.suffix in _CODE):
                yield f"{folder.name}/{path.relative_to(folder)}", path
