"""Converts a graded submission: its notebooks with cards and points, and their entries for the gradebook.

``nbgrader autograde`` makes the same notebooks and entries.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import msgspec
from nbformat.v4 import rwbase
from nbgrader.preprocessors import LimitOutput
from nbgrader.utils import compute_checksum, determine_grade, is_grade, is_solution, is_task

from autograder.boxes.run_limits import Ended
from autograder.cards.html_rendering import card_bundle
from autograder.execution.executed_cells import Cell, CellCheck, CellRun, CellType, Execution
from autograder.grading.class_records import Attempt
from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.classes.gradebook_writing import NotebookEntry
from autograder.grading.grading_task import points, scores_of, unchecked
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.returning.sanitize import harmless_output, make_harmless
from autograder.grading.running import execution_backends
from autograder.grading.tasks.submission_times import companions, handed_in_at
from autograder.grading.tasks.task_making import LEFT_OUT

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from nbformat import NotebookNode

    from autograder.boxes.run_limits import Limits
    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.grading_task import Task
    from autograder.grading.table.rows import Row
    from autograder.grading.tasks.submission_work import Result
    from autograder.verdict import Verdict


@dataclass(frozen=True)
class Converted:
    """A graded submission, ready to be written.

    Attributes:
        files: The files for ``autograded/``, by their path in the submission's folder.
        entries: The entries for the gradebook, by notebook.
        handed_in: The submission time in UTC; None if it is unknown.
        attempt: The record for the class's store.
        is_final: False if the grader itself failed, so that the next run grades the submission again.
    """

    submission: Submission
    files: Mapping[str, bytes]
    entries: Mapping[str, NotebookEntry]
    handed_in: datetime | None
    attempt: Attempt
    is_final: bool


def convert(directory: ClassDirectory, results: Sequence[Result], rows: tuple[Row, ...]) -> Converted:
    """Convert a submission. The rebuilt notebooks of its results are changed.

    Args:
        results: The results of all its notebooks.
        rows: The results as rows of the report.

    Raises:
        ValueError: The submission time is not a time, or is impossible.
    """
    work, course = results[0].work, results[0].task.course
    files = directory.files(work.assignment) | companions(work.folder)
    entries, tasks, scores = {}, {}, {}
    for result in results:
        task, execution = result.task, result.execution
        notebook = _with_results(result.rebuilt, task, execution)
        # Before the entry is made, because nbgrader, too, cuts outputs before it computes points from them.
        LimitOutput(config=directory.config).preprocess(notebook, {})
        entries[task.notebook] = replace(_notebook_entry(notebook), unchecked=unchecked(task, execution))
        files[f"{task.notebook}{SUFFIX}"] = _notebook_text(notebook)
        tasks[task.notebook] = task.key()
        scores[task.notebook] = scores_of(task, execution)
    attempt = Attempt(
        datetime.now(tz=UTC), work.assignment, work.made_from, course, rows, tasks=tasks, scores=scores
    )
    is_final = not any(result.execution.trouble for result in results)
    return Converted(work, files, entries, handed_in_at(work.folder), attempt, is_final)


def _notebook_text(notebook: NotebookNode) -> bytes:
    """Return the JSON text of a notebook, equal to nbformat's but made faster. The argument is changed."""
    split: Any = rwbase.split_lines
    strip: Any = rwbase.strip_transient
    encoded = msgspec.json.encode(strip(split(notebook)), order="sorted")
    return msgspec.json.format(encoded, indent=1) + b"\n"


def _notebook_entry(notebook: NotebookNode) -> NotebookEntry:
    """Return the gradebook entry for a notebook, equal to the one that nbgrader's SaveAutoGrades would make."""
    scores: dict[str, float | None] = {}
    comments: dict[str, str | None] = {}
    for cell in notebook.cells:
        if is_grade(cell):
            scores[cell.metadata.nbgrader.grade_id] = determine_grade(cell)[0]
        if is_solution(cell) or is_task(cell):
            untouched = cell.metadata.nbgrader.get("checksum") == compute_checksum(cell)
            no_answer = untouched and not is_task(cell)
            comments[cell.metadata.nbgrader.grade_id] = "No response." if no_answer else None
    return NotebookEntry(scores, comments)


def _with_results(nb: NotebookNode, task: Task, execution: Execution) -> NotebookNode:
    """Return a rebuilt notebook with the outputs of its cells, which for a check cell are the card and the points."""
    count = 0
    for index, (node, cell) in enumerate(zip(nb.cells, task.cells, strict=True)):
        if node.cell_type != "code":
            continue
        run = execution.cells[index] if index < len(execution.cells) else CellRun(Ended.NOT_RUN)
        if run.ended is not Ended.NOT_RUN:
            count += 1
            node.execution_count = count
        if cell.check is not None:
            node.outputs = _graded_outputs(cell.check, execution.verdicts[index], run.outputs)
        else:
            node.outputs = [nbformat_nodes.output(**output) for output in run.outputs]
            node.outputs += _remark(node, cell, run, task.limits) if execution.cells else []
    # Scripts in outputs are removed here, because nbgrader's formgrader shows notebooks of `autograded/` unchanged.
    make_harmless(nb, {index for index, cell in enumerate(task.cells) if cell.own})
    nb.cells = list(_with_rubrics(nb.cells))
    if not task.boxed:
        nb.cells.insert(0, nbformat_nodes.cell(CellType.MARKDOWN, f"**{execution_backends.UNBOXED_NOTE}**"))
    return nb


def _with_rubrics(cells: Sequence[NotebookNode]) -> Iterator[NotebookNode]:
    """Yield the cells. Below each answer that a person grades, add a cell with the instructor's notes for grading."""
    for cell in cells:
        notes = cell.metadata.pop("autograder", {})
        yield cell
        if notes.get("rubric"):
            text = f"**How this answer is graded**\n\n{notes['rubric']}"
            rubric_cell = nbformat_nodes.cell(CellType.MARKDOWN, text, f"rubric-{cell.id}"[:64])
            if notes["pictures"]:
                rubric_cell["attachments"] = notes["pictures"]
            yield rubric_cell


def _graded_outputs(
    check: CellCheck, verdict: Verdict, outputs: Sequence[Mapping[str, Any]]
) -> list[NotebookNode]:
    """Return the outputs of a graded cell: the card, the output of its tests, and last the points, for nbgrader."""
    score = points(check, verdict)
    card = nbformat_nodes.output(output_type="display_data", data=card_bundle(verdict), metadata={})
    return [
        *([card, *_of_tests(outputs)] if check.asserts else [card]),
        nbformat_nodes.output(
            output_type="execute_result",
            data={"text/plain": f"{score:.17g}"},
            metadata={},
            execution_count=None,
        ),
    ]


def _of_tests(outputs: Sequence[Mapping[str, Any]]) -> Iterator[NotebookNode]:
    """Yield the output and errors of a cell's tests as plain printed text, so that nbgrader ignores them.

    Otherwise, nbgrader would give zero points for an error, and take the cell's first value as the points.
    """
    for one in outputs:
        if one["output_type"] == "error":
            yield harmless_output(_printed("\n".join(one["traceback"]) or f"{one['ename']}: {one['evalue']}"))
        elif one["output_type"] == "stream":
            yield harmless_output(_printed(one["text"]))
        elif one["output_type"] == "display_data":
            yield harmless_output(nbformat_nodes.output(**one))


def _printed(text: str) -> NotebookNode:
    return nbformat_nodes.output(output_type="stream", name="stdout", text=text)


def _remark(node: NotebookNode, cell: Cell, run: CellRun, limits: Limits) -> list[NotebookNode]:
    words = {
        Ended.TIMED_OUT: f"[stopped: the cell had not ended after {run.seconds:.0f} s]",
        Ended.KERNEL_DIED: "[the kernel ended in this cell]",
        Ended.OUT_OF_MEMORY: f"[stopped: more than {limits.memory_bytes / 1e9:g} GB of memory]",
        Ended.OUT_OF_CPU: f"[stopped: more than {limits.cpu_seconds:g} s of processor time]",
        Ended.TOO_MANY_PROCESSES: f"[stopped: more than {limits.processes} processes and threads]",
        Ended.TOO_MUCH_OUTPUT: f"[stopped: more than {limits.flood_bytes / 1e6:g} MB of output]",
        Ended.NOT_RUN: "[this cell was not run]",
    }
    text = words.get(run.ended) if cell.source.strip() else LEFT_OUT if node.source.strip() else None
    return [_printed(f"{text}\n")] if text else []
