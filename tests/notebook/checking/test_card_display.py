"""One place for a check's card, as a notebook keeps it: nbclient applies updates as JupyterLab does."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, Any

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook
from nbgrader.validator import Validator

from autograder.notebook.checking import card_display
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

# A judge whose verdicts are known: the next of `scores`, after what `meanwhile` does.
JUDGE = cases(__file__, "JUDGE")


@pytest.fixture
def run(
    run_in_one_kernel: Callable[..., list[Any]], request: pytest.FixtureRequest
) -> Callable[..., list[Any]]:
    """Run cells below JUDGE, with an exercise of the test's own; what each shows in the end."""

    def below(*sources: str, **options: bool) -> list[Any]:
        own = [re.sub("""(['"])lab(['"])""", rf"\1lab.{request.function.__name__}\2", one) for one in sources]
        return run_in_one_kernel(JUDGE, *own, **options)[1:]

    return below


def test_the_value_of_a_check_is_for_nbgrader_and_shows_nothing(run: Callable[..., list[Any]]) -> None:
    (outputs,) = run("scores[:] = [7.5]; check('lab', Talker)")
    card, value = outputs
    assert value.data["text/plain"] == "7.5"
    assert "7.5" not in value.data["text/html"]
    assert "7.5 of 10 points" in card.data["text/plain"]


def test_another_try_tells_the_points_of_the_one_before(run: Callable[..., list[Any]]) -> None:
    _, (card, _) = run("scores[:] = [5.0, 8.0]; check('lab', Talker)", "check('lab', Talker)")
    assert "8 of 10 points, 5 before" in card.data["text/plain"]
    assert "5 → <strong>8</strong>" in card.data["text/html"]


def test_while_a_check_goes_on_its_card_says_so_and_shows_no_earlier_diagnosis(
    run: Callable[..., list[Any]],
) -> None:
    """What stood there meanwhile is taken from the display itself, at the moment at which the check was going on."""
    watched = """
def meanwhile(progress):
    progress.doing("building my_package")
    import time
    while not any("building" in text for text in shown):
        time.sleep(0.01)

scores[:] = [5.0]
check("lab", Talker)
"""
    first, second, said = run(
        watched,
        "scores[:] = [8.0]; shown.clear(); check('lab', Talker)",
        "print(next(text for text in shown if 'building' in text))",
    )
    assert [output.output_type for output in first] == ["display_data", "execute_result"]
    assert [output.output_type for output in second] == ["display_data", "execute_result"]
    assert "Checking" not in second[0].data["text/plain"]
    assert "8 of 10" in second[0].data["text/plain"]
    meanwhile = " ".join(said[0].text.split())
    assert "The talker: Checking: building my_package" in meanwhile
    assert "It says b." not in meanwhile, "that was the answer before"


def test_what_a_long_check_knows_is_of_the_new_code_alone(run: Callable[..., list[Any]]) -> None:
    again = """
def meanwhile(progress):
    import time
    progress.known = "So far: it says nothing."
    while not any("it says nothing" in text for text in shown):
        time.sleep(0.01)
card_display.LONG = 0.0
shown.clear()
check("lab", Talker)
"""
    *_, said = run("scores[:] = [5.0, 8.0]; check('lab', Talker)", again, "print(*shown[:-1])")
    assert "So far: it says nothing." in said[0].text
    assert "It says b." not in said[0].text, "that was the answer before"


def test_a_quick_check_finds_the_card_of_the_one_before_marked_as_such(run: Callable[..., list[Any]]) -> None:
    first = "scores[:] = [5.0, 8.0]; check('lab', Talker)"
    *_, said = run(first, "check('lab', Talker)", "print(begun[-1])")
    assert "this is the result of the previous check" in " ".join(said[0].text.split())


def test_an_interrupted_check_ends_on_its_card(run: Callable[..., list[Any]]) -> None:
    _, (card, *_) = run(
        "meanwhile = interrupted", "try:\n    check('lab', Talker)\nexcept KeyboardInterrupt:\n    pass"
    )
    assert "Checking" not in card.data["text/plain"]
    assert "The check was interrupted, so there is no result" in card.data["text/plain"]
    assert "agc-waiting" not in card.data["text/html"].partition("<style>")[0]


def test_an_interrupt_is_on_the_card_before_the_code_has_been_stopped(run: Callable[..., list[Any]]) -> None:
    interrupted = """
shown = []
usual = card_display.html_rendering.waiting_bundle
def waiting_bundle(title, words, **how):
    shown.append(words)
    return usual(title, words, **how)
card_display.html_rendering.waiting_bundle = waiting_bundle

def meanwhile(progress):
    import time
    progress.interrupt()
    while not any("The check was interrupted. It ends as soon as" in words for words in shown):
        time.sleep(0.01)
scores[:] = [5.0]
"""
    assert run(interrupted, "check('lab', Talker); card_display.html_rendering.waiting_bundle = usual")


def test_another_interrupt_does_not_leave_a_card_that_goes_on(run: Callable[..., list[Any]]) -> None:
    interrupted = """
meanwhile = interrupted

class Interrupted(card_display.ProgressUpdater):
    def stop(self):
        super().stop()
        raise KeyboardInterrupt
card_display.ProgressUpdater = Interrupted
"""
    _, (card, *_) = run(interrupted, "try:\n    check('lab', Talker)\nexcept KeyboardInterrupt:\n    pass")
    assert "The check was interrupted, so there is no result" in card.data["text/plain"]


def test_an_interrupted_check_shows_none_of_its_own_lines(run: Callable[..., list[Any]]) -> None:
    interrupted = "def meanwhile(progress):\n    raise KeyboardInterrupt"
    *_, (error,) = run(interrupted, "check('lab', Talker)", allow_errors=True)
    assert error.traceback == ["KeyboardInterrupt"]


def test_after_half_a_minute_a_check_says_what_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "getloadavg", lambda: (4000.0, 1.0, 1.0))
    progress = card_display.Progress("run 2", "So far: “It says b.”")
    assert progress.words().startswith("Checking: run 2")
    assert "It says b." not in progress.words()
    progress.began -= card_display.LONG
    assert "The machine is busy" in progress.words()
    assert "It says b." in progress.words()


def test_a_card_is_dimmed_when_its_class_is_defined_anew(run: Callable[..., list[Any]]) -> None:
    (card, _), _, _ = run("scores[:] = [5.0]; check('lab', Talker)", "x = 1", "class Talker:\n    pass")
    assert "agc-dated" in card.data["text/html"].partition("<style>")[0]
    assert "Talker has changed since this check" in card.data["text/plain"]


def test_a_card_stays_as_it_is_while_its_class_is_the_same(run: Callable[..., list[Any]]) -> None:
    (card, _), _ = run("scores[:] = [5.0]; check('lab', Talker)", "x = Talker()")
    assert "agc-dated" not in card.data["text/html"].partition("<style>")[0]
    assert "has changed" not in card.data["text/plain"]


@pytest.mark.usefixtures("as_in_a_notebook")
def test_validate_says_what_the_card_says(tmp_path: Path) -> None:
    checks = ("scores[:] = [0.0, 10.0]\ncheck('lab_1_2.talker', Talker)", "check('lab_1_2.listener', Talker)")
    notebook = new_notebook(cells=[new_code_cell(source) for source in (JUDGE, *checks)])
    for cell, name in zip(notebook.cells[1:], ("talker", "listener"), strict=True):
        cell.metadata["nbgrader"] = {
            "grade": True, "grade_id": name, "locked": False, "points": 10, "schema_version": 3,
            "solution": False, "task": False, "cell_type": "code",
        }  # fmt: skip
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    path = tmp_path / "lab.ipynb"
    nbformat.write(notebook, path)
    failed = Validator().validate(str(path))["failed"]
    assert len(failed) == 1, "the cell with full marks passes"
    error = " ".join(failed[0]["error"].split())
    assert "Partial credit" not in error
    assert "The talker: Not yet, 0 of 10 points" in error
    assert "[ ] Says the right string (0 of 10 points)" in error
    assert "Say a." in error
