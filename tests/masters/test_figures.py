"""Figures: drawn as SVG, carried by the notebooks as PNGs."""

from __future__ import annotations

import base64
import re
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import nbformat
import pytest

from autograder.masters.figure_drawing import SIGNATURE, chunk, signed, stale_figures
from autograder.masters.master_cells import figure_digest
from autograder.masters.master_files import MasterError, chapter_path, masters
from autograder.masters.source_notebooks import Points, source_notebook

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).resolve().parents[2]
FIGURES = sorted((ROOT / "solutions").rglob("figures/*.svg"))
each_chapter = pytest.mark.parametrize(
    "chapter", [chapter_path(ROOT, master) for master in masters(ROOT)], ids=lambda path: path.stem
)
SHOWN = re.compile(r"!\[([^\]]*)\]\(attachment:([\w.]+)\)")
LARGEST = 40_000
"""Bytes of a PNG: every notebook of every student carries it."""

SVG = '<svg xmlns="http://www.w3.org/2000/svg"><title>A node</title><desc>It talks [loudly].</desc></svg>'
PNG = SIGNATURE + chunk(b"IHDR", bytes(13)) + chunk(b"IEND", b"")
WITH_A_FIGURE = "# Lab\n\nText.\n\n![](figures/node.svg)\n"


@pytest.fixture
def master(write_master: Callable[[str], Path]) -> Path:
    path = write_master(WITH_A_FIGURE)
    folder = path.parent / "figures"
    folder.mkdir()
    (folder / "node.svg").write_text(SVG)
    (folder / "node.png").write_bytes(signed(PNG, SVG.encode()))
    return path


def test_a_notebook_carries_its_figure_with_its_words(master: Path, ten_points: Points) -> None:
    (cell,) = source_notebook(master, points=ten_points).cells
    assert cell.source.endswith("![A node. It talks loudly.](attachment:node.png)")
    assert base64.b64decode(cell.attachments["node.png"]["image/png"]) == signed(PNG, SVG.encode())


@pytest.mark.parametrize(
    ("name", "content", "problem"),
    [
        ("node.svg", SVG.replace("talks", "listens"), "has changed since its PNG was drawn"),
        ("node.svg", SVG.replace("<desc>It talks [loudly].</desc>", ""), "has no description"),
        ("node.svg", "<svg", "is not an SVG"),
        ("node.png", None, "needs .*node.png"),
        ("node.svg", None, "needs .*node.svg"),
    ],
)
def test_a_figure_that_cannot_be_used_is_refused(
    master: Path, ten_points: Points, name: str, content: str | None, problem: str
) -> None:
    file = master.parent / "figures" / name
    if content is None:
        file.unlink()
    else:
        file.write_text(content)
    with pytest.raises(MasterError, match=problem) as refused:
        source_notebook(master, points=ten_points)
    assert refused.value.line == len(master.read_text().splitlines())


def test_what_was_drawn_is_no_longer_stale(master: Path) -> None:
    root = master.parents[3]
    assert stale_figures(root) == []
    svg = master.parent / "figures" / "node.svg"
    svg.write_text(SVG + "\n")
    assert stale_figures(root) == [svg]


@pytest.mark.parametrize("svg", FIGURES, ids=lambda path: path.stem)
def test_every_figure_is_drawn_and_small_and_says_what_it_shows(svg: Path) -> None:
    png = svg.with_suffix(".png").read_bytes()
    assert png.startswith(SIGNATURE)
    assert figure_digest(svg.read_bytes()) in png
    assert len(png) < LARGEST
    words = ElementTree.parse(svg).getroot().findtext("{http://www.w3.org/2000/svg}desc") or ""
    assert len(words.split()) > 15


def test_every_figure_is_shown_and_nothing_else_is_attached() -> None:
    shown: set[str] = set()
    for master in masters(ROOT):
        for cell in nbformat.read(chapter_path(ROOT, master), as_version=4).cells:
            names = {name for _, name in SHOWN.findall(cell.source)}
            assert names == set(cell.get("attachments", {}))
            shown |= names
    assert shown == {f"{svg.stem}.png" for svg in FIGURES}


@each_chapter
def test_no_picture_needs_more_than_the_notebook(chapter: Path) -> None:
    for cell in nbformat.read(chapter, as_version=4).cells:
        if cell.cell_type == "markdown":
            assert "```mermaid" not in cell.source, "JupyterLab alone draws these"
            assert len(re.findall(r"!\[|<img", cell.source)) == len(SHOWN.findall(cell.source))
