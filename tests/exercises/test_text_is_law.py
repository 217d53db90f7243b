"""Every demand of a task is judged or listed as not graded; and every criterion has its words in the task.

Each exercise has the table: the sentences of its notebook, and the criteria that judge them (``Exercise.text``); none
for a sentence that is not graded. What is accepted besides (``Exercise.counts``) stands on the card, not in the task.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import nbformat
import pytest

from autograder import course, exercises
from autograder.authoring.exercise_faults import faults_of_text
from autograder.masters.master_files import chapter_path
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_FOLD = re.compile(r"<details>.*?</details>", re.DOTALL)
_BELONGS_ON_THE_CARD = re.compile(r"(?i)\b(?:not graded|accepted as well|accepted, too|counts? as well)\b")
"""Words that are not part of a requirement."""
LABS = sorted({exercises.path(one).parent for one in exercises.all_ids()})

_HEADING, _ITEM = re.compile(r"#+ "), re.compile(r"\d+\. ")
_NO_DEMAND = (">", "|", "#", "!", "```", "- ", "*")
"""How pitfalls, tables, headings, pictures, code and lists of what there is begin."""
_DEMANDS = re.compile(
    r"(?i)\b(?:must|(?<!not )(?<!would )ha(?:s|ve) to\b(?!$))\b"
    r"|(?:^|[:;,] |\band )(?:let|show|reject|accept|return|raise|log|ask|wait|leave|call)\b"
)
"""What asks for something outside of a numbered list."""
_TOLD = re.compile(
    r"^(?:The judge|The next cell|This cell|ROS|Its `main`|You |But |If you|So )|\b(?:it|you) (?:asks?|must not)\b"
)
"""Sentences that tell what somebody else does."""


def cells(lab: Path) -> list[nbformat.NotebookNode]:
    """The cells of a lab's notebook, as students get them."""
    notebook = nbformat.read(chapter_path(course.root(), lab / "lab.md"), as_version=4)
    return list(notebook.cells)


def plain(text: str) -> str:
    """A text in one line."""
    return " ".join(text.split())


def tasks(lab: Path) -> Iterator[str]:
    """The text above each first cell of a section in which something is to be written."""
    section: list[str] = []
    for cell in cells(lab):
        if cell.cell_type == "markdown":
            section = section if not _HEADING.match(cell.source) else []
            section.append(cell.source)
        elif cell.metadata.get("nbgrader", {}).get("solution", False):
            yield "\n\n".join(section)
            section = []


def asked(task: str) -> str:
    """A task without what is folded."""
    return _FOLD.sub("", task)


def sentences(task: str) -> Iterator[str]:
    """The sentences of a task that demand something: those of numbered items, and those in the words of a demand."""
    for block in re.split(r"\n\s*\n|\n(?=\d+\. |- )", asked(task)):
        if block.lstrip().startswith(_NO_DEMAND):
            continue
        line = plain(block)
        # What stands in code is one word.
        text = re.sub(r"`[^`]*`", lambda code: code[0].replace(" ", "\0"), _ITEM.sub("", line, count=1))
        for part in re.split(r"(?<=[.!?]) (?=[A-Z(`])|(?<=[.!?]\)) (?=[A-Z(`])", text):
            sentence = part.replace("\0", " ")
            item = bool(_ITEM.match(line))
            if not sentence.endswith(":") and (item or demands(sentence)):
                yield sentence.strip(";,.")


def demands(sentence: str) -> bool:
    """Whether a sentence asks for something."""
    return _DEMANDS.search(sentence) is not None and _TOLD.search(sentence) is None


def uncovered(task: str, quoted: list[str]) -> list[str]:
    """The demands of a task that no exercise quotes, be it for a criterion or as not graded."""
    return [sentence for sentence in sentences(task) if not any(quote in sentence for quote in quoted)]


def quoted_in(lab: Path) -> list[str]:
    """All passages that the exercises of a lab quote."""
    ids = [one for one in exercises.all_ids() if exercises.path(one).parent == lab]
    return [passage.strip(";,.") for one in ids for passage in exercises.get(one).text]


@pytest.mark.parametrize("exercise_id", exercises.all_ids())
def test_each_criterion_has_its_sentence_and_each_sentence_its_criterion_and_is_in_the_notebook(
    exercise_id: str,
) -> None:
    said = "\n".join(cell.source for cell in cells(exercises.path(exercise_id).parent))
    assert list(faults_of_text(exercises.get(exercise_id), said)) == []


@pytest.mark.parametrize("lab", LABS, ids=lambda lab: lab.name)
def test_each_demand_is_judged_or_says_that_it_is_not_graded(lab: Path) -> None:
    quoted = quoted_in(lab)
    assert [demand for task in tasks(lab) for demand in uncovered(task, quoted)] == []


@pytest.mark.parametrize("lab", LABS, ids=lambda lab: lab.name)
def test_a_task_is_the_requirement_and_nothing_else(lab: Path) -> None:
    asked_for = [plain(part) for task in tasks(lab) for part in task.split("\n\n")]
    assert [part for part in asked_for if _BELONGS_ON_THE_CARD.search(part)] == []


@pytest.mark.parametrize("added", cases(__file__, "a_demand_that_nobody_judges_is_found"))
def test_a_demand_that_nobody_judges_is_found(added: str) -> None:
    lab = exercises.path("lab_1_3.client").parent
    task = next(text for text in tasks(lab) if "Raise `TimeoutError`" in text)
    assert not uncovered(task, quoted_in(lab))
    assert uncovered(task + added, quoted_in(lab)) == [re.sub(r"^\d+\. ", "", added.strip()).strip(".")]
