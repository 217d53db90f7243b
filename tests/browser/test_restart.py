"""A kernel that starts again: what Check does then, and the card of a check that ended with its kernel."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest

from autograder.cards.html_rendering import card_bundle, waiting_bundle
from autograder.verdict import CriterionResult, State, Verdict

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import OpenNotebook, look, opened_page

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Page

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]
IDLE = "Python 3 (ipykernel) | Idle"
CHECK = r'^check\("lab_1_2\.talker"'
SLOW = """
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        while True:
            time.sleep(0.1)
"""

CRASHES = """
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        time.sleep(1.0)
        os.abort()
"""


def restart(page: Page) -> None:
    page.locator(".lm-MenuBar-item", has_text="Kernel").click()
    page.locator(".lm-Menu-itemLabel").get_by_text("Restart Kernel…", exact=True).click()
    page.locator(".jp-Dialog .jp-mod-accept").click()


@pytest.fixture(scope="module")
def page(browser: Browser, server: str, chapters: Path) -> Iterator[Page]:
    """The notebook of lab 1.2, opened once; it was saved while a check of its listener went on."""
    file = chapters / "01_ros2_fundamentals" / "lab_1_2.ipynb"
    notebook = nbformat.read(file, as_version=4)
    cell = next(one for one in notebook.cells if one.source.startswith('check("lab_1_2.listener"'))
    data = waiting_bundle("lab_1_2.listener", "Checking: run 2 of your code, 3.0 s …")
    cell.outputs = [nbformat.v4.new_output("display_data", data)]
    cell = next(one for one in notebook.cells if one.source.startswith('check("lab_1_2.wall"'))
    to_come = CriterionResult("stops", "Stops", 10.0, None, "", "")
    so_far = Verdict("lab_1_2.wall", "The wall", State.CHECKING, 0.0, 10.0, (to_come,))
    data = card_bundle(so_far, notice="Checking: run 1 of your code, 9.41 s …")
    cell.outputs = [nbformat.v4.new_output("display_data", data)]
    file.write_text(nbformat.writes(notebook), encoding="utf-8")
    with opened_page(browser) as page:
        page.goto(server.format("lab/tree/01_ros2_fundamentals/lab_1_2.ipynb"))
        yield page


def test_a_card_that_was_saved_while_its_check_went_on_says_so(page: Page) -> None:
    from playwright.sync_api import expect

    for exercise in ("listener", "wall"):
        card = OpenNotebook(page).cell(rf'^check\("lab_1_2\.{exercise}"').locator(".agc")
        expect(card).to_contain_text("The notebook was closed during this check")
        expect(card).not_to_contain_text("Checking")
        expect(card).not_to_contain_text("TO COME")
    look(page, "closed-during-its-check")


def test_check_runs_what_a_new_kernel_lacks_and_a_card_ends_with_its_kernel(page: Page) -> None:
    from playwright.sync_api import expect

    notebook = OpenNotebook(page)
    expect(page.locator("#jp-main-statusbar")).to_contain_text(IDLE)
    notebook.write(r"^class TalkerNode", SLOW.strip())

    checked = notebook.run(CHECK)
    expect(checked).to_contain_text("there is no check yet. This kernel is new")
    checked.locator(".jp-cell-toolbar").get_by_text("Check", exact=True).click()
    expect(page.locator(".Toastify")).to_contain_text("the cells above that the check needs run first")
    expect(checked.locator(".agc-waiting")).to_contain_text("Checking")

    restart(page)
    expect(checked.locator(".agc")).to_contain_text("The kernel ended during this check")
    expect(checked.locator(".agc-waiting")).to_have_count(0)
    look(page, "ended-with-its-kernel")

    expect(page.locator("#jp-main-statusbar")).to_contain_text(IDLE)
    checked.locator(".jp-cell-toolbar").get_by_text("Check", exact=True).click()
    expect(checked.locator(".agc-failed")).to_contain_text("What to do next")
    expect(notebook.cell(r"^import time")).to_contain_text(re.compile(r"ROS 2 is up"))


def test_a_check_that_ends_its_kernel_again_names_the_cell_to_look_at(page: Page) -> None:
    from playwright.sync_api import expect

    notebook = OpenNotebook(page)
    notebook.write(r"^class TalkerNode", f"import os\n{CRASHES}")
    for words in ("so there is no result: check again", "Look at the cell that defines TalkerNode"):
        expect(page.locator("#jp-main-statusbar")).to_contain_text(IDLE)
        checked = notebook.cell(CHECK)
        checked.click()
        checked.locator(".jp-cell-toolbar").get_by_text("Check", exact=True).click()
        # The card that says "Checking" may be gone again before anything can look at it. It is that of the check's cell
        # or, where the class of before is still watched, the one below the class.
        expect(notebook.panel.locator(".agc-over", has_text=words).first).to_be_attached()
        page.get_by_role("button", name="Ok", exact=True).click()
        look(page, f"ended-with-its-kernel-{words.split()[0].lower()}")
