"""The script `course`, in a folder of its own, with programs that only write down that they ran."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cases import cases, named_cases

ROOT = Path(__file__).resolve().parents[2]

# Stands in for environment/bootstrap.py: notes its arguments, makes what the script looks for.
SET_UP = cases(__file__, "SET_UP")
PROGRAM = """\
#!/bin/sh
line="$(basename "$0")$(for word; do printf ' [%s]' "$word"; done)"
echo "$line" >> '{root}/ran.txt'  # in one write, since mypy runs beside ruff
echo "$PWD|${{LD_LIBRARY_PATH:-}}"
exit {code}
"""


class Course:
    """A folder with the script, and what happened in it."""

    def __init__(self, root: Path):
        self.root = root
        self.script = root / "course"

    def run(self, *arguments: str, cwd: Path | None = None, **more: str) -> subprocess.CompletedProcess[str]:
        """Run the script and return its exit code and output."""
        environ = {"PATH": os.environ["PATH"], "PYTHON": sys.executable, **more}
        return subprocess.run(
            [str(self.script), *arguments], cwd=cwd, env=environ, capture_output=True, text=True, check=False
        )

    def ran(self) -> list[str]:
        """Return what ran since the last time this was asked."""
        log = self.root / "ran.txt"
        lines = log.read_text().splitlines() if log.exists() else []
        log.unlink(missing_ok=True)
        return lines

    def program(self, name: str, code: int = 0) -> None:
        """Put a program into the environment that ends with a code."""
        path = self.root / ".venv/bin" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(PROGRAM.format(root=self.root, code=code))
        path.chmod(0o755)


@pytest.fixture
def course(tmp_path: Path) -> Course:
    root = tmp_path / "the course"
    (root / "environment/requirements").mkdir(parents=True)
    (root / "environment/interfaces/own_interfaces/srv").mkdir(parents=True)
    (root / "course_runtime/ros2_command").mkdir(parents=True)
    (root / "chapters").mkdir()
    (root / "tests").mkdir()
    shutil.copy(ROOT / "course", root / "course")
    (root / "tests/nothing_left.py").write_text("import os, sys\nos.execvp(sys.argv[1], sys.argv[1:])\n")
    (root / "tests/english.py").write_text("")
    (root / "pyproject.toml").write_text("[project]\n")
    (root / "environment/__init__.py").write_text("")
    (root / "environment/bootstrap.py").write_text(SET_UP)
    (root / "course_runtime/place.py").write_text("")
    (root / "course_runtime/ros2_command/install.py").write_text("")
    (root / "environment/requirements/course.lock").write_text("six==1.17.0\n")
    (root / "environment/interfaces/own_interfaces/srv/A.srv").write_text("---\n")
    made = Course(root)
    for name in ("autograder", "jupyter", "ruff", "codespell", "mypy", "pytest"):
        made.program(name)
    return made


@pytest.mark.parametrize(
    ("words", "variables", "code", "ran", "says"), named_cases(__file__, "what_a_command_runs_and_says")
)
def test_what_a_command_runs_and_says(
    course: Course,
    words: tuple[str, ...],
    variables: dict[str, str],
    code: int,
    ran: tuple[str, ...],
    says: str,
) -> None:
    done = course.run(*words, cwd=None, **variables)
    assert (done.returncode, tuple(course.ran())) == (code, ran)
    assert says in done.stdout + done.stderr


def test_a_command_sets_up_once_and_then_is_only_run(course: Course) -> None:
    assert course.run("check", "lab_1_2.talker").returncode == 0
    assert course.ran() == ["set-up --token", "autograder [check] [lab_1_2.talker]"]
    course.run("check")
    assert course.ran() == ["autograder [check]"]


@pytest.mark.parametrize("changed", cases(__file__, "a_change_of_what_it_is_made_from_sets_up_again"))
def test_a_change_of_what_it_is_made_from_sets_up_again(course: Course, changed: str) -> None:
    course.run("check")
    course.ran()
    (course.root / changed).parent.mkdir(parents=True, exist_ok=True)
    with (course.root / changed).open("a") as file:
        file.write("# changed\n")
    course.run("check")
    assert course.ran() == ["set-up --token", "autograder [check]"]


def test_a_moved_folder_is_set_up_again(course: Course) -> None:
    course.run("check")
    course.ran()
    moved = Course(course.root.rename(course.root.parent / "moved"))
    moved.run("check")
    assert moved.ran() == ["set-up --token"]


def test_an_interpreter_that_is_gone_sets_up_again(course: Course) -> None:
    course.run("check")
    course.ran()
    python = course.root / ".venv/bin/python"
    python.unlink()
    python.symlink_to("/nowhere/python3")
    course.run("check")
    assert course.ran()[0] == "set-up --token"


def test_the_environments_own_start_does_not_hide_what_is_sourced_from_the_set_up(course: Course) -> None:
    course.run("setup")
    course.ran()
    python = course.root / ".venv/bin/python"
    python.unlink()
    python.write_text(
        f'#!/bin/sh\necho "python $1" >> \'{course.root}/ran.txt\'\nexec "{sys.executable}" "$@"\n'
    )
    python.chmod(0o755)
    course.run("setup", PYTHON="")
    assert course.ran() == ["python -S", "python -S", "set-up --token"]


def test_setup_always_looks_again_and_runs_nothing_else(course: Course) -> None:
    course.run("setup")
    course.run("setup")
    assert course.ran() == ["set-up --token", "set-up --token"]


def test_a_failed_set_up_runs_nothing(course: Course) -> None:
    (course.root / "broken").touch()
    assert course.run("check").returncode == 2
    assert course.ran() == ["set-up --token"]


def test_a_command_runs_in_the_users_folder_and_gives_its_exit_code(course: Course, tmp_path: Path) -> None:
    course.program("autograder", code=7)
    done = course.run("grade", "a b", "", cwd=tmp_path)
    assert done.returncode == 7
    assert done.stdout == f"{tmp_path}|/course lib\n"
    assert course.ran()[1] == "autograder [grade] [a b] []"


def test_it_is_found_through_links(course: Course, tmp_path: Path) -> None:
    relative = course.root.parent / "relative"
    relative.symlink_to(Path(course.root.name) / "course")
    chain = tmp_path / "chain"
    chain.symlink_to(relative)
    through = Course(course.root)
    through.script = chain
    assert through.run("check").returncode == 0
    assert course.ran() == ["set-up --token", "autograder [check]"]


def test_test_runs_every_check_and_the_tests_last(course: Course, tmp_path: Path) -> None:
    done = course.run("test", "-x", cwd=tmp_path)
    assert done.returncode == 0
    ran = course.ran()
    ran.remove("mypy")  # beside the others
    pages = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
    spelled = ("autograder", "benchmarks", "course_runtime", "docs", "environment", "solutions", *pages)
    assert ran == [
        "set-up --token --tests",
        "ruff [check] [.]",
        "ruff [format] [--check] [.]",
        "codespell " + " ".join(f"[{place}]" for place in spelled),
        "pytest [--numprocesses] [auto] [-x]",
    ]
    assert done.stdout.splitlines()[-1].startswith(f"{course.root}|")


@pytest.mark.parametrize("program", ["mypy", "ruff", "codespell", "pytest"])
def test_a_failed_check_fails_the_whole_but_the_others_still_run(course: Course, program: str) -> None:
    course.program(program, code=3)
    done = course.run("test")
    assert done.returncode == 1
    assert f"not in order: {program}" in done.stderr
    assert {line.split()[0] for line in course.ran()} == {"set-up", "ruff", "codespell", "pytest", "mypy"}


def test_an_old_python_is_told_to_the_user(course: Course, tmp_path: Path) -> None:
    old = tmp_path / "bin"
    old.mkdir()
    for name in ("cat", "cksum", "dirname", "readlink"):
        (old / name).symlink_to(shutil.which(name) or name)
    (old / "python3").write_text("#!/bin/sh\nexit 1\n")
    (old / "python3").chmod(0o755)
    done = course.run("check", PATH=str(old), PYTHON="")
    assert done.returncode == 2
    assert "Python 3.11 or newer is needed" in done.stderr
    assert course.ran() == []


def test_what_it_starts_finds_no_code_and_no_program_in_the_current_folder(course: Course) -> None:
    program = course.root / ".venv/bin/autograder"
    program.write_text(
        '#!/bin/sh\necho "$PYTHONSAFEPATH|$PATH|${PYTHONPATH:-}|${LD_LIBRARY_PATH:-}"\necho "$COURSE_PYTHONPATH"\n'
    )
    program.chmod(0o755)
    done = course.run(
        "grade", PATH=f".:{os.environ['PATH']}:", PYTHONPATH=":/opt/ros/a b:tools", LD_LIBRARY_PATH="."
    )
    assert done.stdout == f"1|{os.environ['PATH']}|/opt/ros/a b|\n:/opt/ros/a b:tools\n", done.stderr


def test_the_set_up_and_the_tests_run_as_if_typed_without_it(course: Course) -> None:
    for name in ("ruff", "codespell", "mypy", "pytest"):
        program = course.root / ".venv/bin" / name
        program.write_text('#!/bin/sh\necho "${PYTHONSAFEPATH:-none}"\n')
        program.chmod(0o755)
    done = course.run("test")
    assert (done.returncode, [*map(str.strip, done.stdout.splitlines())].count("none")) == (0, 5), done.stderr
