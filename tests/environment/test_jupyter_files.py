"""JupyterLab's settings from the environment, as Jupyter's own programs read them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from jupyter_client.kernelspec import KernelSpecManager
from jupyter_server.serverapp import ServerApp
from jupyterlab_server.settings_utils import get_settings

from course_runtime.jupyter_files import (
    KERNEL_NAME,
    KERNEL_VARIABLES,
    lab_settings,
    server_config,
    write_jupyter_files,
)

NEWS = "@jupyterlab/apputils-extension:notification"


def test_the_kernel_of_the_course_is_this_python_with_the_variables_of_a_graded_cell() -> None:
    spec = KernelSpecManager().get_kernel_spec(KERNEL_NAME)
    assert spec.argv[0] == f"{sys.prefix}/bin/python"
    assert KERNEL_VARIABLES.items() <= spec.env.items()


def test_jupyterlab_asks_no_question_about_news(tmp_path: Path) -> None:
    lab = Path(sys.prefix) / "share/jupyter/lab"
    settings, _ = get_settings(str(lab / "settings"), str(lab / "schemas"), str(tmp_path), schema_name=NEWS)
    found = settings["schema"]["properties"]
    wanted = lab_settings()[NEWS]
    assert isinstance(wanted, dict)
    assert {name: found[name]["default"] for name in wanted} == wanted


def test_the_terminals_start_with_the_course() -> None:
    server = ServerApp()
    server.load_config_file()
    shell = server.config.ServerApp.terminado_settings["shell_command"]
    assert shell[1] == "--rcfile"
    assert Path(shell[2]).name == "terminal.bashrc"
    assert Path(shell[2]).exists()


def test_a_terminal_finds_ros_after_the_users_own_settings(tmp_path: Path) -> None:
    (tmp_path / ".bashrc").write_text("PATH=/usr/bin:/bin; export FROM_MY_BASHRC=yes\n")
    root = Path(sys.prefix).parent
    command = ["bash", "--rcfile", str(root / "environment/terminal.bashrc"), "-i"]
    done = subprocess.run(
        command,
        input="command -v python\necho $FROM_MY_BASHRC\nexit\n",
        env={"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.splitlines()[:2] == [f"{sys.prefix}/bin/python", "yes"]


def test_a_terminal_begins_where_the_notebooks_are_and_knows_the_course(tmp_path: Path) -> None:
    root, chapter = Path(sys.prefix).parent, tmp_path / "chapters" / "01_first"
    chapter.mkdir(parents=True)
    done = subprocess.run(
        ["bash", "--rcfile", str(root / "environment/terminal.bashrc"), "-i"],
        cwd=chapter.parent,
        input="pwd\ncourse help | head -n 1\nexit\n",
        env={"HOME": str(tmp_path), "PATH": "/usr/bin:/bin", "AUTOGRADER_NOTEBOOKS": str(chapter.parent)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.splitlines()[0] == str(chapter)
    assert "usage: ./course COMMAND" in done.stdout


def test_without_bash_the_terminals_stay_as_they_are(tmp_path: Path) -> None:
    assert server_config(tmp_path, None) == {}


def test_writing_again_gives_the_same_files(tmp_path: Path) -> None:
    write_jupyter_files(tmp_path, tmp_path)
    first = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    write_jupyter_files(tmp_path, tmp_path)
    assert len(first) == 3
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == first
