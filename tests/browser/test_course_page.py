"""The way in: the course page, a notebook, a check, the tick in the side panel, the notebook begun anew, the end."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import check_journal, exercises
from autograder.check_journal import JournalEntry
from tests.browser.open_notebook import look

if TYPE_CHECKING:
    from collections.abc import Sequence

    from playwright.sync_api import FrameLocator, Locator, Page

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]
ROOT = Path(__file__).resolve().parents[2]
BANK = ROOT / "tests/submissions/notebooks"
NOTEBOOK = "01_ros2_fundamentals/lab_1_2.ipynb"


def cell(page: Page, begin: str) -> Locator:
    """The code cell whose text begins so."""
    lines = page.locator(".cm-line", has_text=re.compile(begin))
    return page.locator(".jp-NotebookPanel .jp-CodeCell", has=lines).first


def run(page: Page, begin: str, source: str | None = None) -> Locator:
    """Run a cell, with another text where one is given."""
    found = cell(page, begin)
    found.scroll_into_view_if_needed()
    found.locator(".cm-content").click()
    if source is not None:
        page.keyboard.press("Control+A")
        page.keyboard.insert_text(source)
    page.keyboard.press("Control+Enter")
    return found


def row(place: Page | FrameLocator, name: str) -> Locator:
    """The notebook's line in the map."""
    return place.locator(f'[data-notebook="{name}"]')


def all_but(here: Sequence[str], chapters: Path) -> None:
    """Note checks with all points, but for those exercises that are checked here."""
    for exercise in exercises.all_ids():
        points = exercises.get(exercise).points
        if exercise not in here:
            assert check_journal.note(
                JournalEntry("check", exercise, 1, points, points), chapters / check_journal.NAME
            )


def test_page_notebook_check_tick_reset_end(page: Page, lab: str, chapters: Path) -> None:
    from playwright.sync_api import expect

    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(lab.format(""))
    address = page.url.partition("course")[0]
    expect(page.locator("h1")).to_have_text("Course")
    expect(page.locator(".sum").first).to_contain_text(re.compile(r"0 of \d+ points"))
    # By the keyboard alone: the first stop is the button that leads on.
    page.keyboard.press("Tab")
    expect(page.locator("#continue")).to_be_focused()
    first = row(page, "00_nervous_system")
    expect(first).to_have_class(re.compile("next"))

    page.locator("#open-lab_1_2").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    panel = page.frame_locator("iframe[title=Course]")
    expect(row(panel, "lab_1_2")).to_contain_text("0 of 50 points")
    for begin, bank in (
        (r"^class TalkerNode", "lab_1_2.talker"),
        (r"^class ListenerNode", "lab_1_2.listener"),
    ):
        run(page, r"^import time")
        answer = (BANK / bank / "right/as_hinted.py").read_text().partition("# %% solution ")[2]
        run(page, begin, answer.partition("\n")[2].strip())
        card = run(page, rf'^check\("{re.escape(bank)}"')
        expect(card.locator(".agc-passed")).to_contain_text("10 of 10 points")
        if bank == "lab_1_2.talker":
            expect(row(panel, "lab_1_2")).to_contain_text("The talker 10/10")
            look(page, "course-panel")
            all_but(("lab_1_2.talker", "lab_1_2.listener"), chapters)
    expect(row(panel, "lab_1_2")).to_have_class(re.compile("done"))
    expect(row(panel, "lab_1_2")).to_contain_text("50 of 50 points")
    # The last check of the chapter: the certificate stands below its card and on the page.
    expect(card.locator(".agc-certificate svg")).to_be_visible()
    expect(panel.locator(".certificate").first).to_contain_text("It is not a grade.")
    card.locator(".agc-certificate svg").scroll_into_view_if_needed()
    look(page, "certificate")

    # Reset from the panel saves what is open, keeps it, and shows the released notebook in the same tab.
    # By the keyboard: the question begins on Cancel, and one is back where one was.
    panel.locator("#reset-lab_1_2").focus()
    page.keyboard.press("Enter")
    expect(panel.get_by_role("button", name="Cancel", exact=True)).to_be_focused()
    page.keyboard.press("Escape")
    expect(panel.locator("#reset-lab_1_2")).to_be_focused()
    expect(row(panel, "lab_1_2")).to_have_class(re.compile("done"))
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    expect(panel.get_by_role("button", name="Reset", exact=True)).to_be_focused()
    page.keyboard.press("Enter")
    expect(panel.locator("#said")).to_contain_text("Yours is kept: lab_1_2 (your copy, ")
    expect(row(panel, "lab_1_2")).to_contain_text("0 of 50 points")
    expect(cell(page, r"^class TalkerNode")).to_contain_text("TODO")
    (copy,) = (chapters / NOTEBOOK).parent.glob("lab_1_2 (your copy*")
    assert "Hello, world!" in copy.read_text()
    assert (chapters / NOTEBOOK).read_bytes() == (ROOT / "chapters" / NOTEBOOK).read_bytes()

    # A notebook from the panel opens beside the others, in the same tab of the browser. The panel marks the open one,
    # and scrolls to it.
    expect(panel.locator("[aria-current]")).to_have_id("open-lab_1_2")
    panel.locator("#open-lab_2_3").click()
    expect(page.locator(".jp-NotebookPanel:not(.lm-mod-hidden)")).to_contain_text("Python that waits")
    expect(panel.locator("[aria-current]")).to_have_id("open-lab_2_3")
    look(page, "course-panel-chapter-2")
    page.get_by_role("tab", name="lab_1_2.ipynb").click()
    expect(panel.locator("[aria-current]")).to_have_id("open-lab_1_2")
    expect(panel.locator("#open-lab_1_2")).to_be_in_viewport()
    expect(panel.locator("#open-lab_2_3")).not_to_be_in_viewport()

    # The chapter that was begun anew has no certificate, and the other one still has its own.
    expect(panel.locator(".certificate")).to_have_count(1)
    all_but("", chapters)
    expect(panel.locator(".certificate")).to_have_count(2)
    expect(panel.locator(".certificate").first).to_contain_text("It is not a grade.")
    page.goto(f"{address}course")
    with page.expect_download() as download:
        page.get_by_role("link", name="Save it as a picture").first.click()
    assert "not a grade" in Path(download.value.path()).read_text()
    assert [url for url in asked if not url.startswith((address, "data:", "blob:", "attachment:"))] == []


def test_nobody_without_the_servers_token_reads_or_resets(page: Page, lab: str, chapters: Path) -> None:
    address = lab.format("").partition("?")[0]
    assert "login" in page.request.get(f"{address}course").url
    before = (chapters / NOTEBOOK).read_bytes()
    refused = page.request.post(f"{address}course/reset", data={"notebook": "lab_1_2"})
    assert refused.status == 403
    # A page of somebody else's that the student has open besides: it has the cookie, and not the page's own token.
    page.goto(lab.format(""))
    refused = page.request.post(f"{address}course/reset", data={"notebook": "lab_1_2"})
    assert (refused.status, (chapters / NOTEBOOK).read_bytes()) == (403, before)
