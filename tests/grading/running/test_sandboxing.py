"""No sandbox, no silent grading."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from autograder import cli
from autograder.boxes import sandbox
from autograder.grading.classes import class_directory
from autograder.grading.classes.class_directory import switch_sandbox_off
from autograder.grading.grading_errors import GradingError
from autograder.grading.running import execution_backends
from autograder.grading.running.execution_backends import UNBOXED_NOTE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tests.grading.tiny_class import FakeEngine, TinyClass

WHY = "bubblewrap is not installed: type this"


@pytest.fixture
def _no_sandbox(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(sandbox, "why_impossible", lambda: WHY)
    yield
    class_directory._unboxed.clear()


@pytest.mark.usefixtures("_no_sandbox")
def test_grading_stops_in_one_line_with_exit_code_2(tiny: TinyClass) -> None:
    tiny.submit("ada", 10)
    done = CliRunner().invoke(cli.cli, ["grade", str(tiny.path)])
    assert done.exit_code == 2
    assert WHY in done.output
    assert "--unsafe-no-sandbox" in done.output
    assert len(done.output.strip().splitlines()) == 1


@pytest.mark.usefixtures("_no_sandbox")
def test_what_was_typed_is_noted_in_the_report_and_in_the_feedback(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    tiny.submit("ada", 10, 7)
    switch_sandbox_off(tiny.path)
    report = tiny.grade(feedback=True)
    assert tiny.scores("ada") == {"lab_1_2-talker": 10, "lab_1_2-listener": 7}
    assert report.note == UNBOXED_NOTE
    page = (tiny.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html").read_text()
    assert UNBOXED_NOTE in page


def test_a_class_of_which_nothing_is_executed_needs_none(
    tiny: TinyClass, fake_engine: FakeEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny.submit("ada", 10)
    tiny.grade()
    monkeypatch.setattr(sandbox, "why_impossible", lambda: WHY)
    assert tiny.grade().reused == 1
    tiny.submit("bob", 7)
    with pytest.raises(GradingError, match=f"cannot be isolated .*{WHY}"):
        tiny.grade()
    assert tiny.scores("ada") == {"lab_1_2-talker": 10, "lab_1_2-listener": 10}


def test_a_result_without_a_sandbox_never_stands_for_one_with(
    tiny: TinyClass, fake_engine: FakeEngine
) -> None:
    tiny.submit("ada", 10)
    switch_sandbox_off(tiny.path)
    assert tiny.grade().executed == 1
    assert tiny.grade().executed == 0
    class_directory._unboxed.clear()
    report = tiny.grade()
    assert (report.executed, report.note) == (1, "")


@pytest.mark.usefixtures("_no_sandbox")
def test_the_configuration_can_say_so_too(tiny: TinyClass) -> None:
    from autograder.grading.classes.class_directory import ClassDirectory

    with pytest.raises(GradingError, match="unsafe_no_sandbox"):
        execution_backends.require_sandbox(ClassDirectory(tiny.path))
    config = tiny.path / "nbgrader_config.py"
    config.write_text(config.read_text() + "\nc.WireExecute.unsafe_no_sandbox = True\n")
    execution_backends.require_sandbox(ClassDirectory(tiny.path))
