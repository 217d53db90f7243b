"""Every command of the instructor's guide runs, page after page in the order of its table."""

from __future__ import annotations

import contextlib
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import yaml
from click.testing import CliRunner
from downloads import write_zip

from autograder import exercises
from autograder.cli import cli
from autograder.execution.executed_cells import Execution
from autograder.grading.class_store import ClassStore
from autograder.grading.classes.class_directory import ClassDirectory, Submission
from autograder.grading.running import execution_backends
from autograder.grading.tasks.task_making import task_of
from autograder.judge import evidence_files
from autograder.judge.verdicts import deciding
from autograder.kit.evidence import Evidence

if TYPE_CHECKING:
    from tiny_class import FakeEngine, TinyClass

GUIDE = Path(__file__).parents[3] / "docs" / "instructors-guide.md"
ELSEWHERE = {"own-course"}
"""Pages about the course itself: its tests run the same commands."""


def run(*arguments: object) -> str:
    result = CliRunner().invoke(cli, [str(argument) for argument in arguments])
    assert result.exit_code in (0, 2), result.output
    return result.output


@pytest.fixture
def unboxed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is executed, so no box is needed."""
    monkeypatch.setattr(execution_backends, "require_sandbox", lambda _: None)


def keep_evidence(tiny: TinyClass, student: str, exercise: str) -> None:
    """Have the class keep of a check what the reference solution does."""
    stored = evidence_files.load_reference(exercise)
    seen = Evidence(stored.parts, stored)
    verdict = deciding.decide(exercises.get(exercise), seen, "s")
    packed = evidence_files.pack(verdict, seen, evidence_files.reference_digest(exercise), at=1.8e9)
    directory = ClassDirectory(tiny.path)
    submission = Submission(student, "lab_1_2", tiny.path / "submitted" / student / "lab_1_2")
    task, _ = task_of(directory, submission, "lab_1_2")
    with ClassStore(directory) as store:
        store.keep(task, Execution((), evidence={exercise: packed}))


def pages() -> list[Path]:
    """The guide's pages, in the order of the table that leads to them."""
    linked = re.findall(
        r"^\|.*\((instructor/[\w-]+\.md)\) \|$", GUIDE.read_text(encoding="utf-8"), re.MULTILINE
    )
    return [GUIDE.parent / name for name in dict.fromkeys(linked)]


def commands(text: str) -> list[str]:
    """The lines that a reader of a page is to type."""
    blocks = re.findall(r"^```console\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    return [line[2:] for block in blocks for line in block.splitlines() if line.startswith("$ ")]


def test_every_command_of_the_guide_runs(
    tiny: TinyClass, fake_engine: FakeEngine, unboxed: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from jupyter_core.application import NoStart
    from nbgrader.apps import NbGraderApp

    (tmp_path / "Downloads").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "Downloads" / "Grades-lab_1_2.csv").write_text(
        "Identifier,Full name,Email address,Grade\nParticipant 1,Ada Lovelace,ada@uni.example,\n"
    )
    (tmp_path / "Downloads" / "times.csv").write_text(
        "user_id,submitted_at,login_id\n1,2026-01-31T12:00:00Z,ada\n"
    )
    (tiny.path / "students.csv").write_text(
        "id,first_name,last_name,email,section\nada,Ada,Lovelace,ada@uni.example,Monday\n"
        "ben,Ben,Bär,ben@uni.example,Tuesday\n"
    )
    (tmp_path / "Downloads" / "Grades.csv").write_text(
        "Student,ID,SIS User ID,SIS Login ID,Section,lab_1_2 (9)\n"
        '"Lovelace, Ada",1,,ada,Monday,\n"Bär, Ben",2,,ben,Tuesday,\n'
    )
    notebook = tiny.submit("x", 4, 7)
    names = ("lovelaceada_1_902_lab_1_2.ipynb", "barben_2_903_lab_1_2.ipynb")
    write_zip(tmp_path / "Downloads" / "submissions.zip", dict.fromkeys(names, notebook.read_bytes()))
    for part in (notebook, notebook.parent, notebook.parent.parent):
        part.unlink() if part.is_file() else part.rmdir()
    ran = []
    day = [page for page in pages() if page.stem not in ELSEWHERE]
    for command in (command for page in day for command in commands(page.read_text(encoding="utf-8"))):
        typed = command.replace("~/robotics-2026", str(tiny.path)).replace("~", str(tmp_path))
        words = shlex.split(typed, comments=True)
        if words[0] == "cd":
            monkeypatch.chdir(words[1])
            continue
        assert Path(words[0]).name == "course", command
        name = words[1]
        if name == "new-class":
            # The class of this test is there already: a real one in another place, of one lab.
            words[2:] = [str(tmp_path / "another"), "--assignment", "lab_1_2"]
            subprocess.run([sys.executable, "-m", "autograder", *words[1:]], check=True, capture_output=True)
        elif name == "renew-class":
            run(*words[1:2], tmp_path / "another", *words[3:])
        elif name == "nbgrader":
            NbGraderApp.clear_instance()
            application = NbGraderApp.instance()
            application.initialize(words[2:])
            with contextlib.suppress(NoStart):  # that is how a command within nbgrader ends
                application.start()
            NbGraderApp.clear_instance()
        else:
            if name == "appeal":  # of a check that a judge has seen
                keep_evidence(tiny, words[3], words[4])
            result = CliRunner().invoke(cli, words[1:])
            assert result.exit_code == 0, f"{command}: {result.output}"
        ran.append(name)
    assert {"new-class", "collect", "grade", "appeal", "replay", "report", "export", "nbgrader"} <= set(ran)
    assert (tmp_path / "another" / "release" / "lab_1_2" / "lab_1_2.ipynb").is_file()
    assert (tiny.path / "nbgrader_export.csv").is_file()
    filled = (tiny.path / "export" / "Grades-lab_1_2.csv").read_text()
    assert "Participant 1,Ada Lovelace,ada@uni.example,11" in filled


def test_the_table_of_the_guide_leads_to_every_page() -> None:
    assert sorted(pages()) == sorted((GUIDE.parent / "instructor").glob("*.md"))


def test_the_steps_of_the_guide_type_commands_that_there_are() -> None:
    """A word or an option that a command does not know ends the parsing with an error."""
    page = (GUIDE.parent / "instructor" / "own-course.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"^```yaml\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    typed = [
        shlex.split(step["run"])[1:] for step in yaml.safe_load(text) if step["run"].startswith("./course ")
    ]
    assert typed.pop(0) == ["setup", "--tests"]  # the script's own
    for name, *words in typed:
        cli.commands[name].make_context(name, words)
    assert {name for name, *_ in typed} == {"build", "execute", "demo"}
