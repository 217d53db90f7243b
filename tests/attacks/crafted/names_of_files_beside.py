# family = "crafted"
# tries = "Beside the notebook lie files with names that a terminal or a page reads, settings and modules of every tool that the grader uses, a pipe, a socket, and links to a device, to themselves and to the root."
# could_earn = "A grader that follows, imports, runs or shows them."

from __future__ import annotations

import os
import socket
from typing import TYPE_CHECKING, Any

import nbformat

if TYPE_CHECKING:
    from pathlib import Path

SHOWN = (
    "\x1b]0;attack_canary\x07.ipynb",
    "\u202eypni.2_1_bal",
    "<script>attack_canary()<\u2215script>.ipynb",
    "=cmd|x.ipynb",
    "a\nplaced b.ipynb",
    "LAB_1_2.ipynb ",
    os.fsdecode(b"\xff\xfe.ipynb"),
)
READ = (
    *(
        "nbgrader_config.py",
        "jupyter_nbconvert_config.py",
        "ipython_config.py",
        "conftest.py",
        "pyproject.toml",
    ),
    *("sitecustomize.py", "jinja2.py", "json.py", "custom.css", ".env", "DEFAULT_FASTDDS_PROFILES.xml"),
)


def hand_in(folder: Path, notebook: Any) -> None:
    nbformat.write(notebook, folder / "lab_1_2.ipynb")
    for name in SHOWN:
        (folder / name).write_text("{}")
    for name in READ:
        (folder / name).write_text("raise SystemExit('attack_canary')\n")
    (folder / "custom").mkdir()
    (folder / "custom" / "custom.css").write_text("</style><script>attack_canary()</script>")
    os.mkfifo(folder / "lab_1_2.html")
    (folder / "gradebook.db").symlink_to("/dev/zero")
    (folder / "ring").symlink_to("ring")
    (folder / "lab_1_2").symlink_to("/")
    with socket.socket(socket.AF_UNIX) as bound:
        place = os.open(folder, os.O_RDONLY)
        bound.bind(f"/proc/self/fd/{place}/s.ipynb")  # a socket's path is short
        os.close(place)
