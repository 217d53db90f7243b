"""A window of 600 pixels: what has to be reached is in sight or one click away; and hints open by the keyboard."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest

from autograder.grading.returning.page_exporter import PageExporter

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import OpenNotebook, look

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

pytestmark = [pytest.mark.browser, pytest.mark.slow]
WIDTH = 600
SIDE_PANEL = 250
"""Pixels of the panel on the left in a window of 600, in which the same page is shown."""
MOST_TABS = 60
"""Stops of the Tab key from a cell to the hint below it."""
TOO_WIDE = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
ON_TOP = """one => {
    const box = one.getBoundingClientRect();
    const top = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    return one.contains(top);
}"""


def assert_in_sight(one: Locator) -> None:
    box = one.bounding_box()
    assert box is not None
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= WIDTH
    assert one.evaluate(ON_TOP)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [WIDTH, SIDE_PANEL])
def test_the_course_page_fits(page: Page, lab: str, scheme: str, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 900})
    page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    page.goto(lab.format("course"))
    look(page, f"course-{width}-{scheme}")
    assert page.evaluate(TOO_WIDE) <= 0


def test_the_course_panel_gives_its_room_to_the_notebook(page: Page, lab: str) -> None:
    from playwright.sync_api import expect

    page.goto(lab.format("lab/tree/01_ros2_fundamentals/lab_1_2.ipynb"))
    panel = page.locator("#ros2-course-panel")
    expect(panel).to_be_visible()
    page.set_viewport_size({"width": WIDTH, "height": 900})
    expect(panel).to_be_hidden()
    page.set_viewport_size({"width": 1300, "height": 900})
    expect(panel).to_be_visible()

    page.set_viewport_size({"width": WIDTH, "height": 900})
    expect(panel).to_be_hidden()
    page.locator(".jp-SideBar li[data-id='ros2-course-panel']").click()
    expect(panel).to_be_visible()
    page.frame_locator("iframe[title=Course]").locator("#open-lab_1_3").click()
    expect(panel).to_be_hidden()
    expect(page.locator(".jp-NotebookPanel:visible")).to_contain_text("Lab 1.3: A service that adds")
    look(page, "narrow-opened")


@pytest.mark.parametrize("width", [WIDTH, 1100])
def test_the_figures_of_a_feedback_page_fit(page: Page, chapters: Path, tmp_path: Path, width: int) -> None:
    notebook = nbformat.read(chapters / "01_ros2_fundamentals" / "lab_1_2.ipynb", as_version=4)
    for cell in notebook.cells:
        cell.metadata.setdefault("nbgrader", {}).update(score=2.0, points=2.0)
    names = {"notebook": "lab_1_2", "score": 30.0, "max_score": 30.0, "late_penalty": 0.0}
    file = tmp_path / "lab_1_2.html"
    file.write_text(PageExporter().page(notebook, names), encoding="utf-8")
    page.set_viewport_size({"width": width, "height": 900})
    page.goto(file.as_uri())
    look(page, f"feedback-{width}")
    assert page.locator("img").count() > 0
    assert page.evaluate(TOO_WIDE) <= 0


@pytest.mark.ros
def test_validate_stays_in_reach_and_hints_open_by_the_keyboard(page: Page, lab: str) -> None:
    from playwright.sync_api import expect

    page.set_viewport_size({"width": WIDTH, "height": 900})
    page.goto(lab.format("lab/tree/01_ros2_fundamentals/lab_1_2.ipynb"))
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    notebook = OpenNotebook(page)

    notebook.cell(r"^class TalkerNode").locator(".cm-content").click()
    page.keyboard.press("Escape")
    hint = notebook.panel.locator("details", has_text="Where do I begin?").first
    # JupyterLab draws what is out of view only when it has time, and a key finds nothing that is not there.
    expect(hint.locator("summary").first).to_be_visible()
    for _ in range(MOST_TABS):
        page.keyboard.press("Tab")
        if hint.locator("summary").first.evaluate("one => one === document.activeElement"):
            break
    else:
        pytest.fail("no hint was reached with the Tab key")
    page.keyboard.press("Enter")
    look(page, "narrow-hint")
    expect(hint).to_have_attribute("open", "")

    notebook.run(r"^import time")
    notebook.run(r"^class TalkerNode")
    checked = notebook.run(r'^check\("lab_1_2\.talker"')
    card = checked.locator(".agc-failed")
    expect(card).to_contain_text("What to do next")
    card.scroll_into_view_if_needed()
    look(page, "narrow-card")
    assert card.evaluate("one => one.scrollWidth - one.clientWidth") <= 0

    notebook.panel.locator("jp-button[title='More commands'], .jp-Toolbar-responsive-opener").first.click()
    validate = page.get_by_text("Validate", exact=True)
    expect(validate).to_be_visible()
    look(page, "narrow-more")
    assert_in_sight(validate)
    validate.click()
    accept = page.locator(".jp-Dialog .jp-mod-accept")
    expect(accept).to_be_visible()
    look(page, "narrow-validated")
    assert_in_sight(accept)
    content = page.locator(".jp-Dialog-content")
    assert_in_sight(content)
    assert content.locator("pre").evaluate_all("all => all.every(one => one.scrollWidth <= one.clientWidth)")
