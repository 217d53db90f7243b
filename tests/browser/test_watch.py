"""Watch mode and the buttons as a student uses them, with the real judge."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import check_journal
from autograder.check_journal import JournalEntry

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import OpenNotebook, look

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]
BANK = Path(__file__).parents[1] / "submissions/notebooks/lab_1_2.talker"
WATCH = 'from autograder.notebook import watch\nwatch("lab_1_2.talker", TalkerNode)'


def answer(file: str) -> str:
    """What a student types into the solution cell."""
    return (BANK / file).read_text().partition("# %% solution ")[2].partition("\n")[2].strip()


def with_a_wrong_talker(page: Page, lab: str) -> OpenNotebook:
    """Lab 1.2, with ROS up and a talker on another topic, whose cell was not run yet."""
    from playwright.sync_api import expect

    page.goto(lab.format("lab/tree/01_ros2_fundamentals/lab_1_2.ipynb"))
    notebook = OpenNotebook(page)
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    expect(notebook.run(r"^import time")).to_contain_text(re.compile(r"ROS 2 is up"))
    notebook.write(r"^class TalkerNode", answer("wrong/topic_name.py"))
    return notebook


def test_each_run_of_the_cell_shows_one_short_card_below_it(page: Page, lab: str) -> None:
    from playwright.sync_api import expect

    notebook = with_a_wrong_talker(page, lab)
    defined = notebook.run(r"^class TalkerNode")
    # A cell of the student's own, below it.
    page.keyboard.press("Escape")
    page.keyboard.press("b")
    page.keyboard.press("Enter")
    page.keyboard.insert_text(WATCH)
    page.keyboard.press("Control+Enter")
    expect(notebook.cell(r"^watch\(")).to_contain_text(
        "TalkerNode is checked again whenever its cell is run."
    )
    expect(defined.locator(".agc")).to_have_count(0)

    notebook.run(r"^class TalkerNode")
    expect(defined.locator(".agc-failed")).to_contain_text("chater")
    expect(defined.locator(".agc")).to_have_count(1)
    expect(defined.locator(".agc-table")).to_have_count(0)
    look(page, "watched-not-yet")

    notebook.write(r"^class TalkerNode", answer("right/as_hinted.py"))
    notebook.run(r"^class TalkerNode")
    expect(defined.locator(".agc-passed")).to_contain_text("10 of 10 points")
    expect(defined.locator(".agc")).to_have_count(1)
    look(page, "watched-passed")


def test_a_task_is_done_with_the_buttons_alone(page: Page, lab: str) -> None:
    from playwright.sync_api import expect

    notebook = with_a_wrong_talker(page, lab)
    defined, checked = notebook.cell(r"^class TalkerNode"), notebook.cell(r'^check\("lab_1_2.talker"')
    look(page, "buttons-of-a-cell")
    defined.locator(".jp-cell-toolbar").get_by_text("Check", exact=True).click()
    expect(checked.locator(".agc-failed")).to_contain_text("chater")
    expect(checked.locator(".agc-acts")).to_be_visible()
    look(page, "buttons-of-a-card")

    # From now on the class is checked again as soon as its cell has run.
    notebook.write(r"^class TalkerNode", answer("right/as_hinted.py"))
    notebook.run(r"^class TalkerNode")
    expect(defined.locator(".agc-passed")).to_contain_text("10 of 10 points")
    checked.locator(".agc-acts").get_by_role("button", name="Check again").click()
    expect(checked.locator(".agc-passed")).to_contain_text("10 of 10")
    look(page, "buttons-passed")
    checked.locator(".agc-acts").get_by_role("button", name="Watch").click()
    expect(page.locator(".Toastify")).to_contain_text("TalkerNode is no longer checked automatically.")
    # The kernel, and what was chosen in it, outlives this page.
    checked.locator(".agc-acts").get_by_role("button", name="Watch").click()
    expect(page.locator(".Toastify")).to_contain_text("TalkerNode is checked again whenever its cell is run.")
    checked.locator(".agc-acts").get_by_role("button", name="Next task").click()
    expect(page.locator(".jp-Cell.jp-mod-active")).to_contain_text("class ListenerNode")


def test_after_the_last_hint_and_enough_failures_a_button_opens_the_worked_solution(
    page: Page, lab: str, chapters: Path
) -> None:
    from playwright.sync_api import expect

    journal = chapters / check_journal.NAME
    # A pass of an earlier test of this module would count as reached without the solution.
    journal.unlink(missing_ok=True)
    for code in "abcde":
        check_journal.note(JournalEntry("check", "lab_1_2.talker", 1, 0, 10, code), journal)
    notebook = with_a_wrong_talker(page, lab)
    notebook.run(r"^class TalkerNode")
    checked = notebook.run(r'^check\("lab_1_2.talker"')
    opens = checked.get_by_role("button", name="Open the worked solution")
    expect(opens).to_be_visible()
    look(page, "worked-offered")
    opens.click()
    expect(page.locator(".Toastify")).to_contain_text("Open the last hint of this task first")
    look(page, "worked-hints-first")
    for number in (1, 2, 3):
        notebook.panel.locator("summary", has_text=f"Hint {number} of 3.").click()
    opens.click()
    solution = checked.locator(".agc-solution[open]")
    expect(solution).to_contain_text("self.create_timer(0.5, self.say_hello)")
    expect(opens).to_have_count(0)
    solution.scroll_into_view_if_needed()
    look(page, "worked-opened")
    assert check_journal.entries(journal)[-1].kind == "solution"

    # It stays on the card while the student writes.
    notebook.write(r"^class TalkerNode", answer("right/as_hinted.py"))
    notebook.run(r"^class TalkerNode")
    expect(checked.locator(".agc-passed")).to_contain_text("10 of 10 points")
    expect(checked.locator(".agc-solution")).to_contain_text("self.create_timer(0.5, self.say_hello)")
    panel = page.frame_locator("iframe[title=Course]")
    expect(panel.locator('[data-notebook="lab_1_2"]')).to_contain_text("1 task with the worked solution")
    look(page, "worked-passed")
