"""``autograder site``: builds the course's website with Sphinx, without access to a network.

The website consists of HTML pages made from the labs, the guides and the list of mistakes. Their sources for Sphinx are
notebooks and Markdown pages, in the folders that their links need.
"""

from __future__ import annotations

import os
import shutil
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import nbformat
import re2
import sphinx.addnodes
from docutils import nodes
from nbformat.v4 import new_code_cell, new_markdown_cell
from sphinx.application import Sphinx

from autograder import course, exercises
from autograder.authoring.executed_masters import run_masters
from autograder.masters.master_files import chapter_path, lab_name, masters
from autograder.masters.notebook_map import learning_outcomes
from autograder.masters.notebook_release import release_text
from autograder.masters.source_notebooks import SET_UP_CELL, source_notebook
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from nbformat import NotebookNode


SOLUTION_SUMMARY = "Solution (click to expand)"
_STATIC = "_static"
_START = "README"
"""The page with which the website begins, so that the links to it in the guides lead there."""
_GUIDES = "docs/README.md"
_FAIRNESS = "docs/fairness.md"
MAX_PAGE_BYTES = 1_000_000
"""The maximum size of a page in bytes."""
_STYLE_SHEET = "book.css"
_SPHINX_SETTINGS: dict[str, Any] = msgspec.toml.decode(
    Path(__file__).with_name("site_settings.toml").read_bytes()
)


def build_site(root: Path, folder: Path, *, outputs: bool, tell: Callable[[str], None]) -> int:
    """Build the website of a course.

    Args:
        root: The top folder of the course.
        folder: The folder for the pages. Pages from an earlier build in it are replaced.
        outputs: True to execute the notebooks first and show their outputs.
        tell: Called with each line to print.

    Returns:
        The number of problems: links that lead nowhere, and pages that are too large.
    """
    with HeldFolder("course-site-") as held:
        executed = run_masters(masters(root), root, tell) if outputs else {}
        sources, pages = held.path / "sources", held.path / "pages"
        sources.mkdir()
        _write_sources(root, sources, executed)
        shutil.copyfile(Path(__file__).with_name(_STYLE_SHEET), sources / _STATIC / _STYLE_SHEET)
        settings = _SPHINX_SETTINGS | _settings_of(root)
        with (held.path / "warnings").open("w+", encoding="utf-8") as warnings:
            app = Sphinx(
                sources, None, pages, held.path / "trees", "html", settings, status=None, warning=warnings
            )
            app.build()
            warnings.seek(0)
            problems = [line.strip().replace(f"{sources}/", "") for line in warnings if line.strip()]
        problems += [
            f"{page.relative_to(pages)} has {page.stat().st_size} bytes: at most {MAX_PAGE_BYTES} are allowed"
            for page in pages.rglob("*.html")
            if page.stat().st_size > MAX_PAGE_BYTES
        ]
        shutil.copyfile(pages / f"{_START}.html", pages / "index.html")
        for file in [*(pages / _STATIC).glob("*macros.html"), *(pages / _STATIC).rglob("*.map")]:
            file.unlink()  # templates and source maps, which no page loads
        # This script draws 2,000 icons in 1.5 MB. The style sheet has the few that pages show.
        (pages / _STATIC / "scripts" / "fontawesome.js").write_text("", encoding="utf-8")
        # Replace the old pages only now, so that a build that fails leaves them as they were.
        if folder.exists():
            shutil.rmtree(folder)
        shutil.move(pages, folder)
    for problem in problems:
        tell(problem)
    return len(problems)


def _title(root: Path) -> str:
    """Return the name of a course: the heading of its README, or the title of its first chapter."""
    readme = root / f"{_START}.md"
    first = readme.read_text(encoding="utf-8").partition("\n")[0] if readme.is_file() else ""
    return first.removeprefix("# ") if first.startswith("# ") else course.chapters(root)[0].title


def _settings_of(root: Path) -> dict[str, Any]:
    """Return the settings for the book of one course: title, author, license and address."""
    title, file = _title(root), root / "pyproject.toml"
    project = msgspec.toml.decode(file.read_bytes()).get("project", {}) if file.is_file() else {}
    authors = ", ".join(one["name"] for one in project.get("authors", ()) if "name" in one)
    address = course.repository(root)
    settings = {"project": title, "html_title": title, "author": authors}
    settings["course_files"] = f"{address}/blob/{course.BRANCH}" if address else ""
    theme = _SPHINX_SETTINGS["html_theme_options"]
    if license_ := project.get("license", ""):
        theme = theme | {"extra_footer": f"License: {escape(str(license_))}"}
    if address:
        theme = theme | {"repository_url": address, "use_repository_button": True}
    return settings | {"html_theme_options": theme}


_ATTACHMENT = re2.compile(r"\(attachment:([^)]+)\.png\)")


def _write_sources(root: Path, folder: Path, executed: Mapping[str, NotebookNode]) -> None:
    """Write the sources of the website.

    Args:
        root: The top folder of the course.
        folder: An empty folder.
        executed: The executed source notebooks, by the names of the labs. The pages of other labs have no outputs.
    """
    (folder / _STATIC).mkdir()
    if (root / "docs").is_dir():
        shutil.copytree(root / "docs", folder / "docs", ignore=shutil.ignore_patterns("*.py", "*.json"))
    start, beside = folder / f"{_START}.md", list[str]()
    start.write_text(f"# {_title(root)}\n", encoding="utf-8")
    for page in sorted(root.glob("*.md")):
        if page.name != start.name:
            beside.append(f"../{page.stem}")
        shutil.copyfile(page, folder / page.name)
    _append(start, _chapters(root))
    if (folder / _GUIDES).is_file():
        _append(folder / _GUIDES, _contents("All pages", _pages_in_order(folder / _GUIDES, beside)))
    if (folder / _FAIRNESS).is_file():
        _append(folder / _FAIRNESS, _task_by_task())
    outcomes = learning_outcomes(root)
    hunts = {one.id.partition(".")[0] for one in exercises.unbroken() if one.hides_causes}
    for master in masters(root):
        # The repairs and outputs of a solved bug hunt tell the causes, so its page has neither.
        is_hunt = lab_name(master) in hunts
        source = (None if is_hunt else executed.get(lab_name(master))) or source_notebook(master)
        file = folder / chapter_path(root, master).relative_to(root)
        file.parent.mkdir(parents=True, exist_ok=True)
        for figure in master.parents[1].glob("**/figures/*.svg"):
            shutil.copyfile(figure, file.with_name(figure.name))
        notebook = book_page(source, outcomes.get(lab_name(master), ()), with_solutions=not is_hunt)
        for cell in notebook.cells:
            cell.source = _ATTACHMENT.sub(r"(\1.svg)", cell.source)
            cell.pop("attachments", None)
        nbformat.write(notebook, file)


def book_page(source: NotebookNode, outcomes: tuple[str, ...] = (), *, with_solutions: bool) -> NotebookNode:
    """Return a lab's page as a notebook with the cells that students get, and folded solutions.

    Args:
        source: The source notebook, with or without outputs.
        outcomes: The learning outcomes of the lab, each completing the sentence "After this notebook you can".
    """
    page = nbformat.reads(release_text(source), as_version=4)
    cells = []
    for solved, cell in zip(source.cells, page.cells, strict=True):
        if cell.get("id") == SET_UP_CELL:  # prepares a kernel
            continue
        changed = solved.source != cell.source
        outputs = solved.get("outputs", [])
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.outputs = [] if changed else outputs
        cells.append(cell)
        if changed and with_solutions:
            cells.append(_folded(solved, outputs))
    if outcomes:
        listed = "\n".join(f"- {one}" for one in outcomes)
        cells.insert(
            1,
            new_markdown_cell(
                f":::{{admonition}} Learning Outcomes\nAfter this notebook you can\n\n{listed}\n:::"
            ),
        )
    page.cells = cells
    page.metadata.pop("celltoolbar", None)
    return page


def _folded(solved: NotebookNode, outputs: list[NotebookNode]) -> NotebookNode:
    if solved.cell_type == "markdown":
        return new_markdown_cell(
            f"<details>\n<summary>{SOLUTION_SUMMARY}</summary>\n\n{solved.source}\n\n</details>"
        )
    lines = solved.source.split("\n")
    shown = [line for line in lines if "### BEGIN SOLUTION" not in line and "### END SOLUTION" not in line]
    labels = {"code_prompt_show": SOLUTION_SUMMARY, "code_prompt_hide": "Solution (click to fold)"}
    return new_code_cell(
        "\n".join(shown), outputs=outputs, metadata={"tags": ["hide-input"], "mystnb": labels}
    )


def _task_by_task() -> str:
    """Return, as Markdown, what the card of each exercise says about what else counts, and what is not graded."""
    sections = []
    for one in exercises.unbroken():
        said = [f"{item.title}: {one.counts[item.name]}" for item in one.criteria if item.name in one.counts]
        if listed := [f"- {text}" for text in (*said, one.counts_as_a_whole) if text]:
            sections.append("\n".join([f"### {one.title}\n", *listed]))
    return "\n\n".join(["\n## Task by task", *sections, ""])


def _chapters(root: Path) -> str:
    """Return the table of contents of the start page as Markdown: the chapters, then the guides."""
    trees = [
        _contents(chapter.title, [f"chapters/{chapter.folder.name}/{lab.name}" for lab in chapter.labs])
        for chapter in course.chapters(root)
    ]
    guides = [_contents("Guides", [_GUIDES])] if (root / _GUIDES).is_file() else []
    return "".join(trees + guides)


_LINK_TO_PAGE = re2.compile(r"\]\((?:\./)?([\w./-]+)\.md(?:#[^)]*)?\)")


def _pages_in_order(guides: Path, beside: Sequence[str]) -> list[str]:
    """Return all pages except the list of guides: first those to which it links, in its order, then the others.

    Args:
        guides: The list of guides, which is ordered for readers.
        beside: Pages outside of its folder.
    """
    places = sorted(guides.parent.rglob("*.md"))
    pages = [*(place.relative_to(guides.parent).with_suffix("").as_posix() for place in places), *beside]
    linked = [page for page in _LINK_TO_PAGE.findall(guides.read_text(encoding="utf-8")) if page in pages]
    return [page for page in dict.fromkeys([*linked, *pages]) if page != guides.stem]


def _append(page: Path, text: str) -> None:
    with page.open("a", encoding="utf-8") as file:
        file.write(text)


def _contents(title: str, pages: Sequence[str]) -> str:
    return f'\n\n```{{toctree}}\n:maxdepth: 1\n:caption: "{title}"\n\n' + "\n".join(pages) + "\n```\n"


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
