# family = "forging"
# tries = "The notebook names a kernel of its own, whose command is the attacker's, brings its kernel.json along and names a language that Python is not."
# could_earn = "Code outside of the box, or a kernel that answers as it likes."

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path


def hand_in(folder: Path, notebook: Any) -> None:
    command = ["/bin/sh", "-c", "touch /tmp/attack_canary_kernel", "{connection_file}"]
    for place in (folder, folder / "kernels" / "evil", folder / ".local/share/jupyter/kernels/evil"):
        place.mkdir(parents=True, exist_ok=True)
        spec = {"argv": command, "display_name": "evil", "language": "python"}
        (place / "kernel.json").write_text(json.dumps(spec))
    notebook.metadata["kernelspec"] = {"name": "evil", "display_name": "evil", "language": "bash"}
    notebook.metadata["language_info"] = {"name": "bash", "file_extension": "/../../evil"}
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
