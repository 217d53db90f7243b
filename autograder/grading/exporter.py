"""The door through which nbgrader reads a submission.

nbgrader's own door is nbformat, which raises on a file that is no notebook: the batch then goes on without
the student and an earlier grade stays where it was. Here a submission that cannot be read is a notebook like
any other, with the reason in it, and the grades are reset before anything else happens.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nbconvert.exporters import NotebookExporter

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.entering import gradebook
from autograder.grading.entering.nbgrader_guard import guard
from autograder.grading.rebuilding.task_making import rebuilt_notebook


class SubmissionExporter(NotebookExporter):
    """Reads a submission as its rebuilt notebook; reads anything else as nbconvert does."""

    def __init__(self, *args: Any, **kw: Any) -> None:
        initialise: Any = super().__init__
        initialise(*args, **kw)
        guard(self.parent)

    def from_filename(
        self, filename: str, resources: dict[str, Any] | None = None, **kw: Any
    ) -> tuple[Any, Any]:
        """Read and convert one notebook.

        Args:
            filename: What nbgrader's converter was asked to convert.
            resources: nbgrader's names of student, assignment and notebook are in it.
            **kw: Handed on to nbconvert.
        """
        if not getattr(self.parent, "_sanitizing", False) or resources is None:
            return super().from_filename(filename, resources=resources, **kw)
        names = resources["nbgrader"]
        converter: Any = self.parent
        directory = ClassDirectory(Path(converter.coursedir.root))
        gradebook.reset(directory.gradebook_url, [(names["assignment"], names["student"])])
        master = directory.master(names["assignment"], names["notebook"])
        path = Path(filename)
        _refuse_links(directory.path, path.parent)
        rebuilt, problem = rebuilt_notebook(path, master)
        rebuilt.notebook.metadata["autograder"]["problem"] = problem
        resources["metadata"] = {"name": names["notebook"], "path": str(path.parent)}
        convert: Any = self.from_notebook_node
        return convert(rebuilt.notebook, resources=resources, **kw)


def _refuse_links(root: Path, folder: Path) -> None:
    """A submission folder that is a link would have a neighbour's work graded as one's own."""
    for part in (folder, *folder.parents):
        if part == root:
            return
        if part.is_symlink():
            raise PermissionError(f"{part} is a link; put the folder itself there")
