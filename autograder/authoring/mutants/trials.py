"""Runs the solution and its mutants on paper, in the drawings of the hand-out and in fresh ones."""

from __future__ import annotations

import json
import os
import resource
from collections import Counter
from dataclasses import dataclass, replace
from functools import partial
from random import Random
from typing import TYPE_CHECKING, Any, cast

import msgspec

from autograder.authoring.answer_bank import in_children
from autograder.judge import evidence_files
from autograder.judge.recording_differences import differences
from autograder.judge.reference_recording import SEED
from autograder.kit.evidence import Evidence, Part, Reference

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from autograder.kit.bench import Bench
    from autograder.kit.model import Exercise

FRESH = 20
"""The number of fresh drawings."""
CPU_LIMIT = 5
"""Seconds of processor time after which a program counts as one that never ends."""
LIMIT = 90.0
"""Seconds of wall time after which a program counts as one that waits for ever."""
TELLING = 4
"""The number of fresh drawings after which a program is not run any more if no drawing so far lets it pass."""
PLACES = 3
"""Digits behind the point of the numbers by which outputs are told apart."""


class NotOnPaper(Exception):
    """On paper, the solution is not what the judge has recorded. The message says in what it differs."""


@dataclass(frozen=True)
class Run:
    """What a program did in one drawing.

    Attributes:
        drawing: The name of the drawing.
        points: The points that the program earns.
        passed: True if it earns all.
        outputs: What was noted of it, as JSON in which equal outputs are equal texts; empty if it crashed, or if the
            judge ran it.
    """

    drawing: str
    points: float
    passed: bool
    outputs: str = ""


@dataclass(frozen=True)
class PaperTask:
    """An exercise whose solution does on paper what the judge has recorded.

    Attributes:
        exercise: The exercise.
        root: The name of the class or function that is judged.
        practice: The names of the recorded drawings, which hand-outs have.
        fresh: The names of other drawings.
        reference: What the solution does in all of them.
        parts: The record of the solution in the practice drawings, with all events.
    """

    exercise: Exercise
    root: str
    practice: tuple[str, ...]
    fresh: tuple[str, ...]
    reference: Reference
    parts: tuple[Part, ...]


def paper_task(
    exercise: Exercise,
    stored: Reference,
    text: str,
    root: str,
    *,
    fresh: int = FRESH,
    must_be_recorded: bool = True,
) -> PaperTask:
    """Run the solution on paper, and compare it with its recording.

    Args:
        exercise: The exercise.
        stored: The recording of the solution.
        text: The solution.
        root: The name of the class or function that is judged.
        fresh: The number of fresh drawings.
        must_be_recorded: False to take what the solution does on paper for its recording.

    Raises:
        NotOnPaper: The solution cannot be run on paper, or is not as recorded there.
    """
    practice = tuple(part.name for part in stored.parts) if exercise.is_drawn else (SEED,)
    names = tuple(f"fresh {number}" for number in range(fresh))
    _import_messages(stored)
    work = partial(_recorded, exercise, text, root, stored, (*practice, *names))
    ((_, outcome),) = in_children([("", work)], jobs=1, limit=LIMIT * 2)
    if outcome.data is None:
        raise NotOnPaper("the solution ended the process")
    recorded = msgspec.json.decode(outcome.data, type=_Recorded)
    if recorded.trouble:
        raise NotOnPaper(recorded.trouble)
    parts = tuple(recorded.parts)
    of_practice = parts[: len(practice)] if exercise.is_drawn else parts
    bare = replace(stored, parts=(), variants=())
    now, before = (
        evidence_files.as_recorded(replace(bare, parts=some), exercise.recorded)
        for some in (of_practice, stored.parts)
    )
    different = next(differences(before, now, exercise.tolerance), "")
    if different and must_be_recorded:
        raise NotOnPaper(different)
    reference = replace(bare, parts=parts if exercise.is_drawn else stored.parts)
    task = PaperTask(exercise, root, practice, names, reference, of_practice)
    ((_, runs),) = run_all(task, [("", text)], jobs=1)
    if lost := [run.drawing for run in runs if not run.passed]:
        raise NotOnPaper(f"the solution does not pass {lost[0]}")
    return task


def run_all(
    task: PaperTask, programs: Iterable[tuple[Any, str]], *, jobs: int = 0
) -> Iterator[tuple[Any, list[Run]]]:
    """Run programs on paper, each in a process of its own. Yield what each belongs to, and its runs.

    A program that crashes the process or does not end has no runs.

    Args:
        task: The exercise.
        programs: Whatever each program belongs to, and its text.
        jobs: The number of programs at the same time; 0 for as many as there are processors.
    """
    works = ((owner, partial(_runs, task, text)) for owner, text in programs)
    for owner, outcome in in_children(works, jobs=jobs or os.cpu_count() or 1, limit=LIMIT):
        yield owner, msgspec.json.decode(outcome.data, type=list[Run]) if outcome.data else []


def _import_messages(reference: Reference) -> None:
    """Import what every program needs, so that no fork has to."""
    from autograder.authoring.paper import bench
    from autograder.judge.bench.ros_interfaces import interface

    del bench
    for ends in reference.interface.values():
        for kind in ends.values():
            interface(kind)


def _alone() -> None:
    """Prepare this fork for one program, whose output is thrown away."""
    from autograder.authoring.paper.nodes import replace_rclpy

    resource.setrlimit(resource.RLIMIT_CPU, (CPU_LIMIT, CPU_LIMIT))
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    replace_rclpy()


def _played(
    exercise: Exercise, text: str, root: str, reference: Reference, names: Sequence[str]
) -> Iterator[tuple[str, list[Part]]]:
    """Run a program in drawings. Yield the name of each, and the record of its parts."""
    from autograder.authoring.paper.bench import PaperBench

    code = compile(text, "solution", "exec", dont_inherit=True)
    for name in names:
        # The only drawing that the scenario knows is the one that it gives; without drawings, it names its part itself.
        same = [part for part in reference.parts if part.name == name or not exercise.is_drawn]
        drawn = (name,) if exercise.is_drawn else ()
        paper = PaperBench(code, root, replace(reference, parts=same, drawings=drawn), Random(name))
        exercise.scenario(cast("Bench", paper))
        yield name, paper.parts


@dataclass(frozen=True)
class _Recorded:
    """The record of the solution on paper, or the reason why there is none."""

    parts: list[Part]
    trouble: str = ""


def _recorded(exercise: Exercise, text: str, root: str, stored: Reference, names: Sequence[str]) -> bytes:
    from autograder.authoring.paper.network import UnknownOnPaper

    _alone()
    played = _played(
        exercise, text, root, replace(stored, parts=()), names if exercise.is_drawn else names[:1]
    )
    try:
        found = _Recorded([part for _, parts in played for part in parts])
    except UnknownOnPaper as unknown:
        found = _Recorded([], f"paper has no {unknown}")
    return msgspec.json.encode(found)


def _runs(task: PaperTask, text: str) -> bytes:
    _alone()
    exercise, found = task.exercise, list[Run]()
    for name, parts in _played(exercise, text, task.root, task.reference, (*task.practice, *task.fresh)):
        if len(found) == len(task.practice) + TELLING and not any(run.passed for run in found):
            break
        evidence = Evidence(parts, task.reference)
        earned = sum(one.points for one in exercise.criteria if one.judge(evidence).passed)
        is_whole = all(part.of("noted") and not part.traceback for part in parts)
        found.append(Run(name, earned, earned == exercise.points, _outputs(parts) if is_whole else ""))
    return msgspec.json.encode(found)


def _outputs(parts: Sequence[Part]) -> str:
    noted = [
        [event.name, event.data.get("step", -1), rounded(event.data.get("values"), PLACES)]
        for part in parts
        for event in part.of("noted")
    ]
    # How many messages came tells periods apart, which a recording does not keep.
    counts = Counter(event.name for part in parts for event in part.of("message"))
    return json.dumps([noted, sorted(counts.items())], default=str)


def rounded(value: Any, places: int) -> Any:
    """Return a value of JSON with all its numbers rounded."""
    if isinstance(value, float):
        return round(value, places)
    if isinstance(value, dict):
        return {key: rounded(one, places) for key, one in value.items()}
    return [rounded(one, places) for one in value] if isinstance(value, (list, tuple)) else value
