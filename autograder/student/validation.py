"""Runs nbgrader's *Validate* in a process of its own, which tells how far it is.

nbgrader validates a notebook inside of Jupyter's server, which answers nothing else until the last cell has run. So
``./course lab`` starts ``python -m autograder.student.validation FOLDER NOTEBOOK`` instead. Each line that the process
prints is a JSON object: first the progress, and at the end nbgrader's answer.
"""

from __future__ import annotations

import json
import logging
import sys
from pathlib import Path
from typing import Any

from nbgrader.apps import NbGrader
from nbgrader.server_extensions.validate_assignment.handlers import ValidateAssignmentHandler

from autograder.process_trees import die_with_parent
from autograder.standard_output import private_stdout
from autograder.student.known_classes import is_known


def validate(folder: str, notebook: str) -> None:
    """Validate a notebook as nbgrader does, and print the progress and the answer.

    Args:
        folder: The folder that JupyterLab shows.
        notebook: The path of the notebook in this folder.
    """
    # The notebook's code may print. What it prints must not get into the stream of our answers.
    answers = private_stdout()

    def tell(**said: Any) -> None:
        answers.write(f"{json.dumps(said)}\n".encode())
        answers.flush()

    def reach(cell_index: int, **_: Any) -> None:
        tell(at=cell_index + 1)

    class Handler(ValidateAssignmentHandler):
        """nbgrader's own handler, without a request."""

        root_dir, log = folder, logging.getLogger("validate")

        def __init__(self) -> None:
            pass

        def load_config(self) -> Any:
            config = super().load_config()
            config.Execute.on_cell_start = reach
            return config

    tell(answer=Handler().validate_notebook(notebook))


if __name__ == "__main__":
    die_with_parent()
    NbGrader.load_cwd_config = is_known(Path.cwd())
    validate(*sys.argv[1:])
