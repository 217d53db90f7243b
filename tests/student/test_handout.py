"""The hand-out checks students' nodes, and nothing in it is a solution."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import zipfile
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import course, exercises, packed_files
from autograder.masters.master_files import lab_name, masters
from autograder.student import handout
from autograder.student.handout import CannotHandOut, hand_out
from tests.copies import copied

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[2]
SOLUTION = re.compile(r"### BEGIN SOLUTION\n(.*?)### END SOLUTION", re.DOTALL)
BROKEN = re.compile(r"^ *#- (.*)$", re.MULTILINE)


@pytest.fixture(scope="module")
def handed_out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("handed") / "course"
    hand_out(place, ROOT)
    return place


def lines(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines() if line.strip()]


def pairs(text: str) -> set[tuple[str, str]]:
    """Each two lines that follow each other, without those that say nothing."""
    told = [line for line in lines(text) if "TODO" not in line]  # what a stub keeps of its region
    return {(a, b) for a, b in pairwise(told) if len(a + b) > 30}


def solutions() -> dict[str, set[tuple[str, str]]]:
    """By the lab. What is in the broken code of a lab, which students get to repair it, is no solution."""
    found = {}
    for master in masters(ROOT):
        regions = SOLUTION.findall(master.read_text(encoding="utf-8"))
        broken = ("\n".join(BROKEN.findall(region)) for region in regions)
        found[lab_name(master)] = set().union(*map(pairs, regions)) - set().union(*map(pairs, broken))
    return found


def texts(folder: Path) -> Iterator[tuple[Path, str]]:
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        # A notebook's lines are JSON strings.
        yield (
            path,
            re.sub(r'^\s*"|\\n",?$|",?$', "", text, flags=re.MULTILINE) if path.suffix == ".ipynb" else text,
        )


def test_no_two_lines_of_a_solution_are_in_it(handed_out: Path) -> None:
    by_lab = solutions()
    everything = set().union(*by_lab.values())
    assert len(everything) > 60
    # What one lab asks for is given in another one that builds on it, and an interface package comes with the course.
    found = [
        (path.name, pair)
        for path, text in texts(handed_out)
        if path.name != "package.xml"
        for pair in pairs(text) & (by_lab[path.stem] if path.suffix == ".ipynb" else everything)
    ]
    assert not found


def test_of_a_bug_hunt_it_has_the_tickets_and_what_their_cards_show_after_the_pass(handed_out: Path) -> None:
    kept = {path.relative_to(handed_out / "exercises") for path in (handed_out / "exercises").rglob("*.*on")}
    lab = Path("01_ros2_fundamentals/bugs_1")
    assert lab / "dark_display.solution.json" in kept
    assert (handed_out / "exercises" / lab / "dark_display.ticket.toml").is_file()
    assert {path.parent.name for path in kept if path.name.endswith(course.SOLUTION)} <= {"bugs_1", "bugs_2"}


def test_the_causes_and_repairs_of_a_bug_hunt_cannot_be_read_by_chance(handed_out: Path) -> None:
    lab = Path("01_ros2_fundamentals/bugs_2")
    for name in ("runaway.ticket.toml", "runaway.solution.json"):
        content = (ROOT / "solutions" / lab / name).read_bytes()
        packed = handed_out / "exercises" / lab / name
        assert packed_files.read(packed) == content
        assert not [
            path for path in handed_out.rglob("*") if path.is_file() and content[:60] in path.read_bytes()
        ]


def test_a_solution_that_slipped_in_would_be_found(tmp_path: Path) -> None:
    region = SOLUTION.findall((ROOT / "solutions/01_ros2_fundamentals/lab_1_2/lab.md").read_text())[0]
    (tmp_path / "talker.py").write_text(region)
    assert any(pairs(text) & solutions()["lab_1_2"] for _, text in texts(tmp_path))


def test_neither_masters_nor_answers_nor_the_grader_are_in_it(handed_out: Path) -> None:
    names = {path.relative_to(handed_out).as_posix() for path in handed_out.rglob("*")}
    assert not [
        name for name in names if "solutions" in name.split("/") or name.endswith(("lab.md", ".answers"))
    ]
    assert not [
        name for name in names if name.startswith(("tests", "autograder/grading", "autograder/masters"))
    ]
    assert "exercises/01_ros2_fundamentals/lab_1_2/talker.reference.json" in names
    assert os.access(handed_out / "course", os.X_OK)


def test_its_pages_lead_to_what_is_in_it(handed_out: Path) -> None:
    for page in (handed_out / "README.md", handed_out / "docs/students-guide.md"):
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_it_has_only_the_pictures_that_its_pages_show(handed_out: Path) -> None:
    """The film of the README types the solution of a lab."""
    pictures = {path.name for path in (handed_out / "docs/images").iterdir()}
    assert pictures == {"course-panel.png", "passed.png"}


def run(place: Path, *words: str) -> subprocess.CompletedProcess[str]:
    environ = os.environ | {"PYTHONPATH": str(place), "AUTOGRADER_COURSE": str(place)}
    return subprocess.run(
        [sys.executable, "-m", "autograder", *words],
        env=environ,
        cwd=place,
        capture_output=True,
        text=True,
        check=False,
    )


def test_it_has_the_ways_in_for_other_computers(handed_out: Path) -> None:
    for name in (".devcontainer/devcontainer.json", ".dockerignore", "environment/jazzy.Dockerfile"):
        assert (handed_out / name).is_file()


def test_it_lists_its_exercises_and_says_what_it_cannot_do(handed_out: Path) -> None:
    listed = run(handed_out, "check")
    assert [line.split()[0] for line in listed.stdout.splitlines()] == list(exercises.all_ids())
    grading = run(handed_out, "grade", "class")
    assert (grading.returncode, grading.stderr) == (
        2,
        "autograder: this copy of the course is for students and does not contain this command\n",
    )
    again = run(handed_out, "hand-out", "more")
    assert again.returncode == 2
    done = subprocess.run([handed_out / "course", "test"], capture_output=True, text=True, check=False)
    assert (done.returncode, "no tests" in done.stderr) == (2, True)


def test_it_knows_the_map_of_the_course_and_puts_a_notebook_back(handed_out: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(handed_out / "chapters", tmp_path / "chapters"))
    said = run(handed_out, "progress", "--folder", str(folder))
    here = run(ROOT, "progress", "--folder", str(folder))
    assert (said.stdout, said.returncode) == (here.stdout, 0)
    notebook = folder / "01_ros2_fundamentals/lab_1_2.ipynb"
    released = notebook.read_bytes()
    notebook.write_text("work")
    done = run(handed_out, "reset", "lab_1_2", "--folder", str(folder))
    assert (done.returncode, notebook.read_bytes()) == (0, released), done.stderr
    assert [path.read_text() for path in notebook.parent.glob("* (your copy*")] == ["work"]


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize(("kind", "code"), [("right", 0), ("wrong", 1)])
def test_it_checks_a_program(handed_out: Path, kind: str, code: int) -> None:
    program = next(exercises.path("lab_1_2.talker").with_suffix(".answers").joinpath(kind).glob("*.py"))
    checked = run(handed_out, "check", "lab_1_2.talker", "--", sys.executable, str(program))
    assert checked.returncode == code, checked.stdout + checked.stderr


def test_the_same_course_gives_the_same_zip(tmp_path: Path) -> None:
    first, second = tmp_path / "a" / "course.zip", tmp_path / "b" / "course.zip"
    for place in (first, second):
        hand_out(place, ROOT, as_zip=True)
    assert first.read_bytes() == second.read_bytes()
    with zipfile.ZipFile(first) as packed:
        assert packed.getinfo("course/course").external_attr >> 16 == 0o755


def test_a_zip_that_was_not_finished_is_none(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        handout._pack(tmp_path / "course.zip", {"a": b"a", "b": tmp_path / "gone"})
    assert list(tmp_path.iterdir()) == []


def test_a_course_without_a_notebook_has_nothing_to_hand_out(tmp_path: Path) -> None:
    (tmp_path / "course" / "solutions").mkdir(parents=True)
    with pytest.raises(CannotHandOut, match="no notebook yet"):
        hand_out(tmp_path / "handed", tmp_path / "course")


def test_nothing_that_somebody_has_written_in_the_chapters_is_in_it(tmp_path: Path) -> None:
    course = tmp_path / "course"
    for name in ("chapters", "solutions"):
        copied(ROOT / name, course / name)
    chapter = course / "chapters/01_ros2_fundamentals"
    (chapter / "ros2_ws/src").mkdir(parents=True)
    (chapter / "ros2_ws/src/talker.py").write_text("my own solution")
    (chapter / "lab_1_2 (your copy, 2026-11-21).ipynb").write_text("my own solution")
    hand_out(tmp_path / "handed", course)
    given = tmp_path / "handed/chapters"
    assert sorted(path.relative_to(given) for path in given.rglob("*.*")) == sorted(
        path.relative_to(ROOT / "chapters")
        for path in (ROOT / "chapters").glob("*/*.ipynb")
        if "(your copy," not in path.name
    )
    notebook = chapter / "lab_1_2.ipynb"
    notebook.write_text(notebook.read_text().replace("# TODO", "pass  # TODO"))
    with pytest.raises(CannotHandOut, match=r"\./course reset lab_1_2"):
        hand_out(tmp_path / "again", course)
    assert not (tmp_path / "again").exists()


def test_a_course_of_three_labs_has_no_link_that_leads_nowhere(tmp_path: Path) -> None:
    labs = ("00_nervous_system", "lab_1_2", "lab_1_4")
    hand_out(tmp_path / "course", ROOT, assignments=labs)
    notebooks = sorted((tmp_path / "course").rglob("*.ipynb"))
    assert [path.stem for path in notebooks] == [*labs, *labs]
    text = "".join(path.read_text() for path in notebooks)
    assert "00_nervous_system" in (linked := set(re.findall(r"\]\((?:\.\./\w+/)?(\w+)\.ipynb", text)))
    assert linked <= set(labs)
    assert "← Previous: Lab 1.1: A workspace and your first node" in text
    listed = run(tmp_path / "course", "check")
    assert {line.split(".")[0] for line in listed.stdout.splitlines()} == set(labs)
    said = run(tmp_path / "course", "progress")
    assert (said.returncode, "Lab 1.3" in said.stdout, "Lab 1.4" in said.stdout) == (0, False, True)
    with pytest.raises(CannotHandOut, match="no notebook is named lab_9"):
        hand_out(tmp_path / "other", ROOT, assignments=["lab_9"])


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("work")
    with pytest.raises(CannotHandOut, match="already exists"):
        hand_out(tmp_path, ROOT)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
