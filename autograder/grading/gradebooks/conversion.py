"""Converts a graded submission: writes its notebooks to ``autograded/``, and makes its entry for the gradebook.

The files and entries are the same as those of ``nbgrader autograde``. But this module takes a twentieth of the time,
because nbgrader reads, validates and writes every notebook twice, and opens the gradebook a dozen times.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import msgspec
from nbformat.v4 import rwbase
from nbgrader.preprocessors import LimitOutput
from nbgrader.utils import compute_checksum, determine_grade, is_grade, is_solution, is_task

from autograder.boxes.limits import Ended
from autograder.cards.bundle import mimebundle
from autograder.execution.cells import Cell, CellCheck, CellRun, CellType, Execution
from autograder.grading.classes.class_directory import SUFFIX
from autograder.grading.classes.timestamps import companions
from autograder.grading.gradebooks.gradebook import NotebookEntry
from autograder.grading.rebuilding import nbformat_nodes
from autograder.grading.rebuilding.demonstrations import LEFT_OUT
from autograder.grading.rebuilding.task_making import task_of
from autograder.grading.returning.sanitize import harmless_output, make_harmless
from autograder.grading.running import sandboxing
from autograder.grading.task import points, unchecked
from autograder.regular_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from nbformat import NotebookNode

    from autograder.boxes.limits import Limits
    from autograder.grading.classes.class_directory import ClassDirectory, Submission
    from autograder.grading.task import Task
    from autograder.verdict import Verdict

_READ_ONLY = 0o444


def convert(
    directory: ClassDirectory,
    submission: Submission,
    results: Sequence[tuple[Task, Execution]],
    folder: Path,
) -> dict[str, NotebookEntry]:
    """Write the notebooks of a submission with their results, and return the entries for the gradebook.

    Args:
        directory: The class.
        submission: The submission that was executed.
        results: Pairs of a task and its result, one for each notebook of the assignment.
        folder: The folder to create for the notebooks. It must not exist yet.

    Returns:
        The entries by notebook.

    Raises:
        RuntimeError: A notebook in ``submitted`` changed while it was executed.
        OSError: A file could not be written.
    """
    folder.mkdir(parents=True)
    for name, data in directory.files(submission.assignment).items():
        _write(folder / name, data)
    write_companions(submission, folder)
    entries = {}
    for task, execution in results:
        notebook = _graded(directory, submission, task, execution)
        LimitOutput(config=directory.config).preprocess(notebook, {})
        entries[task.notebook] = replace(_entry(notebook), unchecked=unchecked(task, execution))
        _write(folder / f"{task.notebook}{SUFFIX}", _text(notebook))
    return entries


def write_companions(submission: Submission, folder: Path) -> None:
    """Copy the files that nbgrader keeps about a submission (its timestamp and its secret) into a folder.

    Raises:
        OSError: A file could not be written.
    """
    for name, data in companions(submission.folder).items():
        _write(folder / name, data)


def _graded(
    directory: ClassDirectory, submission: Submission, task: Task, execution: Execution
) -> NotebookNode:
    now, rebuilt = task_of(directory, submission, task.notebook)
    if now.key() != task.key():
        raise RuntimeError(
            f"{task.label} was changed while it was graded: grade it again to use the new file"
        )
    return _with_results(rebuilt, task, execution)


def _text(notebook: NotebookNode) -> bytes:
    """Return the JSON text of a notebook, equal to nbformat's but made faster. The argument is changed."""
    split: Any = rwbase.split_lines
    strip: Any = rwbase.strip_transient
    encoded = msgspec.json.encode(strip(split(notebook)), order="sorted")
    return msgspec.json.format(encoded, indent=1) + b"\n"


def _entry(notebook: NotebookNode) -> NotebookEntry:
    """Return the gradebook entry for a notebook, equal to the one that nbgrader's SaveAutoGrades would make."""
    scores: dict[str, float | None] = {}
    comments: dict[str, str | None] = {}
    for cell in notebook.cells:
        if is_grade(cell):
            scores[cell.metadata.nbgrader.grade_id] = determine_grade(cell)[0]
        if is_solution(cell) or is_task(cell):
            comments[cell.metadata.nbgrader.grade_id] = _comment(cell)
    return NotebookEntry(scores, comments)


def _comment(cell: Any) -> str | None:
    untouched = cell.metadata.nbgrader.get("checksum") == compute_checksum(cell)
    return "No response." if untouched and not is_task(cell) else None


def _write(path: Path, data: bytes) -> None:
    write_whole(path, data)
    path.chmod(_READ_ONLY)


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
    make_harmless(nb, range(len(nb.cells)) if execution.trouble else execution.as_typed)
    nb.cells = list(_with_rubrics(nb.cells))
    if not task.boxed:
        nb.cells.insert(0, nbformat_nodes.cell(CellType.MARKDOWN, f"**{sandboxing.NOTE}**"))
    return nb


def _with_rubrics(cells: Sequence[NotebookNode]) -> Iterator[NotebookNode]:
    """Yield the cells. Below each answer that a person grades, add a cell with the instructor's notes for grading."""
    for cell in cells:
        known = cell.metadata.pop("autograder", {})
        yield cell
        if known.get("rubric"):
            text = f"**How this answer is graded**\n\n{known['rubric']}"
            made = nbformat_nodes.cell(CellType.MARKDOWN, text, f"rubric-{cell.id}"[:64])
            if known["pictures"]:
                made["attachments"] = known["pictures"]
            yield made


def _graded_outputs(
    check: CellCheck, verdict: Verdict, outputs: Sequence[Mapping[str, Any]]
) -> list[NotebookNode]:
    """Return the outputs of a graded cell: the card, the output of its tests, and last the points, for nbgrader."""
    score = points(check, verdict)
    card = nbformat_nodes.output(output_type="display_data", data=mimebundle(verdict), metadata={})
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
            text = "\n".join(one["traceback"]) or f"{one['ename']}: {one['evalue']}"
            yield harmless_output(nbformat_nodes.output(output_type="stream", name="stdout", text=text))
        elif one["output_type"] == "stream":
            yield harmless_output(
                nbformat_nodes.output(output_type="stream", name="stdout", text=one["text"])
            )
        elif one["output_type"] == "display_data":
            yield harmless_output(nbformat_nodes.output(**one))


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
    return [nbformat_nodes.output(output_type="stream", name="stdout", text=f"{text}\n")] if text else []
