"""Lab 1.2 as a student meets it: open, err, read the card, mend, run all, press Validate."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]
TALKER_CHECK = r'^check\("lab_1_2\.talker"'
LISTENER_CHECK = r'^check\("lab_1_2\.listener"'
BANK = Path(__file__).parents[1] / "submissions/notebooks"


def answer(file: str) -> str:
    """What a student types into the solution cell."""
    return (BANK / file).read_text().partition("# %% solution ")[2].partition("\n")[2].strip()


class OpenNotebook:
    """A notebook in JupyterLab, used as by hand."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.panel = page.locator(".jp-NotebookPanel")

    def cell(self, begin: str) -> Locator:
        """The code cell whose text begins so, scrolled to."""
        found = self.panel.locator(
            ".jp-CodeCell", has=self.page.locator(".cm-line", has_text=re.compile(begin))
        )
        found.first.scroll_into_view_if_needed()
        return found.first

    def write(self, begin: str, source: str) -> None:
        """Replace a cell's text."""
        self.cell(begin).locator(".cm-content").click()
        self.page.keyboard.press("Control+A")
        self.page.keyboard.insert_text(source)

    def run(self, begin: str) -> Locator:
        """Run one cell, and give it back."""
        cell = self.cell(begin)
        cell.locator(".cm-content").click()
        self.page.keyboard.press("Control+Enter")
        return cell

    def menu(self, name: str, entry: str) -> None:
        """Choose from the menu bar."""
        self.page.locator(".lm-MenuBar-item", has_text=name).click()
        self.page.get_by_role("menuitem", name=entry, exact=True).click()


def look(page: Page, name: str) -> None:
    """Keep a picture for whoever develops the cards, where ``SCREENSHOTS`` names a folder."""
    if folder := os.environ.get("SCREENSHOTS"):
        page.screenshot(path=Path(folder) / f"{name}.png")


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

    notebook.write(r"^class TalkerNode", answer("lab_1_2.talker/correct/as_hinted.py"))
    notebook.write(r"^class ListenerNode", answer("lab_1_2.listener/correct/as_hinted.py"))
    notebook.menu("Run", "Run All Cells")
    listener = notebook.cell(LISTENER_CHECK)
    expect(listener.locator(".agc-passed")).to_contain_text("10 of 10 points")
    look(page, "listener")
    expect(notebook.cell(TALKER_CHECK).locator(".agc-passed")).to_contain_text("10 of 10 points")
    look(page, "passed")

    notebook.panel.get_by_text("Validate", exact=True).click()
    dialog = page.locator(".jp-Dialog")
    expect(dialog).to_contain_text("Success! Your notebook passes all the tests.")
    look(page, "validated")
