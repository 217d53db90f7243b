"""Keeps what the mutants of a solution do in the practice drawings, in a file beside the reference output."""

from __future__ import annotations

import ast
import json
from collections import defaultdict
from typing import TYPE_CHECKING, Any

import msgspec

from autograder import course, exercises
from autograder.authoring.mutants.code import Code
from autograder.authoring.mutants.engine import Mutant, mutants, python_changes
from autograder.authoring.mutants.meanings import Places
from autograder.authoring.mutants.survey import LATE
from autograder.authoring.mutants.trials import paper_task, run_all
from autograder.authoring.reference_files import reference_solution
from autograder.judge import evidence_files
from autograder.kit.oracle.naming.deltas import Meaning, MutantClass, Mutants, alike
from autograder.masters.code_cells import BEGIN, END
from autograder.packed_files import packed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from autograder.authoring.mutants.solutions import Solution
    from autograder.authoring.mutants.survey import Survey
    from autograder.authoring.mutants.trials import Run
    from autograder.kit.evidence import Part
    from autograder.kit.model import Exercise

Did = dict[str, dict[str, dict[int, Any]]]
"""The values of each output that are not the solution's, by drawing, output and step."""


def write(exercise: Exercise, found: Survey) -> None:
    """Write the file of an exercise.

    Raises:
        NotOnPaper: The exercise cannot be run on paper.
    """
    file, data = exercises.mutants_path(exercise.id), packed(msgspec.json.encode(recorded(exercise, found)))
    if not file.exists() or file.read_bytes() != data:
        file.write_bytes(data)


def recorded(exercise: Exercise, found: Survey) -> Mutants:
    """Return what mutants do in the practice drawings: those of a survey, and those of the lines around the student's.

    The drawings need not tell a mistake in given lines, but a student who types them again may make one.
    """
    of, stored = found.solution, evidence_files.load_reference(exercise.id)
    parts, code = stored.parts, Code(of.text, subject=of.root)
    task = paper_task(exercise, stored, of.text, of.root, fresh=0)
    around = given_mutants(of)
    order = {one.key: number for number, one in enumerate(around)}
    given = sorted(run_all(task, ((one, one.text) for one in around)), key=lambda pair: order[pair[0].key])
    tried = [*((one.mutant, one.runs) for one in found.tried if one.mutant.start >= 0), *given]
    places = Places(code, exercise.text, _visible(of.exercise))
    groups: dict[str, list[Meaning]] = defaultdict(list)
    for mutant, runs in tried:
        if did := _differences(parts, runs, exercise.tolerance):
            groups[json.dumps(did, sort_keys=True)].append(places.meaning(mutant))
    meanings = list(dict.fromkeys(one for group in groups.values() for one in group))
    classes = [
        MutantClass(sorted({meanings.index(one) for one in group}), _parsed(did))
        for did, group in groups.items()
    ]
    methods = [name for name in dict.fromkeys(one.name for one in code.functions()) if places.shows(name)]
    return Mutants(evidence_files.parts_digest(parts), meanings, classes, methods)


def given_mutants(of: Solution) -> list[Mutant]:
    """Return the mutants of a solution in the given lines of the cells that the student fills in."""
    names = {name for cell in reference_solution(of.exercise).own for name in _defined(cell)}
    code = Code(of.text, subject=of.root)
    spans = [code.span(one) for one in code.tree.body if getattr(one, "name", "") in names]
    changes = [
        (operator, edit)
        for operator, edit in python_changes(code)
        if operator != LATE
        and any(begin <= edit.start < end for begin, end in spans)
        and not any(of.is_own(piece.start) for piece in edit.pieces)
    ]
    return mutants(of.text, changes)


def _defined(cell: str) -> list[str]:
    """Return the names of the classes and functions of a cell; none for one with a magic, which no notebook imports."""
    try:
        body = ast.parse(cell).body
    except SyntaxError:
        return []
    return [one.name for one in body if isinstance(one, (ast.ClassDef, ast.FunctionDef))]


def _differences(parts: Sequence[Part], runs: Sequence[Run], tolerance: float) -> Did:
    """Return what a mutant does differently; nothing if it crashes in a drawing, or has not all steps in one."""
    found: Did = {}
    if len(runs) < len(parts):
        return {}
    for part, run in zip(parts, runs, strict=False):
        noted = json.loads(run.outputs)[0] if run.outputs else []
        mine = {(name, step): values for name, step, values in noted}
        theirs = {
            (event.name, event.data.get("step", -1)): event.data.get("values") for event in part.of("noted")
        }
        if mine.keys() != theirs.keys():
            return {}
        for name, step in mine:
            if not alike(mine[name, step], theirs[name, step], tolerance):
                found.setdefault(part.name, {}).setdefault(name, {})[step] = mine[name, step]
    return found


def _parsed(did: str) -> Mapping[str, Any]:
    return {
        drawing: {
            name: {int(step): values for step, values in rows.items()} for name, rows in outputs.items()
        }
        for drawing, outputs in json.loads(did).items()
    }


def _visible(exercise_id: str) -> str:
    """Return everything of a lab that students read: its texts, and its code without the student's lines."""
    text = exercises.path(exercise_id).with_name(course.LAB).read_text(encoding="utf-8")
    before, *regions = text.split(BEGIN)
    return before + "".join(region.partition(END)[2] for region in regions)
