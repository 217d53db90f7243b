# family = "shadowing"
# tries = "Beside the notebook lie modules named rclpy, autograder, std_msgs and ipykernel, a sitecustomize and a folder __pycache__ with false byte code."
# could_earn = "Code in the kernel before the notebook, or in the grader's own processes."

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

FALSE = "import os\nopen('/tmp/attack_canary_shadow', 'w').close()\ndef check(*_): return 10.0\n"


def hand_in(folder: Path, notebook: Any) -> None:
    for name in (
        "rclpy",
        "autograder",
        "std_msgs",
        "ipykernel",
        "ipykernel_launcher",
        "zmq",
        "sitecustomize",
        "msgspec",
    ):
        (folder / f"{name}.py").write_text(FALSE)
    (folder / "std_msgs").mkdir()
    (folder / "std_msgs" / "__init__.py").write_text(FALSE)
    (folder / ".ipython/profile_default/startup").mkdir(parents=True)
    (folder / ".ipython/profile_default/startup/00.py").write_text(FALSE)
    (folder / "attack_canary.pth").write_text("import os")
    (folder / "nbgrader_config.py").write_text(FALSE)
    notebook.cells.append(
        nbformat.v4.new_code_cell("import os\nprint('LEAK:' if os.path.exists('rclpy.py') else '')")
    )
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
