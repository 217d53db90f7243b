"""Executes the masters as a student would in JupyterLab, and returns them with their outputs."""

from __future__ import annotations

import os
import queue
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionComplete
from nbclient.util import ensure_async
from nbconvert.preprocessors import CoalesceStreamsPreprocessor

from autograder import check_journal, course
from autograder.dds_discovery import DOMAIN_VARIABLE, claim_free_domain
from autograder.masters.master_files import lab_name
from autograder.masters.source_notebooks import source_notebook
from autograder.safe_files import HeldFolder

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nbformat import NotebookNode


CELL_LIMIT = 600
"""Time limit in seconds for one cell. The slowest cells build a workspace."""
NOTEBOOKS_AT_ONCE = 3
"""The maximum number of notebooks that run at the same time."""


def run_masters(masters: Sequence[Path], root: Path, tell: Callable[[str], None]) -> dict[str, NotebookNode]:
    """Execute masters, each in a new kernel with its own folder and ROS domain, and return them with outputs.

    Args:
        masters: The files of the masters.
        root: The top folder of the course whose exercises the kernels and judges use.
        tell: Called with a line about each notebook that is done.

    Returns:
        The executed source notebooks, by the names of the labs.

    Raises:
        nbclient.exceptions.CellExecutionError: A cell raised an error.
    """

    def run(master: Path) -> tuple[str, NotebookNode]:
        done = _run(source_notebook(master), root)
        tell(f"executed   {lab_name(master)}")
        return lab_name(master), done

    with ThreadPoolExecutor(NOTEBOOKS_AT_ONCE) as pool:
        return dict(pool.map(run, masters))


def execute_in_new_kernel(client: NotebookClient, folder: Path, lines: Path, **variables: str) -> None:
    """Execute a client's notebook as JupyterLab would: in a new kernel, with rclpy's log lines in the outputs.

    Args:
        client: nbclient's client of the notebook. This function sets its time limit and its kernel.
        folder: The working folder of the kernel.
        lines: The path of the journal, the file in which a student's checks are recorded.
        variables: More environment variables for the kernel.

    Raises:
        nbclient.exceptions.CellExecutionError: A cell raised an error.
        nbclient.exceptions.CellTimeoutError: A cell took longer than ``CELL_LIMIT``.
        nbclient.exceptions.DeadKernelError: The kernel ended.
    """
    client.timeout, client.kernel_name = CELL_LIMIT, "python3"
    client.resources = {"metadata": {"path": str(folder)}}
    environment = {**os.environ, **variables, check_journal.VARIABLE: str(lines)}
    # Remove this variable, because with it ipykernel does not show rclpy's log lines in the cells.
    environment.pop("PYTEST_CURRENT_TEST", None)
    # rclpy also writes the log lines to the kernel's standard output and error. Drop this copy, which no reader sees.
    client.execute(env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def _run(notebook: NotebookNode, root: Path) -> NotebookNode:
    with HeldFolder("course-site-") as held:
        folder = held.path / "notebooks"
        folder.mkdir()
        client = _UntilTheEnd(notebook)
        claim = claim_free_domain()
        variables = {DOMAIN_VARIABLE: str(claim.domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        variables[course.VARIABLE] = str(root)
        variables["GIT_CONFIG_GLOBAL"] = (
            os.devnull
        )  # otherwise `ros2 pkg create` would write the builder's email address into a package
        try:
            execute_in_new_kernel(client, folder, held.path / "journal.jsonl", **variables)
        finally:
            claim.release()
        show_as_a_students(notebook, str(folder))
    return notebook


STILL = 3.0
"""Seconds without a new frame after which a live picture counts as still, unless it says that the robot moves."""
_MOVES = "It moves at"
LONGEST_MOVE = 40.0
"""The maximum time in seconds to wait for a live picture: twice as long as the robot needs through both rooms."""


class _UntilTheEnd(NotebookClient):
    """A client that shows what became of a live picture: it waits until the robot stands, and while later cells run."""

    async def async_execute_cell(
        self,
        cell: NotebookNode,
        cell_index: int,
        execution_count: int | None = None,
        store_history: bool = True,
    ) -> NotebookNode:
        """Execute a cell. If it shows a live picture, wait until no new frame arrives."""
        done = await super().async_execute_cell(cell, cell_index, execution_count, store_history)
        if any(cell_index in cells for cells in self._display_id_map.values()):
            await self._until_still(cell, cell_index)
        return done

    async def _until_still(self, cell: NotebookNode, cell_index: int) -> None:
        assert self.kc is not None
        give_up_at = time.monotonic() + LONGEST_MOVE
        while time.monotonic() < give_up_at:
            try:
                msg = await ensure_async(self.kc.iopub_channel.get_msg(timeout=STILL))
            except queue.Empty:
                # On a busy machine, frames come late.
                if not any(_MOVES in output.get("data", {}).get("text/html", "") for output in cell.outputs):
                    return
                continue
            if msg["msg_type"] == "update_display_data":
                self.process_message(msg, cell, cell_index)

    async def _async_poll_output_msg(self, parent_msg_id: str, cell: NotebookNode, cell_index: int) -> None:
        """Process a cell's messages, and new frames of live pictures in earlier cells, which nbclient would ignore."""
        assert self.kc is not None
        while True:
            msg = await ensure_async(self.kc.iopub_channel.get_msg(timeout=None))
            if (
                msg["msg_type"] == "update_display_data"
                or msg["parent_header"].get("msg_id") == parent_msg_id
            ):
                try:
                    self.process_message(msg, cell, cell_index)
                except CellExecutionComplete:
                    return


def show_as_a_students(notebook: NotebookNode, folder: str) -> None:
    """Make a cell's outputs the same in every run: join printed pieces, and replace the temporary folder's path.

    Args:
        notebook: An executed notebook.
        folder: The folder in which the notebook was executed.
    """
    CoalesceStreamsPreprocessor().preprocess(notebook, {})
    for cell in notebook.cells:
        for output in cell.get("outputs", ()):
            for holder in (output, output.get("data", {})):
                for key, text in holder.items():
                    if isinstance(text, str):
                        shown = text.replace(folder, "/home/you/course")
                        holder[key] = shown.replace(str(Path(folder).parent), "/home/you")
