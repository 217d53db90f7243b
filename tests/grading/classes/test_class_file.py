"""The file in which an instructor says what counts, and which workspaces submissions may use besides ROS."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import pytest

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.classes.class_file import read_class_file, read_overlays
from autograder.grading.cluster.cluster_dispatcher import on_cluster
from autograder.grading.grading_errors import GradingError
from autograder.grading.table.student_list import read_roster
from autograder.grading.tasks.date_reading import read_class_dates
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tests.grading.tiny_class import TinyClass


@pytest.fixture
def overlay(tmp_path: Path) -> Path:
    """An installed workspace with a module that knows the answer."""
    prefix = tmp_path / "reference_ws" / "install" / "my_robot_pkg"
    (prefix / "share" / "ament_index").mkdir(parents=True)
    modules = prefix / "lib" / f"python3.{sys.version_info.minor}" / "site-packages"
    modules.mkdir(parents=True)
    (modules / "reference_solution.py").write_text("POINTS = 10\n")
    return prefix


def test_a_workspace_that_is_sourced_is_in_no_box_and_one_that_the_class_names_is(
    tiny: TinyClass, with_fake_judge: str, overlay: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (modules,) = overlay.glob("lib/*/site-packages")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(overlay), prepend=os.pathsep)
    monkeypatch.setenv("PYTHONPATH", str(modules), prepend=os.pathsep)
    answer = "next((10 for _ in [0] if __import__('importlib').util.find_spec('reference_solution')), 1)"
    tiny.submit("ada", answer)
    tiny.grade(judge=with_fake_judge)
    assert tiny.scores("ada")["lab_1_2-talker"] == 1
    for name in ("AMENT_PREFIX_PATH", "PYTHONPATH"):
        monkeypatch.setenv(name, os.environ[name].partition(os.pathsep)[2])
    (tiny.path / "class.toml").write_text(f'overlays = ["{overlay}"]')
    report = tiny.grade(judge=with_fake_judge)
    assert report.run_again == {"the settings of the class changed": 1}
    assert tiny.scores("ada")["lab_1_2-talker"] == 10
    assert tiny.grade(judge=with_fake_judge).executed == 0


def test_a_path_may_be_relative_to_the_class_or_the_home_folder(
    tmp_path: Path, overlay: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "class").mkdir()
    for path in ("../reference_ws/install/my_robot_pkg", "~/reference_ws/install/my_robot_pkg", str(overlay)):
        (tmp_path / "class" / "class.toml").write_text(f'overlays = ["{path}"]')
        assert [path.resolve() for path in read_overlays(tmp_path / "class")] == [overlay]


@pytest.mark.parametrize(
    ("named", "words"),
    [
        ("reference_ws/nowhere", "this folder does not exist"),
        ("reference_ws/install", "no share/ament_index.*--merge-install"),
    ],
)
def test_what_is_no_installed_workspace_is_refused_before_anything_is_graded(
    tiny: TinyClass, tmp_path: Path, overlay: Path, named: str, words: str
) -> None:
    assert overlay.is_dir()
    (tiny.path / "class.toml").write_text(f'overlays = ["{tmp_path / named}"]')
    with pytest.raises(GradingError, match=words):
        tiny.grade()


def test_workers_of_a_cluster_have_no_overlays(tiny: TinyClass, overlay: Path) -> None:
    (tiny.path / "class.toml").write_text(f'overlays = ["{overlay}"]')
    backend = on_cluster(ClassDirectory(tiny.path), "tcp://127.0.0.1:1", "", lambda _: None)
    with pytest.raises(GradingError, match="workers of a cluster do not have"), backend:
        pass


def test_without_the_file_nothing_is_said(tmp_path: Path) -> None:
    assert read_class_file(tmp_path).overlays == ()
    (tmp_path / "class.toml").write_text('overlays = "/opt"')
    with pytest.raises(GradingError, match=r'cannot be used.*overlays = \["/FOLDER"\]'):
        read_class_file(tmp_path)


FAULTS = cases(__file__, "fault")


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_of_the_file_has_a_sentence(tiny: TinyClass, name: str) -> None:
    fault = FAULTS[name]
    (tiny.path / "students.csv").write_text("id,section\nada,Mon\n")
    (tiny.path / "class.toml").write_text(fault["file"])
    tiny.configure(*fault.get("configuration", ()))
    tiny.submit("ada")
    with pytest.raises(GradingError) as caught:
        tiny.grade()
    for words in fault["says"]:
        assert words in str(caught.value)


@pytest.mark.parametrize("name", DATES := cases(__file__, "date"))
def test_an_extension_counts_for_each_member_and_is_never_a_sum(tiny: TinyClass, name: str) -> None:
    (tiny.path / "students.csv").write_text('id,section\nada,"Mon, Team 7"\nben,Mon and Team 7\ncleo,Tue\n')
    (tiny.path / "class.toml").write_text(
        f"[due]\nlab_1_2 = '2026-01-31'\n[extension.lab_1_2]\n{DATES[name]['file']}"
    )
    directory = ClassDirectory(tiny.path)
    dates = read_class_dates(directory, read_roster(directory))
    days = {one: dates.of(one, "lab_1_2", None) for one in ("ada", "ben", "cleo")}
    assert {one: at and at.day for one, at in days.items()} == DATES[name]["days"]
