"""The words of the chapters' notebooks, and how many come before the next thing to do.

``python -m tests.chapter_words`` lists them. A student came to write, to predict and to see something move. So the
words of each notebook are held by a ceiling in ``chapter_words.toml``: it may be lowered, never raised. Words are
counted as a student meets them: the text, the comments and docstrings of given code, the labels of figures, and, in a
notebook that was executed, what its cells show.
"""

from __future__ import annotations

import ast
import io
import sys
import tokenize
import tomllib
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat
import re2
from bs4 import BeautifulSoup

from autograder.masters.source_notebooks import SET_UP_CELL

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[1]
CEILINGS = ROOT / "tests" / "chapter_words.toml"
_FIGURE = re2.compile(r"!\[[^\]]*\]\(([^)]+\.svg)\)")
_FOLD = re2.compile(r"(?s)<details>.*?</details>")
_ANSWERS = re2.compile(r"(?s)(?:<details>\s*<summary>.*?</details>\s*)+")
_SUMMARY = re2.compile(r"(?s)<summary>(.*?)</summary>")
_TARGET = re2.compile(r"\]\([^)\s]*\)")
_WORD = re2.compile(r"\pL[\pL\pN'’_./-]*|\pN+")


@dataclass(frozen=True)
class Words:
    """The words of a notebook.

    Attributes:
        visible: What a student sees without opening a fold.
        folded: What the folds hold besides: answers and hints.
        gaps: The visible words before each thing to do, and after the last one.
    """

    visible: int
    folded: int
    gaps: tuple[int, ...]

    @property
    def things_to_do(self) -> int:
        """The cells that a student writes and the questions that a student answers."""
        return len(self.gaps) - 1


def words_of(path: Path) -> Words:
    """Count the words of a notebook, executed or not.

    Args:
        path: The notebook. Its figures are found from its folder.
    """
    notebook = nbformat.read(path, as_version=4)
    marks, visible, folded = [0], 0, 0
    for cell in notebook.cells:
        if cell.metadata.get("nbgrader", {}).get("grade_id") == SET_UP_CELL:
            continue  # hidden in JupyterLab as ./course lab opens it
        if cell.cell_type == "markdown":
            for number, piece in enumerate(_pieces(cell.source)):
                if number:
                    marks.append(visible)
                shown = _FOLD.sub(lambda fold: " ".join(_SUMMARY.findall(fold.group())), piece)
                folded += _count(piece) - _count(shown)
                visible += _count(shown) + sum(map(_count, _labels(shown, path.parent)))
        else:
            visible += _count(_told(cell.source)) + sum(map(_count, _printed(cell)))
            if cell.metadata.get("nbgrader", {}).get("solution"):
                marks.append(visible)
    return Words(visible, folded, tuple(b - a for a, b in pairwise([*marks, visible])))


def _pieces(text: str) -> list[str]:
    """Return a text in pieces. Each piece but the first begins with the folded answers to a question."""

    def marked(folds: Any) -> str:
        answers = folds.group()
        return f"\0{answers}" if "✓" in answers or "<summary>Answer</summary>" in answers else answers

    return _ANSWERS.sub(marked, text).split("\0")


def _count(text: str) -> int:
    """Count the words that are read: not the targets of links and figures, and no markup."""
    return len(_WORD.findall(BeautifulSoup(_TARGET.sub("]", text), "html.parser").get_text(" ")))


def _labels(text: str, folder: Path) -> Iterator[str]:
    for name in _FIGURE.findall(text):
        drawing = BeautifulSoup((folder / name).read_text(), "html.parser")
        yield " ".join(label.get_text(" ") for label in drawing.find_all("text"))


def _told(code: str) -> str:
    """Return the comments and docstrings of a cell; of a shell cell, its comments."""
    told = [line.partition("# ")[2] for line in code.splitlines() if line.lstrip().startswith("# ")]
    if code.startswith("%%bash"):
        return " ".join(told)
    python = code.partition("\n")[2] if code.startswith("%%") else code
    try:
        nodes = list(ast.walk(ast.parse(python)))
        tokens = list(tokenize.generate_tokens(io.StringIO(python).readline))
    except SyntaxError:  # another language, such as XML, or a line of IPython's
        return " ".join(told)
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    docstrings = [ast.get_docstring(node) or "" for node in nodes if isinstance(node, documented)]
    return " ".join([*docstrings, *(token.string for token in tokens if token.type == tokenize.COMMENT)])


def _printed(cell: nbformat.NotebookNode) -> Iterator[str]:
    for output in cell.get("outputs", ()):
        data = output.get("data", {})
        yield output.get("text", "") or data.get("text/html", "") or data.get("text/plain", "")


def notebooks() -> dict[str, Words]:
    """Return the words of each notebook of each chapter, by its path below ``chapters``."""
    paths = sorted((ROOT / "chapters").glob("*/*.ipynb"))
    return {path.relative_to(ROOT / "chapters").as_posix(): words_of(path) for path in paths}


def ceilings() -> dict[str, dict[str, int]]:
    """Return the most visible words and the longest gap of each notebook."""
    return tomllib.loads(CEILINGS.read_text())


def above(counted: dict[str, Words], allowed: dict[str, dict[str, int]]) -> list[str]:
    """Return a sentence for each notebook that has more words than allowed, or a longer way to the next thing to do."""
    faults = []
    for name, words in counted.items():
        most = allowed.get(name, {"visible": 1700, "gap": 250})
        if words.visible > most["visible"]:
            faults.append(f"{name}: {words.visible} visible words; {most['visible']} are allowed.")
        if max(words.gaps) > most["gap"]:
            faults.append(
                f"{name}: {max(words.gaps)} words without a thing to do; {most['gap']} are allowed."
            )
    return faults


def main(paths: list[str]) -> int:
    """Print a line for each notebook: of the chapters, or of the paths. Return the exit code."""
    counted = {path: words_of(Path(path)) for path in paths} or notebooks()
    print(f"{'notebook':48}{'visible':>8}{'folded':>8}{'to do':>7}{'mean':>6}{'longest':>9}")
    for name, words in counted.items():
        mean = round(words.visible / max(1, words.things_to_do))
        print(f"{name:48}{words.visible:8}{words.folded:8}{words.things_to_do:7}{mean:6}{max(words.gaps):9}")
    print(
        f"{'all':48}{sum(w.visible for w in counted.values()):8}{sum(w.folded for w in counted.values()):8}"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
