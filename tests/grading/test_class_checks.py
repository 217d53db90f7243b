"""An option that the conversion does not know is refused, in a sentence, before anything is touched."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from nbgrader.converters import NbGraderException
from test_nbgrader_and_ours import nbgrader_autograde, nbgrader_generate_feedback
from tiny_class import TALKER, FakeEngine, TinyClass

from autograder.grading.class_checks import check_configuration
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.grading_errors import GradingError
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable


def test_who_reads_it_waits_for_no_import_of_nbgrader(tiny: TinyClass) -> None:
    asked = (
        "import pathlib, sys; from autograder.grading.classes.class_directory import ClassDirectory; "
        "ClassDirectory(pathlib.Path(sys.argv[1])).config; print(*{'nbgrader', 'nbconvert'} & set(sys.modules))"
    )
    command = [sys.executable, "-c", asked, str(tiny.path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize("line", cases(__file__, "what_the_conversion_honours_is_not_refused"))
def test_what_the_conversion_honours_is_not_refused(tiny: TinyClass, line: str) -> None:
    tiny.configure(line)
    check_configuration(ClassDirectory(tiny.path))


@pytest.mark.parametrize(("line", "option"), cases(__file__, "what_it_does_not_know_is_refused"))
def test_what_it_does_not_know_is_refused(tiny: TinyClass, line: str, option: str) -> None:
    tiny.configure(line)
    with pytest.raises(GradingError, match=rf"sets c\.{option}, .*delete the line"):
        check_configuration(ClassDirectory(tiny.path))


@pytest.mark.parametrize(
    "line", ["memory_bytes = '4 GB'", "cell_seconds = None", "processes = -1", "cpu_seconds = float('nan')"]
)
def test_a_limit_that_is_no_number_takes_back_nothing(
    tiny: TinyClass, fake_engine: FakeEngine, line: str
) -> None:
    tiny.submit("ada", 4)
    tiny.grade()
    tiny.submit("ada", 9)
    tiny.configure(f"c.WireExecute.{line}")
    with pytest.raises(GradingError, match=rf"c\.WireExecute\.{line.split()[0]} .*a number above zero"):
        tiny.grade()
    assert tiny.scores("ada")[TALKER] == 4


@pytest.mark.parametrize("way", [TinyClass.grade, nbgrader_autograde, nbgrader_generate_feedback])
def test_where_something_is_refused_nothing_is_touched(
    tiny: TinyClass, fake_engine: FakeEngine, way: Callable[[TinyClass], object]
) -> None:
    tiny.submit("ada", 4)
    tiny.grade(feedback=True)
    tiny.submit("ada", 9)
    tiny.configure("c.Execute.timeout = 300")
    page = tiny.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html"
    made = page.stat().st_mtime_ns
    with pytest.raises((GradingError, NbGraderException), match=r"sets c\.Execute\.timeout, .*delete"):
        way(tiny)
    assert tiny.scores("ada")[TALKER] == 4
    assert fake_engine.ran == ["ada"]
    assert page.stat().st_mtime_ns == made


@pytest.mark.parametrize("section", ["Autograde", "GenerateFeedback"])
def test_without_the_lines_that_lead_here_nothing_is_graded(tiny: TinyClass, section: str) -> None:
    config = tiny.path / "nbgrader_config.py"
    config.write_text(config.read_text().replace(f"c.{section}.exporter_class", "unused"))
    tiny.submit("ada")
    with pytest.raises(GradingError, match=rf"does not set c\.{section}\.exporter_class"):
        tiny.grade()
