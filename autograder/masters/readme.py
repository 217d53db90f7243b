"""The parts of a course's README about its public repository: badges, and the address to clone.

If the course has no address, a sentence replaces the badges, and the line to clone contains a word to fill in.
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
"""The word in README that stands for the address of a repository that is not public yet."""
WITHOUT_ADDRESS = (
    "This course has no public address yet. If you have its folder, leave the line with `git clone` out, and type the "
    "others in that folder.\n"
)
"""The sentence in README before the line to clone, as long as there is nothing to clone."""
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
    """Return the right text of a course's README; None if the README has no place for badges.

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
