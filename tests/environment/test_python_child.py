"""The start of a Python process of the project: what it imports from, and what it inherits."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

from course_runtime.python_child import clean_environment, installed_program, python_child

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_it_imports_nothing_from_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("msgspec.py", "types.py"):
        (tmp_path / name).write_text("print('hostile')\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", f":{os.environ.get('PYTHONPATH', '')}")
    child = python_child("-c", "import msgspec, os, types; print(os.getcwd())")
    assert child.start(stdout=subprocess.PIPE).communicate()[0] == b"/\n"
    beside = python_child("-c", "import msgspec, os, types; print(os.getcwd())", folder=None)
    assert beside.start(stdout=subprocess.PIPE).communicate()[0] == f"{tmp_path}\n".encode()


def test_search_paths_keep_what_is_sourced_and_lose_what_depends_on_the_current_folder() -> None:
    sourced = "/opt/ros/jazzy/lib/python3.12/site-packages"
    given = {
        "PYTHONPATH": f":{sourced}:.:tools",
        "LD_LIBRARY_PATH": ":",
        "PATH": "bin:/usr/bin:",
        "ROS_DISTRO": "jazzy",
    }
    assert clean_environment(given) == {"PYTHONPATH": sourced, "PATH": "/usr/bin", "ROS_DISTRO": "jazzy"}


def test_of_pythons_variables_only_those_about_reading_and_writing_are_kept() -> None:
    given = dict.fromkeys(("PYTHONHOME", "PYTHONSTARTUP", "PYTHONSAFEPATH", "PYTHONPYCACHEPREFIX"), "here")
    assert clean_environment({**given, "PYTHONUTF8": "1"}) == {"PYTHONUTF8": "1"}


def test_a_program_of_this_environment_is_found_beside_its_python() -> None:
    assert installed_program("python3").samefile(sys.executable)
