"""Every command on a page is one that its program understands, and each command is run by a test."""

from __future__ import annotations

import shutil
import subprocess
from collections import defaultdict
from typing import TYPE_CHECKING

import pytest

from autograder import exercises
from course_runtime.ros2_command.commands import COMMANDS, ELSEWHERE
from tests.cases import cases
from tests.documented_commands import (
    COURSE,
    PAGES,
    ROOT,
    Words,
    commands_of,
    documented,
    split_command,
    why_not_understood,
)

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [
    pytest.mark.filterwarnings("ignore:.*prior to execution of:RuntimeWarning"),
    pytest.mark.filterwarnings("ignore:Setuptools is replacing distutils"),  # pip's own parser is asked
]
GUIDE = "grading/day/test_guide.py::test_every_command_of_the_guide_runs"
ADDING = "test_adding_an_exercise.py::test_the_page_does_what_it_says"
TYPES_A_PAGE = {GUIDE: "docs/instructor/", ADDING: "docs/adding-an-exercise.md"}
"""The tests that read from these pages what they type: each command in a block."""
_GRAPH = "environment/ros2_command/test_graph.py::"
_INTERFACE = "environment/ros2_command/test_interface.py::"
_SERVICES = f"{_GRAPH}test_what_the_verbs_say"
_TOPICS = f"{_GRAPH}test_what_the_verbs_say"
_PICTURES = "grading/day/test_pictures.py::"
_SCRIPT = "environment/test_course_script.py::"
GROUPS = {name for name, command in COMMANDS.items() if command.verbs}
RUN_BY = {
    "./course --help": "test_cli.py::test_the_help_lists_each_command_once_with_a_whole_sentence",
    "./course appeal": GUIDE,
    "./course attempts": GUIDE,
    "./course benchmark": "benchmarks/test_short_run.py::test_every_figure_is_measured",
    "./course build": ADDING,
    "./course check": "test_cli.py::test_a_right_answer_ends_with_0_and_a_wrong_one_with_1",
    "./course collect": GUIDE,
    "./course demo": "grading/new_classes/test_sample_class.py::test_every_sample_earns_what_it_must",
    "./course doctor": "environment/test_doctor.py::test_this_machine_has_all_that_the_course_needs",
    "./course execute": "test_second_chapter.py::test_its_notebooks_are_executed",
    "./course export": GUIDE,
    "./course grade": GUIDE,
    "./course hand-out": GUIDE,
    "./course jupyter lab": f"{_SCRIPT}test_what_a_command_runs_and_says",
    "./course lab": "student/test_lab_server.py::test_the_address_stands_last_and_alone",
    "./course nbgrader autograde": GUIDE,
    "./course nbgrader db student add": "test_docs_commands.py::test_a_student_is_added_by_hand",
    "./course nbgrader export": GUIDE,
    "./course nbgrader generate_assignment": f"{_PICTURES}test_the_picture_of_a_solution_is_not_handed_out",
    "./course nbgrader generate_feedback": GUIDE,
    "./course new-class": GUIDE,
    "./course new-exercise": ADDING,
    "./course progress": "student/test_course_page.py::test_the_terminal_says_the_same",
    "./course record": "test_second_chapter.py::test_its_solution_is_recorded_and_its_answers_are_judged",
    "./course renew-class": GUIDE,
    "./course replay": GUIDE,
    "./course report": GUIDE,
    "./course reset": "student/test_notebook_reset.py::test_the_command_says_where_the_copy_is",
    "./course setup": f"{_SCRIPT}test_setup_always_looks_again_and_runs_nothing_else",
    "./course site": "authoring/test_site.py::test_every_lab_has_a_page_and_every_page_is_small_and_loads_nothing",
    "./course students": GUIDE,
    "./course test": f"{_SCRIPT}test_test_runs_every_check_and_the_tests_last",
    "./course try-exercise": ADDING,
    "./course week": GUIDE,
    "./course worker": "grading/cluster/test_cluster_worker.py::test_it_says_what_it_offers_and_ends_when_it_is_told",
    "colcon build": "environment/ros2_command/test_pkg_create.py::test_colcon_builds_what_was_created",
    "git clone": "test_docs_commands.py::test_the_course_is_cloned_and_brought_up_to_date",
    "git pull": "test_docs_commands.py::test_the_course_is_cloned_and_brought_up_to_date",
    "pip install": "test_wheel.py::test_an_exercise_is_made_tried_checked_and_a_class_of_two_is_graded",
    "pip wheel": "test_wheel.py::test_an_exercise_is_made_tried_checked_and_a_class_of_two_is_graded",
    "ros2 --version": "environment/ros2_command/test_words.py::test_the_version",
    "ros2 action info": f"{_GRAPH}test_what_the_verbs_say",
    "ros2 action list": f"{_GRAPH}test_what_the_verbs_say",
    "ros2 action send_goal": f"{_GRAPH}test_what_the_verbs_say",
    "ros2 doctor": f"{_GRAPH}test_doctor_sees_both_sides_of_a_topic",
    "ros2 interface packages": f"{_INTERFACE}test_packages_with_interfaces_are_listed_by_kind",
    "ros2 interface show": f"{_INTERFACE}test_show_indents_nested_types_by_tabs",
    "ros2 launch": "environment/ros2_command/test_launch_processes.py::test_a_launch_file_of_a_package",
    "ros2 node list": f"{_GRAPH}test_what_the_verbs_say",
    "ros2 pkg create": "environment/ros2_command/test_pkg_create.py::test_a_python_package",
    "ros2 pkg executables": "environment/ros2_command/test_run.py::test_packages_and_their_programs",
    "ros2 run": "environment/ros2_command/test_run.py::test_the_program_gets_its_arguments",
    "ros2 service call": _SERVICES,
    "ros2 service find": _SERVICES,
    "ros2 service list": _SERVICES,
    "ros2 service type": _SERVICES,
    "ros2 topic echo": f"{_GRAPH}test_what_the_verbs_say",
    "ros2 topic hz": f"{_GRAPH}test_hz_measures_the_rate",
    "ros2 topic info": f"{_GRAPH}test_what_the_verbs_say",
    "ros2 topic list": _TOPICS,
    "ros2 topic pub": f"{_GRAPH}test_pub_reaches_a_listener",
}
"""For each command that a page names, a test that runs it. What begins with ``python`` is for maintainers, and is
only parsed."""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_command_of_a_page_is_understood(page: Path, pytestconfig: pytest.Config) -> None:
    typed = commands_of(page.read_text(encoding="utf-8"), page)
    refused = [why_not_understood(one, pytestconfig._parser) for one in typed]
    assert not list(filter(None, refused))


def test_every_exercise_of_a_command_is_there() -> None:
    """Unless a page tells its reader to make it."""
    named = [
        (typed.words[1], typed.words[2], typed.page)
        for typed in documented()
        if typed.words[0] == COURSE and len(typed.words) > 2
    ]
    made = {exercise for command, exercise, _ in named if command == "new-exercise"}
    checked = [(exercise, page) for command, exercise, page in named if command in ("check", "record")]
    assert checked
    known = {*exercises.all_ids(), *made, "EXERCISE"}
    assert not [(exercise, page) for exercise, page in checked if exercise not in known]


def is_to_be_run(command: Words) -> bool:
    """Whether words are more than a name in a sentence: of a program, a group, or a command of a whole ``ros2``."""
    if len(command) == 1 or command[0] == "python":
        return False
    return command[0] != "ros2" or len(command) > 2 or command[1] not in {*ELSEWHERE, *GROUPS}


def test_every_command_is_run_by_a_test() -> None:
    found = defaultdict(list)
    for typed in documented():
        command, _ = split_command(typed.words)
        if is_to_be_run(command):
            found[" ".join(command)].append(typed)
    # README shows this line only if the course has an address.
    assert set(found) | {"git clone"} == set(RUN_BY)
    for shown, test in RUN_BY.items():
        file, _, name = test.partition("::")
        python = ROOT / "tests" / file
        sources = (python, python.with_suffix(".toml"))
        source = "".join(one.read_text(encoding="utf-8") for one in sources if one.exists())
        assert f"def {name}(" in source, shown
        if page := TYPES_A_PAGE.get(test):
            assert any(typed.in_block and page in typed.page for typed in found[shown]), shown
        else:
            assert shown.split()[-1] in source, shown


def test_the_course_is_cloned_and_brought_up_to_date(tmp_path: Path) -> None:
    public = tmp_path / "public"
    public.mkdir()

    def git(*words: str, folder: Path = public) -> None:
        author = ("-c", "user.name=ada", "-c", "user.email=ada@uni.example")
        subprocess.run(["git", *author, *words], cwd=folder, check=True, capture_output=True)

    git("init", "--initial-branch", "main")
    shutil.copy(ROOT / "course", public)
    git("add", "--all")
    git("commit", "--message", "The course")
    home = tmp_path / "home"
    home.mkdir()
    subprocess.run(["git", "clone", public], cwd=home, check=True)
    (public / "README.md").touch()
    git("add", "--all")
    git("commit", "--message", "A page")
    mine = home / "public"
    git("pull", folder=mine)
    assert (mine / "README.md").exists()
    said = subprocess.run([mine / "course", "help"], check=True, capture_output=True, text=True).stdout
    assert "usage: ./course COMMAND" in said


def test_a_student_is_added_by_hand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from nbgrader.api import Gradebook
    from nbgrader.apps.dbapp import DbStudentAddApp

    monkeypatch.chdir(tmp_path)
    application = DbStudentAddApp()
    application.initialize(["ada"])
    application.start()
    with Gradebook("sqlite:///gradebook.db") as gradebook:
        assert [student.id for student in gradebook.students] == ["ada"]


@pytest.mark.parametrize(
    "line",
    cases(__file__, "a_command_that_its_program_refuses_is_found"),
)
def test_a_command_that_its_program_refuses_is_found(line: str, pytestconfig: pytest.Config) -> None:
    for text in (f"```console\n$ {line}   # as it is typed\n```\n", f"Type `{line}` here."):
        (typed,) = commands_of(text, ROOT / "README.md")
        if typed.whole:
            assert why_not_understood(typed, pytestconfig._parser)


def test_the_commands_of_a_line_and_of_a_block_without_a_prompt_are_found() -> None:
    text = (
        "```console\n$ git clone ADDRESS x && cd x   # first\nprinted: ./course grad\n"
        '$ for a in source/*; do ~/x/course grade "$a" --again; done\n```\n'
        "```\n./course setup      set up\n```\n```python\ngit = 1\n```\nSee `./course grade`, `grade`.\n"
    )
    found = [(typed.words, typed.whole) for typed in commands_of(text, ROOT / "README.md")]
    assert found == [
        (("git", "clone", "ADDRESS", "x"), True),
        ((COURSE, "grade", "$a", "--again"), True),
        ((COURSE, "setup"), True),
        ((COURSE, "grade"), False),
    ]
