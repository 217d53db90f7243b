"""What stands in the place of nbgrader's Execute: the wire decides, whoever pressed the button.

``nbgrader_config.py`` of a class puts :class:`WireExecute` into ``Autograde.autograde_preprocessors``. Plain
``nbgrader autograde``, formgrader's button and ``autograder grade`` all come through here.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nbgrader.preprocessors import NbGraderPreprocessor
from traitlets import Bool, Float, Integer

from autograder.boxes.execution import Cell, CellRun, Check, Ended, Execution, Kind
from autograder.boxes.limits import Limits
from autograder.cards.bundle import mimebundle
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.entering.journal import Journal
from autograder.grading.entering.points import points
from autograder.grading.exporter import SubmissionExporter
from autograder.grading.rebuilding import nodes
from autograder.grading.rebuilding.demonstrations import LEFT_OUT
from autograder.grading.rebuilding.task_making import task_of
from autograder.grading.returning.sanitize import harmless_output, make_harmless
from autograder.grading.running import engine, sandboxing

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from nbformat import NotebookNode

    from autograder.grading.task import Task
    from autograder.verdict import Verdict


class WireExecute(NbGraderPreprocessor):
    """Executes a rebuilt notebook under the eyes of the judge and writes only the judge's points into it."""

    cell_seconds = Float(Limits.cell_seconds, help="Wall time of one cell, in seconds.").tag(config=True)
    notebook_seconds = Float(Limits.notebook_seconds, help="Wall time of a notebook, in seconds.").tag(
        config=True
    )
    cpu_seconds = Float(Limits.cpu_seconds, help="Processor time of a notebook, in seconds.").tag(config=True)
    memory_bytes = Integer(Limits.memory_bytes, help="Memory of a notebook with all its processes.").tag(
        config=True
    )
    processes = Integer(Limits.processes, help="Processes and threads of a notebook.").tag(config=True)
    scratch_bytes = Integer(Limits.scratch_bytes, help="What a notebook's files may have together.").tag(
        config=True
    )
    unsafe_no_sandbox = Bool(
        False,
        help="Run submissions with all rights of whoever grades, without a sandbox. Anything can then be changed, "
        "grades included; reports and feedback say that it was so.",
    ).tag(config=True)

    demonstrations = Bool(
        False, help="Also run the given cells that only show something, which no grade depends on."
    ).tag(config=True)

    def preprocess(self, nb: NotebookNode, resources: dict[str, Any]) -> tuple[NotebookNode, dict[str, Any]]:
        """Put outputs and scores into the notebook.

        Args:
            nb: The rebuilt notebook.
            resources: nbgrader's names of student, assignment and notebook are in it.
        """
        if not isinstance(self.parent, SubmissionExporter):
            # Else what a student wrote into the notebook's metadata would be taken for ours.
            raise TypeError("Autograde.exporter_class must be autograder.grading.exporter.SubmissionExporter")
        converter: Any = self.parent.parent
        names = resources["nbgrader"]
        directory = ClassDirectory(Path(converter.coursedir.root))
        problem = nb.metadata.get("autograder", {}).get("problem", "")
        task = task_of(directory, names["student"], names["assignment"], names["notebook"], nb, problem)
        finished = getattr(converter, "finished", {})
        execution = finished.get(task.key()) or self._execute(directory, task)
        return with_results(nb, task, execution), resources

    def _execute(self, directory: ClassDirectory, task: Task) -> Execution:
        if task.problem:
            return task.without_execution()
        journal = Journal(directory.state / "journal")
        known = journal.get(task)
        if known is not None:
            self.log.info("%s is unchanged; taking the result that is in the journal", task.label)
            return known
        sandboxing.require(directory)
        execution = engine.execute_one(task, directory.scratch())
        journal.put(task, execution)
        return execution


def with_results(nb: NotebookNode, task: Task, execution: Execution) -> NotebookNode:
    """The notebook with the outputs of its cells; of a check cell they are the card and the points."""
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
            node.outputs = [nodes.output(**output) for output in run.outputs]
            node.outputs += _remark(node, cell, run.ended, task.limits) if execution.cells else []
    # Here and not on the page: formgrader shows what lies in autograded/, and it cleans nothing.
    make_harmless(nb, range(len(nb.cells)) if execution.trouble else execution.as_typed)
    nb.cells = list(_with_rubrics(nb.cells))
    if not task.boxed:
        nb.cells.insert(0, nodes.cell(Kind.MARKDOWN, f"**{sandboxing.NOTE}**"))
    return nb


def _with_rubrics(cells: Sequence[NotebookNode]) -> Iterator[NotebookNode]:
    """The cells, and below each question that a person grades what the instructor wrote for that person."""
    for cell in cells:
        rubric = cell.metadata.pop("autograder", {}).get("rubric", "")
        yield cell
        if rubric:
            text = f"**How this answer is graded**\n\n{rubric}"
            yield nodes.cell(Kind.MARKDOWN, text, f"rubric-{cell.id}"[:64])


def _graded_outputs(
    check: Check, verdict: Verdict, outputs: Sequence[Mapping[str, Any]]
) -> list[NotebookNode]:
    """The card, or what tests said, and as the cell's value the score: nbgrader gives a cell that number of points."""
    score = points(check, verdict)
    card = nodes.output(output_type="display_data", data=mimebundle(verdict), metadata={})
    return [
        *([card, *_of_tests(outputs)] if check.asserts else [card]),
        nodes.output(
            output_type="execute_result", data={"text/plain": f"{score:g}"}, metadata={}, execution_count=None
        ),
    ]


def _of_tests(outputs: Sequence[Mapping[str, Any]]) -> Iterator[NotebookNode]:
    """What tests printed or raised, in a form by which nbgrader decides nothing.

    It takes an error and a line on standard error for zero points, and the first value for the points.
    """
    for one in outputs:
        if one["output_type"] == "error":
            text = "\n".join(one["traceback"]) or f"{one['ename']}: {one['evalue']}"
            yield harmless_output(nodes.output(output_type="stream", name="stdout", text=text))
        elif one["output_type"] == "stream":
            yield harmless_output(nodes.output(output_type="stream", name="stdout", text=one["text"]))
        elif one["output_type"] == "display_data":
            yield harmless_output(nodes.output(**one))


def _remark(node: NotebookNode, cell: Cell, ended: Ended, limits: Limits) -> list[NotebookNode]:
    words = {
        Ended.TIMED_OUT: f"[stopped: the cell ran for more than {limits.cell_seconds:g} s]",
        Ended.KERNEL_DIED: "[the kernel ended in this cell]",
        Ended.OUT_OF_MEMORY: f"[stopped: more than {limits.memory_bytes / 1e9:g} GB of memory]",
        Ended.OUT_OF_CPU: f"[stopped: more than {limits.cpu_seconds:g} s of processor time]",
        Ended.TOO_MANY_PROCESSES: f"[stopped: more than {limits.processes} processes and threads]",
        Ended.TOO_MUCH_OUTPUT: f"[stopped: more than {limits.flood_bytes / 1e6:g} MB of output]",
        Ended.NOT_RUN: "[this cell was not run]",
    }
    text = words.get(ended) if cell.source.strip() else LEFT_OUT if node.source.strip() else None
    return [nodes.output(output_type="stream", name="stdout", text=f"{text}\n")] if text else []
