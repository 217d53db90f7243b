"""Lab 1.2 as a student meets it: open, err, read the card, mend, run all, press Validate."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import OpenNotebook, look

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]
TALKER_CHECK = r'^check\("lab_1_2\.talker"'
LISTENER_CHECK = r'^check\("lab_1_2\.listener"'
PROGRAMS_CHECK = r'^check\("lab_1_2\.programs"'
PACKAGE = "src/my_robot_pkg/my_robot_pkg"
ENTRY_POINTS = """entry_points = [
    "talker = my_robot_pkg.talker:main",
    "listener = my_robot_pkg.listener:main",
]
print(add_entry_points("ros2_ws", entry_points))"""
BANK = Path(__file__).parents[1] / "submissions/notebooks"


def answer(file: str) -> str:
    """What a student types into the solution cell."""
    return (BANK / file).read_text().partition("# %% solution ")[2].partition("\n")[2].strip()


def solution(exercise: str) -> str:
    """The course's own solution cell of an exercise."""
    file = Path(__file__).parents[2] / f"solutions/01_ros2_fundamentals/lab_1_2/{exercise}.solution.json"
    return str(json.loads(file.read_text(encoding="utf-8"))["code"][0])


def program(name: str) -> str:
    """The cell that writes a program of the package."""
    file = Path(__file__).parents[2] / "solutions/ros2_ws" / PACKAGE / f"{name}.py"
    return f"%%writefile ros2_ws/{PACKAGE}/{name}.py\n{file.read_text()}"


def test_a_student_errs_reads_the_card_mends_it_and_validates(page: Page, lab: str) -> None:
    from playwright.sync_api import expect

    page.goto(lab.format("lab/tree/01_ros2_fundamentals/lab_1_2.ipynb"))
    notebook = OpenNotebook(page)
    # Shown only when the kernel has answered; what is run before that can get lost.
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    start = notebook.run(r"^import time")
    expect(start).to_contain_text(re.compile(r"ROS 2 is up on domain \d+\."))
    # The session's domain, exported by `autograder lab`: else the kernel would have picked one, and say so.
    expect(start).not_to_contain_text("To join it from a terminal")
    expect(page.locator(".jp-Dialog")).to_have_count(0)
    expect(page.locator(".lm-MenuBar-item", has_text="Nbgrader")).to_have_count(0)
    look(page, "start")

    notebook.write(r"^class TalkerNode", answer("lab_1_2.talker/wrong/topic_name.py"))
    notebook.run(r"^class TalkerNode")
    checked = notebook.run(TALKER_CHECK)
    expect(checked).to_contain_text("NOT YET")
    expect(checked).to_contain_text("What to do next")
    expect(checked.locator(".agc-advice")).to_contain_text("chater")
    look(page, "not-yet")

    notebook.write(r"^class TalkerNode", answer("lab_1_2.talker/right/as_hinted.py"))
    notebook.write(r"^class ListenerNode", answer("lab_1_2.listener/right/as_hinted.py"))
    notebook.write(r"^class Careful", solution("wall"))
    notebook.write(r"^class Reporter", solution("rooms"))
    for name in ("talker", "listener"):
        notebook.write(rf"^%%(?:writefile|program) .*/{name}\.py", program(name))
    notebook.write(r"^entry_points = ", ENTRY_POINTS)
    notebook.menu("Run", "Run All Cells")
    listener = notebook.cell(LISTENER_CHECK)
    expect(listener.locator(".agc-passed")).to_contain_text("10 of 10 points")
    look(page, "listener")
    passed = notebook.cell(TALKER_CHECK).locator(".agc-passed")
    expect(passed).to_contain_text("10 of 10 points")
    passed.evaluate("card => card.scrollIntoView()")
    look(page, "passed")

    programs = notebook.cell(PROGRAMS_CHECK)
    expect(programs.locator(".agc-passed")).to_contain_text("10 of 10 points")
    programs.locator(".agc-solution summary").click()
    expect(programs.locator(".agc-solution")).to_contain_text("Another way.")
    look(page, "programs")

    notebook.panel.get_by_text("Validate", exact=True).click()
    dialog = page.locator(".jp-Dialog")
    expect(dialog).to_contain_text("Success! Your notebook passes all the tests.")
    look(page, "validated")
