"""The map of all notebooks, with what students can do after each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import re2

from autograder import course
from autograder.course import LAB
from autograder.masters.master_files import lab_name

if TYPE_CHECKING:
    from pathlib import Path


_OUTCOME = re2.compile(r"(?m)^\| ([^|]+) \| .*/([\w-]+)\.ipynb\) \|$")
_TITLE = re2.compile(r"(?m)^#\s+(.*?)\s*$")


def learning_outcomes(root: Path) -> dict[str, tuple[str, ...]]:
    """Return the learning outcomes of each lab, from ``docs/learning-outcomes.md``, by the names of the labs.

    Each outcome completes the sentence "After this notebook you can". Without that page there are none.
    """
    outcomes_of: dict[str, tuple[str, ...]] = {}
    page = root / "docs" / "learning-outcomes.md"
    for outcome, lab in _OUTCOME.findall(page.read_text(encoding="utf-8")) if page.exists() else ():
        outcomes_of[lab] = (*outcomes_of.get(lab, ()), outcome)
    return outcomes_of


def notebook_map(master: Path) -> str:
    """Return a folded list of all notebooks of the course, as Markdown for the notebook of ``master``."""
    root = master.parents[3]
    outcomes = learning_outcomes(root)
    lines = ["<details><summary>Learning outcomes: all notebooks, and what you can do after each</summary>"]
    for chapter in course.chapters(root):
        lines += ["", f"**{chapter.title}**", ""]
        for other in (lab / LAB for lab in chapter.labs if (lab / LAB).is_file()):
            told = "; ".join(outcomes.get(lab_name(other), ()))
            lines.append(f"- {link_to(other, master)}{': ' if told else ''}{told}")
    return "\n".join([*lines, "", "</details>"])


def link_to(other: Path, master: Path) -> str:
    """Return a Markdown link to the notebook of the master ``other``, for the notebook of ``master``."""
    title = _TITLE.search(other.read_text(encoding="utf-8"))
    folder = "" if other.parents[1] == master.parents[1] else f"../{other.parents[1].name}/"
    return f"[{title[1] if title else lab_name(other)}]({folder}{lab_name(other)}.ipynb)"
