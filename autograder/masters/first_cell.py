"""Adds two cells to each notebook, so that it can also run outside of ``./course lab``, for example in Colab.

One cell contains links that open the notebook in such a service, the other sets up the course there. They come after
the text at the top of the notebook. In ``./course lab``, and when a class is graded, they do nothing. They are added
only if the course's folder contains the code for the set-up (:data:`PART`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from urllib.parse import quote

from autograder import course
from autograder.masters.layout import chapter_path
from autograder.masters.parsing import CellRole, MasterCell

if TYPE_CHECKING:
    from pathlib import Path

NAME = "given-set-up"
"""The grade_id of the cell that sets up the course."""
PART = "environment/plain_kernel.py"
"""A file of the course, by which the cell recognizes the course's folder."""
SET_UP = """\
# @title Set the course up, outside of `./course lab`
# Run this cell first. In `./course lab` it does nothing. In another Jupyter, such as Colab, it takes a minute or two.
try:
    import autograder.notebook
except ImportError:
    import os
    import shutil
    import sys
    import urllib.request
    from pathlib import Path

    def course_folder() -> Path | None:
        folders = [Path.cwd(), *Path.cwd().parents, *sorted(Path.cwd().glob("ros2_course/*"))]
        return next((one for one in folders if (one / "{part}").is_file()), None)

    if not course_folder():
        archive = os.environ.get("ROS2_COURSE_ARCHIVE") or "{archive}"
        try:
            file, _ = urllib.request.urlretrieve(archive)
        except (OSError, ValueError) as error:
            problem = f"The course could not be fetched from {{archive!r}} ({{error}}). Is there a network?"
            raise ImportError(f"{{problem}} ROS2_COURSE_ARCHIVE may name another zip of the course.") from None
        shutil.unpack_archive(file, "ros2_course", "zip")
    sys.path.append(str(course_folder()))
    from environment.plain_kernel import set_up

    set_up()
    from autograder.student.lab import join_domain

    domain = join_domain()  # held for as long as this kernel runs
"""


def links(address: str, notebook: str) -> dict[str, str]:
    """Return the addresses that open a notebook of a repository in various services, by the name of the service.

    README and the site use the same addresses.

    Args:
        address: The address of the repository, as :func:`autograder.course.repository` returns it.
        notebook: The path of the notebook in the repository.
    """
    name = address.removeprefix(course.GITHUB)
    path = quote(notebook)
    return {
        "Colab": f"https://colab.research.google.com/github/{name}/blob/{course.BRANCH}/{path}",
        "Codespaces": f"https://codespaces.new/{name}",
        "Binder": f"https://mybinder.org/v2/gh/{name}/{course.BRANCH}?urlpath=lab/tree/{path}",
    }


def with_first_cells(master: Path, cells: list[MasterCell]) -> list[MasterCell]:
    """Return a master's cells, with the set-up cells of this module inserted before the first cell that is not text."""
    root = master.parents[3]
    first = next((place for place, cell in enumerate(cells) if cell.kind is not CellRole.TEXT), None)
    if first is None or not (root / PART).is_file():
        return cells
    address = course.repository(root)
    added = []
    if address:
        notebook = chapter_path(root, master).relative_to(root).as_posix()
        ways = " · ".join(f"[{name}]({link})" for name, link in links(address, notebook).items())
        text = f"Nothing installed? Open this notebook in {ways}."
        added.append(MasterCell(CellRole.TEXT, text, line=0, body_line=0))
    archive = course.archive(address) if address else ""
    source = SET_UP.format(part=PART, archive=archive).rstrip("\n")
    added.append(MasterCell(CellRole.DEMONSTRATION, source, line=0, body_line=0, grade_id=NAME, folded=True))
    return [*cells[:first], *added, *cells[first:]]
