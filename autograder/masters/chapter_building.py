"""Builds chapter notebooks and solution files, or reports which of them are out of date."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import nbformat
from nbgrader.utils import compute_checksum

from autograder import standard_output
from autograder.command_name import COMMAND
from autograder.course import SOLUTION
from autograder.masters.check_cells import exercise_points
from autograder.masters.master_files import MasterError, chapter_notebooks, chapter_path, masters
from autograder.masters.notebook_release import release_text
from autograder.masters.reference_solutions import solution_files
from autograder.masters.source_notebooks import Points, named_cells, notebook_of
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console


_NOTEBOOK = ".ipynb"


@dataclass(frozen=True)
class BuildReport:
    """What a build did with each chapter notebook and solution file, or what it would do in check mode.

    Attributes:
        written: The files that were written.
        unchanged: The files that were already up to date.
        stale: In check mode, the files that are missing or out of date.
        edited: The files that were not overwritten, because a person has changed them.
        orphans: Chapter notebooks whose master no longer exists, and solution files whose ``.why.md`` file no longer
            exists. They are never deleted.
    """

    written: tuple[Path, ...] = ()
    unchanged: tuple[Path, ...] = ()
    stale: tuple[Path, ...] = ()
    edited: tuple[Path, ...] = ()
    orphans: tuple[Path, ...] = ()

    @property
    def in_step(self) -> bool:
        """True if all files are up to date after the build."""
        return not (self.stale or self.edited or self.orphans)


def build(root: Path, *, check: bool = False, points: Points = exercise_points) -> BuildReport:
    """Build the chapters of the course in ``root`` from its masters.

    All masters are read before the first notebook is written, so that a bad master changes nothing.

    Args:
        root: The top folder of the course, which contains ``solutions`` and ``chapters``.
        check: True to write nothing, and report what is out of date.
        points: A function that returns the points of an exercise; by default, it reads them from the exercise.

    Raises:
        MasterError: A master cannot be used, or there is none.
        OSError: A chapter notebook cannot be read or written.
    """
    cells = {master: named_cells(master, points=points) for master in masters(root)}
    texts = {chapter_path(root, master): release_text(notebook_of(named)) for master, named in cells.items()}
    for master, named in cells.items():
        texts |= solution_files(master, named)
    found: dict[str, list[Path]] = {"written": [], "unchanged": [], "stale": [], "edited": []}
    for path, text in texts.items():
        found[_settle(path, text, check=check)].append(path)
    solutions = [path for master in cells for path in sorted(master.parent.glob(f"*{SOLUTION}"))]
    orphans = [path for path in (*chapter_notebooks(root), *solutions) if path not in texts]
    return BuildReport(**{state: tuple(paths) for state, paths in found.items()}, orphans=tuple(orphans))


def _settle(path: Path, text: str, *, check: bool) -> str:
    """Write one file if necessary and allowed. Return the name of the field of :class:`BuildReport` for this file."""
    if path.exists() and path.read_bytes() == text.encode():
        return "unchanged"
    if path.suffix == _NOTEBOOK and holds_work(path):
        return "edited"
    if check:
        return "stale"
    write_whole(path, text.encode())
    return "written"


def build_command(
    root: Path, *, check: bool = False, console: Console | None = None, points: Points = exercise_points
) -> int:
    """Build the chapters, or check that they are up to date, and print the result.

    Returns:
        The exit code: 0 if the chapters are up to date, 1 if they are not, 2 if a master cannot be used.
    """
    console = console or standard_output.console()
    try:
        report = build(root, check=check, points=points)
    except MasterError as error:
        console.print(f"[bold red]cannot build[/]  {error}", highlight=False, soft_wrap=True)
        return 2
    for word, paths, meaning in (
        ("written", report.written, ""),
        ("stale", report.stale, f"— run: {COMMAND} build"),
        ("edited", report.edited, "— a person has changed it: move it away, then build again"),
        ("orphan", report.orphans, "— it has no master: write a master for it, or delete the file"),
    ):
        for path in paths:
            console.print(f"{word:<10} {path.relative_to(root)}  {meaning}", highlight=False, soft_wrap=True)
    in_step = sum(path.suffix == _NOTEBOOK for path in (*report.unchanged, *report.written))
    notebooks = "chapter notebook" if in_step == 1 else "chapter notebooks"
    console.print(f"{in_step} {notebooks} up to date with the masters.", highlight=False)
    return 0 if report.in_step else 1


def holds_work(path: Path) -> bool:
    """Return True if a person has changed the notebook since a build wrote it.

    The metadata of a release contains the checksum of each code cell and of each question. A cell that no longer
    matches was edited, and code without a checksum was added. Outputs do not count. A file that cannot be read as a
    notebook counts as changed, so that it is not overwritten.
    """
    if not path.exists():
        return False
    try:
        notebook = nbformat.read(path, as_version=4)
    except Exception:
        # Catch every exception, because nbformat also raises those of its JSON and schema libraries.
        return True
    return any(
        _edited(cell) for cell in notebook.cells if cell.cell_type == "code" or "nbgrader" in cell.metadata
    )


def _edited(cell: Any) -> bool:
    tracked = cell.metadata.get("nbgrader", {})
    if "checksum" in tracked:
        return bool(tracked["checksum"] != compute_checksum(cell))
    return bool(cell.source.strip())
