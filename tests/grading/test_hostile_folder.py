"""An instructor's commands, typed in a folder that a student has filled: nothing in that folder runs."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.student.known_classes import CONFIG_NAME, reason_against
from course_runtime.python_child import installed_program
from tests.cases import cases

if TYPE_CHECKING:
    from tiny_class import TinyClass

ROOT = Path(__file__).resolve().parents[2]
# Read by Python, Jupyter, nbgrader, jupytext, pytest and colcon in one folder or another.
SETTINGS = (
    *("sitecustomize.py", "usercustomize.py", "conftest.py", "setup.py", ".jupytext.py", "ipython_config.py"),
    *("jupyter_config.py", "jupyter_server_config.py", "jupyter_nbconvert_config.py", "nbgrader_config.py"),
)
PROGRAMS = cases(__file__, "PROGRAMS")
TEMPLATES = ("lab", "base", "classic", "autograder_feedback", "feedback")


class Hostile:
    """A folder in which every file that anything might read leaves a mark."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "mallory"
        self.path.mkdir()
        self._marks = folder / "marks"
        code = f"open({str(self._marks)!r}, 'a').write(__name__ + ' ' + __file__ + '\\n')\n"
        modules = {
            *sys.stdlib_module_names,
            *packages_distributions(),
            "autograder",
            "course_runtime",
            "environment",
        }
        for name in (*(f"{module}.py" for module in modules if "/" not in module), *SETTINGS):
            (self.path / name).write_text(code)
        (self.path / "mallory.pth").write_text(f"import os; {code}")
        for name in PROGRAMS:
            (self.path / name).write_text(f"#!/bin/sh\necho program {name} >> '{self._marks}'\n")
            (self.path / name).chmod(0o755)
        runs = {"type": "subprocess.Popen", "args": ["sh", "-c", f"echo template >> '{self._marks}'"]}
        for name in TEMPLATES:
            (self.path / name).mkdir()
            (self.path / name / "conf.json").write_text(json.dumps({"preprocessors": {"x": runs}}))

        (self.path / "custom").mkdir()
        (self.path / "custom/custom.css").write_text(".mallory { color: red }")

    def marks(self) -> str:
        return self._marks.read_text() if self._marks.exists() else ""

    def wipe(self) -> None:
        """Remove the marks of an earlier test."""
        self._marks.unlink(missing_ok=True)


@pytest.fixture(scope="module")
def _hostile(tmp_path_factory: pytest.TempPathFactory) -> Hostile:
    return Hostile(tmp_path_factory.mktemp("hostile"))


@pytest.fixture
def hostile(_hostile: Hostile) -> Hostile:
    """A folder without marks; the tests leave its files as they are."""
    _hostile.wipe()
    return _hostile


@pytest.fixture
def course(tmp_path: Path) -> Path:
    """The script ``course``, with the commands of this environment and nothing to set up."""
    root = tmp_path / "course"
    for name in (
        "environment/requirements",
        "course_runtime/ros2_command",
        "environment/interfaces",
        ".venv/bin",
    ):
        (root / name).mkdir(parents=True)
    shutil.copy(ROOT / "course", root / "course")
    for name in (
        "pyproject.toml",
        "environment/requirements/course.lock",
        "course_runtime/ros2_command/install.py",
    ):
        (root / name).touch()
    bootstrap = "import os, shutil, sys\nos.makedirs('.venv/course', exist_ok=True)\n"
    bootstrap += "open('.venv/course/token', 'w').write(sys.argv[2] + '\\n')\n"
    bootstrap += f"shutil.copy({str(Path(sys.prefix, 'course/libraries.sh'))!r}, '.venv/course')\n"
    (root / "environment/bootstrap.py").write_text(bootstrap)
    for name in ("python", "autograder"):
        (root / ".venv/bin" / name).write_text(f'#!/bin/sh\nexec "{installed_program(name)}" "$@"\n')
        (root / ".venv/bin" / name).chmod(0o755)
    return root / "course"


def typed(course: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Type a command in the folder, with search paths that have it in them as many terminals' have."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"}
    environment["PATH"] = f":.:{environment['PATH']}"
    environment["PYTHONPATH"] = f":{environment.get('PYTHONPATH', '')}"
    environment["LD_LIBRARY_PATH"] = f":{environment.get('LD_LIBRARY_PATH', '')}"
    return subprocess.run(
        ["/bin/sh", str(course), *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_folder_itself_would_run(hostile: Hostile) -> None:
    subprocess.run([sys.executable, "-m", "autograder"], cwd=hostile.path, capture_output=True, check=False)
    assert hostile.marks()


@pytest.mark.slow
def test_nothing_of_the_current_folder_runs_while_a_class_is_graded(
    tiny: TinyClass, course: Path, hostile: Hostile
) -> None:
    tiny.submit("ada")
    (tiny.path / "students.csv").write_text("id\nada\nben\n")
    graded = typed(course, hostile.path, "grade", str(tiny.path))
    assert "ada" in graded.stdout, graded.stderr
    assert "mallory" not in (tiny.path / "feedback/ada/lab_1_2/lab_1_2.html").read_text()
    more = shutil.copytree(tiny.path / "submitted/ada/lab_1_2", tiny.path / "download/ben")
    for command, *words in (["collect", str(more)], ["report"], ["export", "--to", "csv"]):
        done = typed(course, hostile.path, command, str(tiny.path), *words)
        assert done.returncode == 0, done.stdout + done.stderr
    assert hostile.marks() == ""


@pytest.fixture
def handed_in(tiny: TinyClass, hostile: Hostile) -> Path:
    """What a student has handed in: a class of the student's own."""
    folder = tiny.submit("mallory").parent
    shutil.copytree(tiny.path / "source", folder / "source")
    shutil.copy(hostile.path / "nbgrader_config.py", folder)
    return folder


@pytest.mark.parametrize("command", ["grade", "report", "new-class"])
def test_a_class_that_a_student_has_handed_in_is_not_used(
    tiny: TinyClass, hostile: Hostile, handed_in: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.chdir(handed_in)
    done = CliRunner().invoke(cli, [command, "."])
    assert done.exit_code == 2
    assert f"Use the class that contains it: {tiny.path}" in done.output
    assert hostile.marks() == ""


@pytest.mark.parametrize("where", ["in a class", "in a download"])
@pytest.mark.parametrize("command", ["nbgrader", "jupyter"])
def test_a_program_that_would_read_a_students_configuration_is_not_started(
    course: Path, hostile: Hostile, handed_in: Path, command: str, where: str
) -> None:
    done = typed(course, handed_in if where == "in a class" else hostile.path, command, "lab")
    assert done.returncode == 2
    assert f"--config={CONFIG_NAME}" in done.stderr
    assert hostile.marks() == ""


def test_nbgrader_is_not_started_among_modules_that_it_would_import(
    course: Path, hostile: Hostile, tmp_path: Path
) -> None:
    (tmp_path / "alembic.py").write_text((hostile.path / "json.py").read_text())
    assert typed(course, tmp_path, "nbgrader", "db").returncode == 2
    assert hostile.marks() == ""


def test_a_class_that_was_named_once_needs_no_more_words(tiny: TinyClass, tmp_path: Path) -> None:
    moved = tiny.path.rename(tmp_path / "moved")
    assert reason_against(moved, "nbgrader", ["db"])
    assert reason_against(moved, "nbgrader", ["db", f"--config={CONFIG_NAME}"]) == ""
    assert ClassDirectory(moved).config
    assert reason_against(moved, "nbgrader", ["db"]) == ""


@pytest.mark.slow
def test_nothing_of_the_current_folder_runs_while_the_machine_is_looked_at(
    course: Path, hostile: Hostile
) -> None:
    done = typed(course, hostile.path, "doctor")
    assert "rclpy" in done.stdout, done.stdout + done.stderr
    assert hostile.marks() == ""


@pytest.mark.parametrize(
    "words",
    [
        ("appeal", ".", "mallory", "lab_1_2.talker"),
        ("replay", "conf.json"),
        ("worker", "tcp://here"),
        ("demo", "."),
    ],
    ids=lambda words: words[0],
)
def test_a_command_that_is_refused_in_the_folder_has_run_nothing_of_it(
    course: Path, hostile: Hostile, words: tuple[str, ...]
) -> None:
    (hostile.path / "conf.json").write_text("{}")
    done = typed(course, hostile.path, *words)
    assert done.returncode not in (0, 127), done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert hostile.marks() == ""
