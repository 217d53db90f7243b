"""Fills the address of the public repository into README.md: badges, the line to clone it, a link to the site.

Without an address, README.md shows none of these, because a visitor could not use them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder import course
from autograder.masters.source_notebooks import service_links

if TYPE_CHECKING:
    from pathlib import Path

README = "README.md"
_TESTS_WORKFLOW = "ci.yml"
_BADGE_PICTURES = {
    "Colab": "https://colab.research.google.com/assets/colab-badge.svg",
    "Codespaces": "https://github.com/codespaces/badge.svg",
    "Binder": "https://mybinder.org/badge_logo.svg",
}
"""For each service, the address of the picture on its badge."""
_ADDRESS_BLOCK = re2.compile(r"(?s)(<!-- address -->\n).*?(<!-- end of address -->)")
_PAGE_TO_LOOK_AT = re2.compile(r"(\[Look at [^\]]*\]\()[^)]*?(chapters/[^)]*)\.(?:ipynb|html)\)")


def readme(root: Path, notebook: Path) -> str | None:
    """Return README.md with everything that depends on the address; None if the file has no mark for it.

    Args:
        root: The folder of the course.
        notebook: The notebook that the badges open.
    """
    file = root / README
    text = file.read_text(encoding="utf-8") if file.is_file() else ""
    if not _ADDRESS_BLOCK.search(text):
        return None
    address = course.repository(root)
    block = _badges_and_clone_line(address, notebook.relative_to(root).as_posix()) if address else ""
    owner, _, name = address.removeprefix(course.GITHUB).partition("/")
    site, kind = (f"https://{owner}.github.io/{name}/", "html") if address else ("", "ipynb")
    text = _ADDRESS_BLOCK.sub(lambda found: f"{found[1]}{block}{found[2]}", text)
    return str(_PAGE_TO_LOOK_AT.sub(lambda found: f"{found[1]}{site}{found[2]}.{kind})", text))


def _badges_and_clone_line(address: str, notebook: str) -> str:
    tests = f"{address}/actions/workflows/{_TESTS_WORKFLOW}"
    lines = [f"[![Tests]({tests}/badge.svg)]({tests})"]
    for service, link in service_links(address, notebook).items():
        lines.append(f"[![Open in {service}]({_BADGE_PICTURES[service]})]({link})")
    folder = address.rpartition("/")[2]
    return "\n".join([*lines, "", "```console", f"$ git clone {address} && cd {folder}", "```", ""])
