"""The student's server gives a notebook the kernel's version, so that JupyterLab finds nothing to save in it."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from ipykernel.ipkernel import IPythonKernel

from autograder.student.lab_server import OpenedNotebooks

RELEASED = Path(__file__).resolve().parents[2] / "chapters/01_ros2_fundamentals/lab_1_2.ipynb"


def opened(folder: Path, name: str, **options: Any) -> dict[str, Any]:
    return asyncio.run(OpenedNotebooks(root_dir=str(folder)).get(name, **options))


def test_an_opened_notebook_says_of_its_language_what_the_kernel_says(tmp_path: Path) -> None:
    copy = Path(shutil.copy(RELEASED, tmp_path))
    assert opened(tmp_path, copy.name)["content"]["metadata"]["language_info"] == IPythonKernel.language_info
    assert copy.read_bytes() == RELEASED.read_bytes()


ELSEWHERE = {"name": "python", "version": "3.8.1"}


@pytest.mark.parametrize("said", [ELSEWHERE, "python", ["python"], 3, None, {"name": ["python"]}, {}])
def test_of_its_language_another_version_is_replaced_and_damage_is_left_to_jupyterlab(
    tmp_path: Path, said: object
) -> None:
    notebook = json.loads(RELEASED.read_text())
    notebook["metadata"]["language_info"] = said
    (tmp_path / "odd.ipynb").write_text(json.dumps(notebook))
    here = {**ELSEWHERE, "version": IPythonKernel.language_info["version"]}
    expected = here if said == ELSEWHERE else said
    assert opened(tmp_path, "odd.ipynb")["content"]["metadata"]["language_info"] == expected


def test_what_is_no_notebook_of_python_stays_as_it_is(tmp_path: Path) -> None:
    notebook = json.loads(RELEASED.read_text())
    notebook["metadata"] = {"language_info": {"name": "julia"}}
    (tmp_path / "other.ipynb").write_text(json.dumps(notebook))
    notebook["metadata"] = {}
    (tmp_path / "bare.ipynb").write_text(json.dumps(notebook))
    (tmp_path / "notes.txt").write_text("mine")
    assert opened(tmp_path, "other.ipynb")["content"]["metadata"]["language_info"] == {"name": "julia"}
    assert opened(tmp_path, "bare.ipynb")["content"]["metadata"] == {}
    assert opened(tmp_path, "notes.txt")["content"] == "mine"
    assert opened(tmp_path, "bare.ipynb", content=False)["content"] is None
    assert opened(tmp_path, "")["type"] == "directory"


@pytest.mark.slow
def test_the_address_stands_last_and_alone(tmp_path: Path) -> None:
    (tmp_path / "chapters").mkdir()
    command = [sys.executable, "-m", "autograder", "lab", "--folder", "chapters", "--no-browser"]
    command += ["--allow-root", "--ServerApp.port=0", "--ServerApp.port_retries=0"]
    environment = {**os.environ, **dict.fromkeys(("HOME", "JUPYTER_RUNTIME_DIR"), str(tmp_path))}
    with subprocess.Popen(
        command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True
    ) as server:
        assert server.stderr is not None
        said = []
        for line in server.stderr:
            said.append(line)
            if line.startswith("http://"):
                break
        # Jupyter sometimes hangs if SIGTERM comes while its extensions still start.
        server.kill()
    assert said[-1].startswith("http://127.0.0.1:")
    assert said[-2] == "\n"
    assert "open this address" in said[-3]
    assert [line for line in said if "http" in line] == [said[-1]]
