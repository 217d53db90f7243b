"""Fills in the parts of README.md that contain the address of the course's public repository: badges, `git clone`.

If the repository is not public yet, a sentence replaces the badges, and `git clone` is followed by a placeholder.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder import course
from autograder.masters.first_cell import links

if TYPE_CHECKING:
    from pathlib import Path

NAME = "README.md"
TO_FILL_IN = "ADDRESS_OF_THIS_REPOSITORY"
"""The placeholder in README.md for the address of a repository that is not public yet."""
WITHOUT_ADDRESS = (
    "This course has no public address yet. If you have its folder, leave the line with `git clone` out, and type the "
    "others in that folder.\n"
)
"""The sentence that README.md contains instead of badges while the repository is not public."""
TESTS = ".github/workflows/ci.yml"
PICTURES = {
    "Colab": "https://colab.research.google.com/assets/colab-badge.svg",
    "Codespaces": "https://github.com/codespaces/badge.svg",
    "Binder": "https://mybinder.org/badge_logo.svg",
}
"""For each service, the address of the picture on its badge."""
_BLOCK = re2.compile(r"(?s)(<!-- badges -->\n).*?(<!-- end of badges -->)")
_CLONE = re2.compile(r"(git clone )\S+( )")


def badges(address: str, notebook: str) -> str:
    """Return the Markdown of a repository's badges: for its tests, and for services that open a notebook.

    Args:
        address: The address of the repository, as :func:`autograder.course.repository` returns it.
        notebook: The path of the notebook in the repository.
    """
    tests = f"{address}/actions/workflows/{TESTS.rpartition('/')[2]}"
    shown = [f"[![Tests]({tests}/badge.svg)]({tests})"]
    for name, link in links(address, notebook).items():
        shown.append(f"[![Open in {name}]({PICTURES[name]})]({link})")
    return "\n".join(shown)


def readme(root: Path, notebook: Path) -> str | None:
    """Return README.md with its badges and address filled in; None if it has no marks for the badges.

    Args:
        root: The folder of the course.
        notebook: The notebook that the badges open.
    """
    file = root / NAME
    text = file.read_text(encoding="utf-8") if file.is_file() else ""
    if not _BLOCK.search(text):
        return None
    address = course.repository(root)
    shown = f"{badges(address, notebook.relative_to(root).as_posix())}\n" if address else WITHOUT_ADDRESS
    text = _BLOCK.sub(lambda found: f"{found[1]}{shown}{found[2]}", text)
    return str(_CLONE.sub(lambda found: f"{found[1]}{address or TO_FILL_IN}{found[2]}", text))
