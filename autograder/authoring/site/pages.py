"""Writes the website's sources for Sphinx: notebooks and Markdown pages, in the folders that their links need."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING
from urllib.parse import unquote

import nbformat
import re2
from nbformat.v4 import new_code_cell, new_markdown_cell

from autograder import course
from autograder.authoring.site.outputs import MOVING
from autograder.masters.first_cell import NAME as SET_UP_CELL
from autograder.masters.layout import chapter_path, lab_name, masters
from autograder.masters.release import release_text
from autograder.masters.source import source_notebook

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from nbformat import NotebookNode

SELF, CLASS = "self", "class"
EDITIONS = (SELF, CLASS)
"""The editions of the website: ``self`` for learners on their own, with solutions; ``class`` without solutions."""
SUMMARY = "Solution (click to expand)"
STATIC = "_static"
_ATTACHMENT = re2.compile(r"\(attachment:([^)]+)\)")
_NOTEBOOK_LINK = re2.compile(r"\]\(([\w./-]*\.ipynb)#([^)]+)\)")
_README_PICTURE = re2.compile(r"!\[[^\]]*\]\(docs/images/[^)]+\)")
_WAYS = re2.compile(r"^(← Previous: |Next: )")
_OUTCOME = re2.compile(r"(?m)^\| ([^|]+) \| [^|]+ \| .*/([\w-]+)\.ipynb\) \|$")
_READER = re2.compile(r"(?m)^\*\*(.+)\*\*$")
_TARGET = re2.compile(r"\]\(([^)#:]+)[^)]*\)")


def write_sources(root: Path, folder: Path, edition: str, executed: Mapping[str, NotebookNode]) -> None:
    """Write the sources of the website.

    Args:
        root: The top folder of the course.
        folder: An empty folder.
        edition: A value from ``EDITIONS``.
        executed: The executed source notebooks, by the names of the labs. The pages of other labs have no outputs.
    """
    (folder / STATIC).mkdir()
    if (root / "docs").is_dir():
        shutil.copytree(root / "docs", folder / "docs", ignore=shutil.ignore_patterns("*.py", "*.json"))
    (folder / "index.md").write_text(f"# {course.chapters(root)[0].title}{_contents(root)}", encoding="utf-8")
    for page in root.glob("*.md"):
        name = "index.md" if page.name == "README.md" else page.name
        text = page.read_text(encoding="utf-8")
        if name == "index.md" and edition == CLASS:  # the pictures in README may show a solution
            text = _README_PICTURE.sub("", text)
        (folder / name).write_text(text + _contents(root) if name == "index.md" else text, encoding="utf-8")
    for page in folder.rglob("*.md"):
        text = (
            page.read_text(encoding="utf-8")
            .replace("../README.md", "../index.md")
            .replace("](README.md", "](index.md")
        )
        page.write_text(_with_plain_anchors(text), encoding="utf-8")
    outcomes = _outcomes(root)
    for master in masters(root):
        source = executed.get(lab_name(master)) or source_notebook(master)
        for name, picture in source.metadata.pop(MOVING, {}).items():
            (folder / STATIC / name).write_text(picture, encoding="utf-8")
        file = folder / chapter_path(root, master).relative_to(root)
        file.parent.mkdir(parents=True, exist_ok=True)
        figures = {svg.with_suffix(".png").name: svg for svg in master.parents[1].glob("**/figures/*.svg")}
        notebook = book_page(source, edition, outcomes.get(lab_name(master), ()))
        for cell in notebook.cells:
            for name in _ATTACHMENT.findall(cell.source):
                shutil.copyfile(figures[unquote(name)], file.with_name(figures[unquote(name)].name))
            cell.source = _ATTACHMENT.sub(lambda found: f"({unquote(found[1])[:-4]}.svg)", cell.source)
            cell.pop("attachments", None)
        nbformat.write(notebook, file)


def book_page(source: NotebookNode, edition: str, outcomes: tuple[str, ...] = ()) -> NotebookNode:
    """Return a lab's page as a notebook with the cells that students get, and folded solutions for learners alone.

    Args:
        source: The source notebook, with or without outputs.
        edition: A value from ``EDITIONS``.
        outcomes: The learning outcomes of the lab, each completing the sentence "After this notebook you can".
    """
    page = nbformat.reads(release_text(source), as_version=4)
    secret = _lines_of_solutions(source, page) if edition == CLASS else frozenset[str]()
    cells = []
    for solved, cell in zip(source.cells, page.cells, strict=True):
        # Leave out the links between notebooks, because the website has its own, and the cell that prepares a kernel.
        if _WAYS.match(cell.source) or cell.get("id") == SET_UP_CELL:
            continue
        changed = solved.source != cell.source
        outputs = [one for one in solved.get("outputs", []) if secret.isdisjoint(_printed(one))]
        cell.metadata = {}
        if cell.cell_type == "markdown":
            cell.source = _with_plain_anchors(cell.source)
        else:
            cell.outputs = [] if changed else outputs
        cells.append(cell)
        if changed and edition == SELF:
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


def _lines_of_solutions(source: NotebookNode, page: NotebookNode) -> frozenset[str]:
    """Return the lines that only the solutions contain. An output that shows such a line gives a solution away."""
    solved, open_ = (
        {line.strip() for cell in notebook.cells for line in cell.source.split("\n")}
        for notebook in (source, page)
    )
    return frozenset(line for line in solved - open_ if any(map(str.isalnum, line)))


def _printed(output: NotebookNode) -> set[str]:
    text = str(output.get("text", "")) + str(output.get("data", {}).get("text/plain", ""))
    return {line.strip() for line in text.split("\n")}


def _folded(solved: NotebookNode, outputs: list[NotebookNode]) -> NotebookNode:
    if solved.cell_type == "markdown":
        return new_markdown_cell(f"<details>\n<summary>{SUMMARY}</summary>\n\n{solved.source}\n\n</details>")
    lines = solved.source.split("\n")
    shown = [line for line in lines if "### BEGIN SOLUTION" not in line and "### END SOLUTION" not in line]
    said = {"code_prompt_show": SUMMARY, "code_prompt_hide": "Solution (click to fold)"}
    return new_code_cell("\n".join(shown), outputs=outputs, metadata={"tags": ["hide-input"], "mystnb": said})


def _with_plain_anchors(text: str) -> str:
    """Return a text whose links to headings of notebooks have anchors in lower case, as Sphinx writes them."""

    def plain(link: re2._Match[str]) -> str:
        anchor = re2.sub(r"[^\w\- ]", "", unquote(link[2]).lower()).replace(" ", "-")
        return f"]({link[1]}#{anchor})"

    return _NOTEBOOK_LINK.sub(plain, text)


def _outcomes(root: Path) -> dict[str, tuple[str, ...]]:
    """Return the learning outcomes of each lab, from ``docs/learning-outcomes.md``, by the names of the labs."""
    found: dict[str, tuple[str, ...]] = {}
    page = root / "docs" / "learning-outcomes.md"
    for outcome, lab in _OUTCOME.findall(page.read_text(encoding="utf-8")) if page.exists() else ():
        found[lab] = (*found.get(lab, ()), outcome)
    return found


def _contents(root: Path) -> str:
    """Return the table of contents as Markdown: first the chapters, then the guides for each kind of reader."""
    trees = {}
    for chapter in course.chapters(root):
        trees[chapter.title] = [f"chapters/{chapter.folder.name}/{lab.name}" for lab in chapter.labs]
    for title, pages in _guides(root.resolve()).items():
        trees[title] = [str(page.relative_to(root.resolve()).with_suffix("")) for page in pages]
    return "".join(
        f'\n\n```{{toctree}}\n:hidden:\n:caption: "{title}"\n\n' + "\n".join(pages) + "\n```\n"
        for title, pages in trees.items()
        if pages
    )


def _guides(root: Path) -> dict[str, list[Path]]:
    """Return the guides by kind of reader, as listed in ``docs/README.md``. Pages that are not listed come last."""
    index = root / "docs" / "README.md"
    _, *parts = _READER.split(index.read_text(encoding="utf-8") if index.is_file() else "")
    left = {*root.glob("*.md"), *(root / "docs").rglob("*.md")} - {root / "README.md"}
    found = {}
    for reader, listed in zip(parts[::2], parts[1::2], strict=True):
        places = [(index.parent / target).resolve() for target in _TARGET.findall(listed)]
        pages = [
            page for place in places for page in (sorted(place.glob("*.md")) if place.is_dir() else [place])
        ]
        found[f"For {reader[:1].lower()}{reader[1:]}"] = [
            page for page in dict.fromkeys(pages) if page in left
        ]
        left.difference_update(pages)
    return found | {"About": sorted(left)}
