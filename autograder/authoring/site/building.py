"""Builds the course's website with Sphinx, without access to a network."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import re2
import sphinx.addnodes
from docutils import nodes
from sphinx.application import Sphinx

from autograder import course
from autograder.authoring.site.outputs import run_masters
from autograder.authoring.site.pages import SELF, STATIC, write_sources
from autograder.masters.layout import masters
from autograder.student.handing_out import hand_out
from autograder.temporary_folders import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Callable

LARGEST = 1_000_000
"""The maximum size of a page in bytes."""
STYLE = "book.css"
_ICON = re2.compile(r'(?:"?([\w-]+)"?):\[\d+,\d+,\[([^\]]*)\],"[0-9a-f]*",(?:"[^"]*"|\[[^\]]*\])\],?')
"""Matches one of the 2,000 icons in the theme's script: its name, size, other names, code and drawing."""
_ICON_NAME = re2.compile(r"\bfa-([\w-]+)")
SETTINGS: dict[str, Any] = {
    "author": "The maintainers of this course",
    "extensions": ["myst_nb", "sphinx_copybutton", "autograder.authoring.site.building"],
    "html_theme": "sphinx_book_theme",
    "html_static_path": [STATIC],
    "html_css_files": [STYLE],
    "html_theme_options": {
        "navbar_persistent": [],
        "show_navbar_depth": 1,
        "use_download_button": False,
        "use_fullscreen_button": False,
        "pygments_light_style": "a11y-high-contrast-light",
        "pygments_dark_style": "a11y-high-contrast-dark",
    },
    "html_context": {"default_mode": "auto"},
    "html_copy_source": False,
    "html_show_sphinx": False,
    "language": "en",
    "nb_execution_mode": "off",
    # Without this line, pages would load scripts for Jupyter widgets from another host. No page has such widgets.
    "nb_ipywidgets_js": {},
    "myst_enable_extensions": ["colon_fence", "html_image"],
    "myst_heading_anchors": 6,
    "copybutton_prompt_text": "$ ",
    "suppress_warnings": ["myst.header", "misc.highlighting_failure"],
}


def build_site(root: Path, folder: Path, edition: str, *, outputs: bool, tell: Callable[[str], None]) -> int:
    """Build the website of a course.

    Args:
        root: The top folder of the course.
        folder: The folder for the pages. Pages from an earlier build in it are replaced.
        edition: A value from ``autograder.authoring.site.pages.EDITIONS``.
        outputs: True to execute the notebooks first and show their outputs.
        tell: Called with each line to print.

    Returns:
        The number of problems: links that lead nowhere, and pages that are too large.
    """
    with HeldFolder("course-site-") as held:
        executed = run_masters(masters(root), course_of(edition, root, held.path), tell) if outputs else {}
        sources, pages = held.path / "sources", held.path / "pages"
        sources.mkdir()
        write_sources(root, sources, edition, executed)
        shutil.copyfile(Path(__file__).with_name(STYLE), sources / STATIC / STYLE)
        title = next(iter(course.chapters(root))).title
        address = course.repository(root)
        files = f"{address}/blob/{course.BRANCH}" if address else ""
        settings = SETTINGS | {"project": title, "html_title": title, "course_files": files}
        with (held.path / "warnings").open("w+", encoding="utf-8") as warnings:
            app = Sphinx(
                sources, None, pages, held.path / "trees", "html", settings, status=None, warning=warnings
            )
            app.build()
            warnings.seek(0)
            problems = [line.strip().replace(f"{sources}/", "") for line in warnings if line.strip()]
        problems += [
            f"{page.relative_to(pages)} has {page.stat().st_size} bytes: at most {LARGEST} are allowed"
            for page in pages.rglob("*.html")
            if page.stat().st_size > LARGEST
        ]
        _leave_out_what_no_page_needs(pages)
        if folder.exists():
            shutil.rmtree(folder)
        shutil.move(pages, folder)
    for problem in problems:
        tell(problem)
    return len(problems)


def _leave_out_what_no_page_needs(pages: Path) -> None:
    """Delete templates, source maps and icons that no page uses. A first visit then loads 1.5 MB less."""
    for file in [*(pages / STATIC).glob("*macros.html"), *(pages / STATIC).rglob("*.map")]:
        file.unlink()
    script = pages / STATIC / "scripts" / "fontawesome.js"
    texts = (file.read_text(encoding="utf-8") for kind in ("html", "js") for file in pages.rglob(f"*.{kind}"))
    shown = {name for text in texts for name in _ICON_NAME.findall(text)}

    def kept(icon: re2._Match[str]) -> str:
        names = {icon[1], *icon[2].replace('"', "").split(",")}
        return "" if names.isdisjoint(shown) else icon[0]

    script.write_text(_ICON.sub(kept, script.read_text(encoding="utf-8")), encoding="utf-8")


def course_of(edition: str, root: Path, folder: Path) -> Path:
    """Return the course to execute for an edition. For a class, make a hand-out: its cards do not offer solutions.

    Raises:
        autograder.student.handing_out.CannotHandOut: A notebook of the chapters contains the author's own work.
    """
    if edition == SELF:
        return root
    return hand_out(folder / "handed-out", root).place


def _settle_what_is_elsewhere(app: Sphinx, tree: nodes.document) -> None:
    """Change what points outside the website: pictures on other hosts, and links to files of the repository.

    A picture is replaced by its alternative text. A link gets the file's full address; if the course knows no address
    of its repository, the link becomes plain text.
    """
    for picture in list(tree.findall(nodes.image)):
        if str(picture["uri"]).startswith(("http:", "https:")):
            picture.replace_self(nodes.Text(picture.get("alt", "")))
    for link in list(tree.findall(sphinx.addnodes.pending_xref)):
        target = str(link["reftarget"]).partition("#")[0]
        file = os.path.normpath(Path(link["refdoc"]).parent / target)
        if link.get("reftype") != "myst" or not target or Path(file).parts[0] == "..":
            continue
        if (course.root() / file).exists() and not (Path(app.srcdir) / file).is_file():
            base = app.config.course_files
            shown = nodes.reference(refuri=f"{base}/{file}") if base else nodes.inline()
            shown.extend(link.children)
            link.replace_self(shown)


def _let_the_keyboard_move_tables(
    _app: Sphinx, _page: str, _template: str, context: dict[str, Any], _tree: nodes.document | None
) -> None:
    """Make tables focusable, so that readers can scroll a wide table with the arrow keys."""
    context["body"] = context.get("body", "").replace(
        '<table class="table"', '<table class="table" tabindex="0"'
    )


def setup(app: Sphinx) -> dict[str, Any]:
    """Register this module as an extension of Sphinx."""
    app.connect("html-page-context", _let_the_keyboard_move_tables)
    app.add_config_value("course_files", "", "html")
    app.connect("doctree-read", _settle_what_is_elsewhere)
    return {"parallel_read_safe": True}
