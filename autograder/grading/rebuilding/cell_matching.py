"""Matches submitted cells with cells of the master, even if an editor has dropped nbgrader's metadata."""

from __future__ import annotations

import ast
import functools
import posixpath
from dataclasses import dataclass
from typing import TYPE_CHECKING

import re2

from autograder.execution.executed_cells import CellType
from autograder.masters.code_cells import python_of, written_file

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.grading.rebuilding.submitted_notebook import SubmittedCell


_WRITES = re2.compile(r"\A\s*%%(?:writefile|program)[ \t]+(?:-a[ \t]+|--append[ \t]+)?[\"']?([^\s\"']+)")


@dataclass(frozen=True)
class Known:
    """A cell of the master, with the properties by which a submitted copy of it is recognized.

    Attributes:
        name: The grade_id of the cell; empty for a text cell that nbgrader does not know.
        kind: The type of the cell.
        identifier: The id of the cell in the released notebook.
        texts: The cell's text in the master and in the released notebook.
        is_answer: True if students write this cell.
        given: The part of an answer's text that students receive, for example the question above the answer.
    """

    name: str
    kind: CellType
    identifier: str
    texts: tuple[str, ...]
    is_answer: bool
    given: str = ""


@dataclass(frozen=True)
class Matches:
    """The result of matching.

    Attributes:
        places: For each cell of the master, by grade_id, the indexes of the submitted cells that match it.
        unmarked: The indexes of the submitted cells that match a cell of the master although they lost their grade_id.
        elsewhere: For each answer cell without a match, by grade_id, the indexes of the submitted cells that define
            the same names or write the same file.
        own: The indexes of the cells that match no cell of the master and contain a student's text.
    """

    places: Mapping[str, Sequence[int]]
    unmarked: frozenset[int]
    elsewhere: Mapping[str, Sequence[int]]
    own: frozenset[int]


def match(master: Sequence[Known], submitted: Sequence[SubmittedCell]) -> Matches:
    """Match the submitted cells with those of the master.

    Args:
        master: The cells of the master, in order.
    """
    return _Matching(master, submitted).matches()


def normalized(text: str) -> str:
    """Return a text without spaces at line ends and without empty lines at its beginning and end."""
    return "\n".join(line.rstrip() for line in text.strip().splitlines())


class _Matching:
    def __init__(self, master: Sequence[Known], submitted: Sequence[SubmittedCell]) -> None:
        self._master = {cell.name: cell for cell in master if cell.name}
        self._submitted = submitted
        handed_out = {"", *(normalized(text) for cell in master for text in cell.texts)}
        self._written = {
            place for place, cell in enumerate(submitted) if normalized(cell.source) not in handed_out
        }
        """The indexes of the cells that contain a student's text."""
        self._unmarked: set[int] = set()
        self._places: dict[str, list[int]] = {}
        for place, cell in enumerate(submitted):
            if cell.grade_id in self._master:
                self._places.setdefault(cell.grade_id, []).append(place)

    def matches(self) -> Matches:
        """Match the cells in several ways, from the surest to the least sure."""
        self._match_ids()
        self._match_texts()
        self._match_given_parts()
        elsewhere = self._elsewhere()
        taken = {place for places in self._places.values() for place in places}
        return Matches(self._places, frozenset(self._unmarked), elsewhere, frozenset(self._written - taken))

    def _match_ids(self) -> None:
        """Match cells by their ids, if no grade_id has matched them."""
        names = {cell.identifier: cell.name for cell in self._missing() if cell.identifier}
        for place, cell in self._left():
            self._take(names.get(cell.identifier, ""), place)

    def _match_texts(self) -> None:
        """Match cells by equal text. If several cells have the same text, match them in their order."""
        names: dict[str, list[str]] = {}
        for missing in self._missing():
            for text in {normalized(text) for text in missing.texts} - {""}:
                names.setdefault(text, []).append(missing.name)
        for place, cell in self._left():
            same = names.get(normalized(cell.source), [])
            self._take(next((name for name in same if name not in self._places), ""), place)

    def _match_given_parts(self) -> None:
        """Match an answer that defines no names, such as a text, with a cell that contains the question."""
        for missing in self._missing():
            if not missing.is_answer or _defines(missing) or not self._is_telling(missing):
                continue
            for place, cell in self._left():
                if cell.kind is missing.kind and _has_lines(cell.source, missing.given):
                    self._take(missing.name, place)

    def _elsewhere(self) -> dict[str, list[int]]:
        """Return, for each answer cell without a match, the submitted cells that define the same names.

        A given cell in which a student wrote the answer is found, too: with the answer, the cell no longer matches the
        master's cell.
        """
        code = {
            place: cell.source
            for place, cell in enumerate(self._submitted)
            if cell.kind is CellType.CODE and place in self._written
        }
        left = [place for place, _ in self._left() if place in code]
        candidates = {}
        for missing in self._missing() if code else ():
            if missing.is_answer:
                places = [place for place, text in code.items() if _is_answered_by(missing, text)]
                places = places or [place for place in left if _is_mentioned_by(missing, code[place])]
                if places:
                    candidates[missing.name] = places
        # A given cell into which an answer was written counts as the answer, and must not also match the given cell.
        merged = {place for places in candidates.values() for place in places}
        for name in [name for name in self._places if not self._master[name].is_answer]:
            self._places[name] = [place for place in self._places[name] if place not in merged]
            if not self._places[name]:
                del self._places[name]
        return candidates

    def _take(self, name: str, place: int) -> None:
        if name and name not in self._places:
            self._places[name] = [place]
            self._unmarked.add(place)

    def _missing(self) -> list[Known]:
        return [cell for name, cell in self._master.items() if name not in self._places]

    def _left(self) -> list[tuple[int, SubmittedCell]]:
        taken = {place for places in self._places.values() for place in places}
        return [(place, cell) for place, cell in enumerate(self._submitted) if place not in taken]

    def _is_telling(self, missing: Known) -> bool:
        """Return True if the given part of a cell identifies it: no other cell of the master contains this part."""
        others = (text for cell in self._master.values() if cell is not missing for text in cell.texts)
        return bool(missing.given.strip()) and not any(_has_lines(text, missing.given) for text in others)


def _defines(answer: Known) -> str:
    """Return the path of the file that a stub writes, a pattern for the names that it defines, or an empty text."""
    return _file(answer.texts[0]) or (_names(answer.texts[0]) if answer.kind is CellType.CODE else "")


def _is_answered_by(answer: Known, text: str) -> bool:
    """Return True if a cell's text writes the same file as a stub, or defines one of the stub's names."""
    if file := _file(answer.texts[0]):
        return _file(text) == file
    names = _names(answer.texts[0])
    return bool(names) and re2.search(names, text) is not None


def _is_mentioned_by(answer: Known, text: str) -> bool:
    """Return True if a text contains the name of the file that a stub writes, and so may write this file."""
    file = re2.escape(posixpath.basename(_file(answer.texts[0])))
    return bool(file) and re2.search(rf"(?:^|[^\w.-]){file}(?:[^\w-]|$)", text) is not None


def _file(source: str) -> str:
    """Return the path of the file that a cell writes by a magic; empty if it has no such magic."""
    magic = _WRITES.match(source)
    return posixpath.normpath(magic[1]) if magic else ""


@functools.lru_cache(maxsize=1024)
def _names(stub: str) -> str:
    """Return a pattern for code that defines a name of the stub; empty if the stub defines no name."""
    names = "|".join(map(re2.escape, _defined_names(stub)))
    return (
        rf"(?m)^(?:(?:async[ \t]+)?def|class)[ \t]+(?:{names})\b"
        rf"|^(?:{names})[ \t]*(?::[^=\n]*)?=(?:[^=]|$)"
        rf"|^(?:from|import)\b.*\b(?:{names})\b"
        if names
        else ""
    )


def _defined_names(stub: str) -> list[str]:
    if written_file(stub) is not None:
        return []
    try:
        body = ast.parse(python_of(stub)).body
    except SyntaxError:
        return []  # a stub by an instructor may contain a magic, which is not valid Python
    names = []
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            names.append(node.name)
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names += [target.id for target in targets if isinstance(target, ast.Name)]
    return names


def _has_lines(text: str, lines: str) -> bool:
    """Return True if a text contains all the lines, in their order, without regard to spaces around a line."""
    there = (line.strip() for line in text.splitlines())
    return all(line.strip() in there for line in lines.splitlines() if line.strip())
