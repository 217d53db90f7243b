"""The judge without the course: the wheel, in an empty environment, makes, tries and grades an exercise."""

from __future__ import annotations

import ast
import json
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import nbformat
import pytest

from tests.copies import copied

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"\]\(([^)]+)\)")
UV = Path(sys.prefix) / "bin" / "uv"


def run(*words: str | Path, cwd: Path, code: int = 0, **variables: str) -> str:
    """Run a command that knows nothing of this environment, and return what it printed."""
    activated = Path(words[0]).parent
    bare = {"PATH": f"{activated}:/usr/bin:/bin", "HOME": str(cwd), **variables}
    done = subprocess.run(
        list(map(str, words)), cwd=cwd, env=bare, capture_output=True, text=True, check=False
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def printed_json(text: str) -> Any:
    """The JSON object among the lines of a command."""
    return json.loads(next(line for line in text.splitlines() if line.startswith("{")))


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from a copy, so that nothing is left in the clone."""
    copy = tmp_path_factory.mktemp("copy") / "course"
    copied(ROOT, copy, "tests")
    command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "-w", "dist", "."]
    subprocess.run(command, cwd=copy, check=True, capture_output=True)
    return next((copy / "dist").glob("*.whl"))


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment with the wheel alone: no ROS, no notebooks."""
    folder = tmp_path_factory.mktemp("empty")
    subprocess.run([UV, "venv", "--python", sys.executable, folder / "venv"], check=True, capture_output=True)
    add(folder, wheel)
    return folder


def add(folder: Path, wheel: Path, extra: str = "") -> None:
    """Install the wheel, or what an extra of it adds, with the versions of the locks."""
    locks = ROOT / "environment" / "requirements"
    constraints = folder / "constraints.txt"
    constraints.write_text(
        "".join(
            f"{line.removesuffix(chr(92)).strip()}\n"
            for lock in ("course", "ros", "site")
            for line in (locks / f"{lock}.lock").read_text().splitlines()
            if "==" in line and not line.startswith((" ", "#"))
        )
    )
    command = [
        UV,
        "pip",
        "install",
        "--python",
        folder / "venv",
        "-c",
        constraints,
        f"{wheel}[{extra}]" if extra else wheel,
    ]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def judged_notebook(installed: Path, program: Path, course: Path) -> str:
    """Run a notebook with a program's class and a check of it, and return what the check shows."""
    code = program.read_text().partition("\nrclpy.init()")[0]
    check = "from autograder.notebook import check\ncheck('lab_1_1.battery', Battery)"
    cells = [nbformat.v4.new_code_cell(source) for source in (code, check)]
    notebook = installed / "mine.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=cells), notebook)
    execute = installed / "venv" / "bin" / "jupyter-execute"
    run(execute, "--inplace", notebook, cwd=installed, AUTOGRADER_COURSE=str(course))
    shown = nbformat.read(notebook, as_version=4).cells[-1].outputs
    return "\n".join(str(output.get("data", {}).get("text/plain", output)) for output in shown)


@pytest.mark.slow
@pytest.mark.ros
def test_an_exercise_is_made_tried_checked_and_a_class_of_two_is_graded(installed: Path, wheel: Path) -> None:
    autograder = installed / "venv" / "bin" / "autograder"
    listed = run(UV, "pip", "list", "--python", installed / "venv", cwd=installed)
    assert not {"jupyterlab", "nbgrader"} & {line.split()[0] for line in listed.splitlines()}
    mine = installed / "my-course"
    assert "no course was found here" in run(autograder, "check", cwd=installed, code=2)
    (mine / "solutions").mkdir(parents=True)
    run(autograder, "new-exercise", "lab_1_1.battery", "--chapter", "01_first", cwd=mine)
    for words in (
        ("try-exercise", "lab_1_1.battery"),
        ("check", "lab_1_1.battery", "--", "python3", "my.py"),
    ):
        said = run(autograder, *words, cwd=mine, code=2)
        assert said.count("\n") == 1
        assert "ROS 2 was not found: source the setup script of ROS 2 Jazzy, or type: pip install" in said
        assert "'ros2-on-the-wire[ros]'" in said
    add(installed, wheel, "ros")
    assert "6 answers, none not as expected" in run(autograder, "try-exercise", "lab_1_1.battery", cwd=mine)
    program = mine / "solutions/01_first/lab_1_1/battery.answers/right/usual.py"
    inside = mine / "solutions" / "01_first"
    judged = run(autograder, "check", "lab_1_1.battery", "--json", "--", "python3", program, cwd=inside)
    assert printed_json(judged)["score"] == 10
    assert "./course" not in run(autograder, "doctor", cwd=mine)
    assert "pip install 'ros2-on-the-wire[notebooks]'" in run(autograder, "build", cwd=mine, code=2)

    add(installed, wheel, "class")
    run(autograder, "build", cwd=mine)
    assert "PASSED: 10 of 10 points" in judged_notebook(installed, program, mine)
    class_ = installed / "class"
    run(autograder, "new-class", class_, cwd=mine)
    for student, folder in (("ada", class_ / "source" / "lab_1_1"), ("ben", mine / "chapters" / "01_first")):
        shutil.copytree(folder, class_ / "submitted" / student / "lab_1_1")
    graded = run(autograder, "grade", class_, "--json", cwd=installed)
    points = {one["student"]: one["score"] for one in printed_json(graded)["submissions"]}
    assert points == {"ada": 10, "ben": 0}

    handed_out = installed / "handed-out"
    run(autograder, "hand-out", handed_out, cwd=inside)
    assert "BEGIN SOLUTION" not in "".join(path.read_text() for path in handed_out.rglob("*.*"))
    readme = (handed_out / "README.md").read_text()
    assert 'pip install "ros2-on-the-wire[ros,notebooks]"' in readme
    assert "./course" not in readme
    assert not [target for target in LINK.findall(readme) if not (handed_out / target).exists()]
    assert "0 of 10 points" in run(autograder, "progress", cwd=handed_out)
    judged = run(autograder, "check", "lab_1_1.battery", "--json", "--", "python3", program, cwd=handed_out)
    assert printed_json(judged)["score"] == 10

    assert "pip install 'ros2-on-the-wire[site]'" in run(autograder, "site", cwd=mine, code=2)
    add(installed, wheel, "site")
    run(autograder, "site", cwd=inside)
    page = (mine / "site" / "chapters" / "01_first" / "lab_1_1.html").read_text()
    assert "Solution (click to expand)" in page
    assert "10 of 10 points" in page
    assert "battery" in (mine / "site" / "index.html").read_text()


@pytest.mark.slow
@pytest.mark.ros
def test_an_interface_of_ones_own_builds_itself(installed: Path, wheel: Path) -> None:
    """A chapter has a definition and no package.xml; the wheels of ROS name folders of another machine."""
    autograder, mine = installed / "venv" / "bin" / "autograder", installed / "course-with-a-type"
    chapter = copied(ROOT / "tests/second_chapter/solutions/02_power", mine / "solutions" / "02_power")
    program = chapter / "lab_2_1/dimmer.answers/right/usual.py"
    add(installed, wheel, "ros")
    said = run(autograder, "record", "lab_2_1.dimmer", cwd=mine, code=2)
    assert "power_interfaces cannot be built" in said
    assert "pip install 'ros2-on-the-wire[interfaces]'" in said
    add(installed, wheel, "interfaces")
    assert "autograder: building power_interfaces, once\n" in run(autograder, "record", cwd=mine)
    judged = run(autograder, "check", "lab_2_1.dimmer", "--json", "--", "python3", program, cwd=mine)
    assert printed_json(judged)["score"] == 10
    assert "building" not in judged


def test_the_wheel_has_each_file_of_the_package(wheel: Path) -> None:
    """A folder with a dot in its name was missing, so ``autograder lab`` had no course page."""
    packages = (ROOT / "autograder", ROOT / "course_runtime")
    found = (path for package in packages for path in package.rglob("*"))
    files = [path for path in found if path.is_file() and "__pycache__" not in path.parts]
    names = set(zipfile.ZipFile(wheel).namelist())
    assert not [str(path) for path in files if str(path.relative_to(ROOT)) not in names]


def test_the_wheel_installs_two_packages_which_nobody_else_has(wheel: Path) -> None:
    """The set-up of a clone stayed behind: `environment` is a name that other projects have, too."""
    tops = {name.partition("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"autograder", "course_runtime"}


def test_a_folder_of_a_student_is_no_course_to_a_command_for_a_class(tmp_path: Path) -> None:
    """Mallory hands in a folder with a course in it, and the instructor types `grade` there."""
    evil = tmp_path / "submitted" / "mallory" / "solutions" / "01_x" / "lab_1" / "evil.py"
    evil.parent.mkdir(parents=True)
    evil.write_text("print('it ran')")
    code = (
        "import os; from autograder import course; from autograder.cli import cli, IN_A_COURSE\n"
        "assert not IN_A_COURSE & {'grade', 'collect', 'report', 'export', 'appeal', 'replay'}\n"
        "course.use_the_one_around.__globals__['use'] = lambda folder: print('used', folder)\n"
        "cli(['grade', '.'])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path / "submitted" / "mallory",
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, "used" in done.stdout, "it ran" in done.stdout) == (2, False, False), done.stderr


WRITTEN_FOR_A_CLONE = ("student/handout.py", "masters/source_notebooks.py")
"""What these write is read in a clone or in what `hand-out` makes, which has ``./course``, too."""


def test_no_message_names_what_only_a_clone_has() -> None:
    """``course_runtime/installation.py`` decides what a message tells people to type."""
    package = ROOT / "autograder"
    found = []
    for path in sorted(package.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        apart = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}  # docstrings
        found += [
            f"{path.relative_to(package)}:{node.lineno}"
            for node in ast.walk(tree)
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and "./course" in node.value
            if id(node) not in apart and str(path.relative_to(package)) not in WRITTEN_FOR_A_CLONE
        ]
    assert not found
