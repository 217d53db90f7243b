"""Builds the notebook that is executed and graded, from the trusted master and a student's texts.

Locked cells and check cells come from the master, in the master's order. The submission contributes the text of
solution cells; the cells that the student added, at their places; and the bitmaps that these texts show. Metadata,
tags, outputs and ids of a submission are dropped.
"""

from __future__ import annotations

import itertools
import re  # noqa: TID251  (no pattern here repeats anything, so none can backtrack)
from typing import TYPE_CHECKING

from autograder.execution.executed_cells import CellType
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.cell_matching import Known, match, normalized
from autograder.grading.rebuilding.shown_pictures import ShownPictures
from autograder.kit.in_words import counted

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nbformat import NotebookNode

    from autograder.grading.rebuilding.submitted_notebook import SubmittedCell


_START = ""
_HIDDEN = re.compile(r"(BEGIN|END) (HIDDEN TESTS|MARK SCHEME)")
_ELSEWHERE = (
    "This cell was missing from the notebook that was handed in. Look for its answer in the other cells."
)
_MOST_NAMED = 5


def rebuild(
    master: NotebookNode, submitted: Sequence[SubmittedCell], left_out: int = 0, others: Sequence[str] = ()
) -> NotebookNode:
    """Build the notebook that is executed and graded from the master and the submitted cells.

    Args:
        master: The master, with stubs instead of solutions. Its cells without a grade_id are not used.
        left_out: The number of submitted cells that could not be read.
        others: Other assignments whose graded cells are in the submission.

    Returns:
        A notebook of format 4.5. If anything was repaired, the first cell and the metadata contain remarks about it.
    """
    sorting = _Sorting(master, submitted)
    remarks = [
        f"This notebook also has the checks of {other}. They are not graded here: hand in the notebook of {other}."
        for other in others
    ]
    remarks += sorting.remarks()
    if left_out:
        remarks.append(f"{left_out} cell(s) were not valid notebook cells and were left out.")
    return _finished(master, sorting.cells(), remarks)


def rebuild_unreadable(master: NotebookNode, problem: str) -> NotebookNode:
    """Return a notebook for a submission that cannot be read: the master without answers, and a remark why."""
    remarks = [f"This submission could not be graded. {problem}"]
    return _finished(master, [nbformat_nodes.copied(cell) for cell in master.cells], remarks)


def is_of_another(master: NotebookNode, submitted: Sequence[SubmittedCell]) -> bool:
    """Return True if the cells belong to a different master.

    That is the case if this master knows fewer than half of the cells' names, and the notebook has none of its graded
    cells. Even then, some names may be known, because labs share names.
    """
    names = {cell.grade_id for cell in submitted if cell.grade_id}
    ours = {grade_id(cell) for cell in master.cells}
    graded = {grade_id(cell) for cell in master.cells if cell.metadata.get("nbgrader", {}).get("grade")}
    return len(names - ours) > len(names & ours) and not names & graded


class _Sorting:
    """Assigns submitted cells to the cells of a master, and arranges the cells of the rebuilt notebook."""

    def __init__(self, master: NotebookNode, submitted: Sequence[SubmittedCell]) -> None:
        self._master = {grade_id(cell): cell for cell in master.cells if grade_id(cell)}
        self._submitted = submitted
        self._matches = match([_known(cell) for cell in master.cells], submitted)
        self._places = self._matches.places
        self._chosen = {name: self._choose(name, places) for name, places in self._places.items()}
        self._elsewhere = {
            name: self._choose(name, places) for name, places in self._matches.elsewhere.items()
        }
        for name in [name for name in self._master if name in self._elsewhere]:
            if self._is_in_its_place(name, self._elsewhere[name]):
                self._chosen[name] = self._elsewhere.pop(name)

    def cells(self) -> list[NotebookNode]:
        """Return the cells of the rebuilt notebook."""
        extras, late = self._extras_by_anchor(), self._late_checks()
        built: list[NotebookNode] = []
        pending: list[NotebookNode] = [_extra(cell) for cell in extras.get(_START, [])]
        for name, cell in self._master.items():
            if name not in late:
                if name in self._chosen or is_check(cell):
                    # A deleted check is put back after the cells that the student added, because the check may need
                    # names that these cells define.
                    built += pending
                    pending = []
                built.append(self._filled(name, cell))
            # A deleted cell of another kind is put back before the cells that the student added, because these may
            # redefine its names.
            pending += [_extra(extra) for extra in extras.get(name, [])]
            for check in [check for check, anchor in late.items() if anchor == name]:
                built += [*pending, nbformat_nodes.copied(self._master[check])]
                pending = []
        return built + pending

    def remarks(self) -> list[str]:
        """Return sentences about the differences from the master that the student should know."""
        remarks = []
        in_their_place = self._chosen.keys() & self._matches.elsewhere.keys()
        unmarked = self._matches.unmarked
        if count := len(unmarked) + len(in_their_place):
            remarks.append(
                f"{counted(count, 'cell')} had lost the metadata by which nbgrader knows a cell: some editors and "
                "programs drop it. The grader recognized the cells by their ids or their text."
            )
        remarks += self._on_missing_cells()
        for name, places in self._places.items():
            remarks += self._remarks_on(name, places)
        # A student who moved a cell may rely on the order that the notebook had on the screen.
        order = sorted(self._chosen, key=lambda name: self._chosen[name])
        if order != [name for name in self._master if name in self._chosen]:
            remarks.append("Cells of the notebook had changed places. They were put back into their order.")
        strangers = {
            cell.grade_id
            for place, cell in enumerate(self._submitted)
            if cell.grade_id and cell.grade_id not in self._master and place not in unmarked
        }
        if len(strangers) == 1:
            remarks.append(
                f"This notebook has no graded cell {_quoted(*strangers)}. The cell with this name runs as a cell "
                "that you added."
            )
        elif strangers:
            remarks.append(
                f"This notebook has no graded cells {_listed(sorted(strangers))}. The cells with these names run as "
                "cells that you added."
            )
        return remarks

    def _on_missing_cells(self) -> Iterator[str]:
        missing = [name for name in self._master if name not in self._chosen]
        answers = [name for name in missing if is_answer(self._master[name])]
        given = [name for name in missing if name not in answers]
        if given:
            yield f"{_were(given)} missing and put back."
        if empty := [name for name in answers if name not in self._elsewhere]:
            yield f"{_were(empty)} missing and put back without an answer."
        moved = [name for name in answers if name in self._elsewhere]
        if len(moved) == 1:
            yield f"{_were(moved)} missing. Another cell contains the answer, and that cell counts."
        elif moved:
            yield f"{_were(moved)} missing. Other cells contain the answers, and those cells count."

    def _remarks_on(self, name: str, places: Sequence[int]) -> list[str]:
        master, cell = self._master[name], self._submitted[self._chosen[name]]
        remarks = []
        if len(places) > 1 and is_answer(master):
            remarks.append(
                f"The cell {_quoted(name)} was in the notebook {len(places)} times. Of the copies above its check, "
                "the last one that you changed counts as your answer; the others run as cells that you added."
            )
        elif len(places) > 1:
            remarks.append(f"The cell {_quoted(name)} was in the notebook {len(places)} times. It runs once.")
        if cell.kind != master.cell_type:
            remarks.append(
                f"The cell {_quoted(name)} had become a {cell.kind} cell. "
                f"The cell is a {master.cell_type} cell again."
            )
        if not is_answer(master) and normalized(cell.source) not in map(normalized, _handed_out(master)):
            remarks.append(f"The cell {_quoted(name)} is not yours to change. The original was used.")
        return remarks

    def _choose(self, name: str, places: Sequence[int]) -> int:
        """Return the index of the copy of a cell that counts: the last copy before its check.

        There are two exceptions. An unchanged stub counts only if all copies are unchanged. A copy after the check
        counts only if no copy is before the check.
        """
        stub = self._master[name].source.strip()
        answered = [place for place in places if self._submitted[place].source.strip() != stub] or places
        behind = itertools.dropwhile(lambda other: other != name, self._master)
        checks = (self._places[one] for one in behind if is_check(self._master[one]) and one in self._places)
        check = max(next(checks, [len(self._submitted)]))
        return ([place for place in answered if place < check] or answered)[-1]

    def _anchor(self, place: int) -> str:
        """Return the name of the cell at an index of the submission, or of the nearest named cell before it."""
        before = {at: name for name, at in self._chosen.items() if at <= place}
        return before[max(before)] if before else _START

    def _is_in_its_place(self, name: str, place: int) -> bool:
        """Return True if the cell at an index stands at the place of the missing answer cell."""
        names, anchor = list(self._master), self._anchor(place)
        behind = {at: other for other, at in self._chosen.items() if at > place}
        return (
            place not in self._chosen.values()
            and (not anchor or names.index(anchor) < names.index(name))
            and (not behind or names.index(name) < names.index(behind[min(behind)]))
        )

    def _late_checks(self) -> dict[str, str]:
        """Return the checks that have to move down, because the answer is in a later cell.

        The value for each check is the name of the cell after which the check has to stand.
        """
        names = list(self._master)
        late: dict[str, str] = {}
        for name, place in self._elsewhere.items():
            check = next((one for one in names[names.index(name) :] if is_check(self._master[one])), "")
            anchor = self._anchor(place)
            if check and anchor and names.index(anchor) >= names.index(check):
                late[check] = max(late.get(check, anchor), anchor, key=names.index)
        return late

    def _extras_by_anchor(self) -> dict[str, list[SubmittedCell]]:
        """Return the cells that the student added, grouped by the name of the nearest named cell before them."""
        anchors = {place: name for name, place in self._chosen.items()}
        given = {
            place
            for name, places in self._places.items()
            if not is_answer(self._master[name])
            for place in places
        }
        groups: dict[str, list[SubmittedCell]] = {}
        anchor = _START
        for index, cell in enumerate(self._submitted):
            if index in anchors:
                anchor = anchors[index]
            elif index not in given:
                groups.setdefault(anchor, []).append(cell)
        return groups

    def _filled(self, name: str, cell: NotebookNode) -> NotebookNode:
        filled = nbformat_nodes.copied(cell)
        if not is_answer(cell):
            return filled
        filled.pop("attachments", None)
        graded_by_hand = cell.metadata.nbgrader.get("grade", False)
        if name in self._chosen:
            answer = self._submitted[self._chosen[name]]
            filled.update(source=answer.source, attachments=_attachments(answer))
        elif name in self._elsewhere or (graded_by_hand and self._matches.own):
            # The missing answer cell gets a note that sends a person to the other cells. The stub would overwrite the
            # student's definitions in these cells.
            filled["source"] = _ELSEWHERE if cell.cell_type == CellType.MARKDOWN else f"# {_ELSEWHERE}"
        return filled


def _finished(master: NotebookNode, cells: list[NotebookNode], remarks: list[str]) -> NotebookNode:
    if remarks:
        lines = ["**Remarks of the grader**", "", *(f"- {_escaped(remark)}" for remark in remarks)]
        cells = [nbformat_nodes.cell(CellType.MARKDOWN, "\n".join(lines)), *cells]
    pictures = ShownPictures(
        (_handed_out(cell)[1], cell.get("attachments", {}))
        for cell in master.cells
        if not is_the_masters(cell)
    )
    for index, cell in enumerate(cells):
        # `cell["id"]` is faster than `cell.id`, because for an attribute a NotebookNode first searches its class.
        # The id is made from the cell's index and name, and is not a random id, so that each run gives the same file.
        cell["id"] = re.sub(r"[^A-Za-z0-9_-]", "-", f"{index}-{grade_id(cell) or 'own'}")[:64]
        attached = cell.pop("attachments", {})
        shown = attached if is_the_masters(cell) else pictures.of(cell["source"], attached)
        if cell["cell_type"] == CellType.MARKDOWN and shown:
            cell["attachments"] = shown
        if cell["cell_type"] == CellType.CODE:
            cell["outputs"] = []
            cell["execution_count"] = None
    return nbformat_nodes.notebook(
        cells,
        {
            "kernelspec": {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"},
            "language_info": {"name": "python", "pygments_lexer": "ipython3", "file_extension": ".py"},
            "autograder": {"remarks": remarks},
        },
    )


def grade_id(cell: NotebookNode) -> str:
    """Return the name (grade_id) of a master's cell; empty if it has none."""
    return str(cell.metadata.get("nbgrader", {}).get("grade_id", ""))


def is_answer(cell: NotebookNode) -> bool:
    """Return True if students fill in the cell."""
    return bool(cell.metadata.get("nbgrader", {}).get("solution", False))


def is_check(cell: NotebookNode) -> bool:
    """Return True if the cell is graded automatically."""
    marked = bool(cell.metadata.get("nbgrader", {}).get("grade", False))
    return marked and not is_answer(cell) and cell.cell_type == CellType.CODE


def is_the_masters(cell: NotebookNode) -> bool:
    """Return True if a cell of a rebuilt notebook was copied from the master unchanged."""
    marks = cell.get("metadata", {}).get("nbgrader", {})
    return bool(marks.get("locked")) and not marks.get("solution")


def _known(cell: NotebookNode) -> Known:
    return Known(
        name=grade_id(cell),
        kind=CellType(cell.cell_type),
        identifier=str(cell.get("id", "")),
        texts=_handed_out(cell),
        is_answer=is_answer(cell),
        given=str(cell.metadata.get("autograder", {}).get("given", "")),
    )


def _handed_out(cell: NotebookNode) -> tuple[str, str]:
    """Return the full text of a master's cell, and its text for students: no hidden tests and no mark scheme."""
    lines, hidden = [], False
    for line in cell.source.splitlines():
        if _HIDDEN.search(line):
            hidden = "BEGIN" in line
        elif not hidden:
            lines.append(line)
    return cell.source, "\n".join(lines)


def _extra(cell: SubmittedCell) -> NotebookNode:
    node = nbformat_nodes.cell(cell.kind, cell.source, "own")
    node["attachments"] = _attachments(cell)
    return node


def _attachments(cell: SubmittedCell) -> dict[str, dict[str, str]]:
    return {name: {kind: data} for name, kind, data in cell.pictures}


def _escaped(text: str) -> str:
    """Escape Markdown and HTML in a remark, because it may quote a student's text."""
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return re.sub(r"([\\\[\]*#!|~$])", r"\\\1", " ".join(text.split()))


def _were(names: Sequence[str]) -> str:
    """Return the beginning of a sentence, such as "The cell `x` was"."""
    return (
        f"The cell {_quoted(*names)} was"
        if len(names) == 1
        else f"{len(names)} cells ({_listed(names)}) were"
    )


def _listed(names: Sequence[str]) -> str:
    """Return a list of names as text, shortened if there are many."""
    return ", ".join(map(_quoted, names[:_MOST_NAMED])) + (" …" if len(names) > _MOST_NAMED else "")


def _quoted(name: str) -> str:
    return "`" + re.sub(r"[^\w.\-]", "?", name)[:80] + "`"
