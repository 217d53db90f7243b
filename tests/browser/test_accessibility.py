"""Cards, the course page and the side panel by the rules of axe-core, light and dark, and by the keyboard alone."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder import check_journal, exercises
from autograder.cards.html_rendering import card_html, waiting_bundle
from autograder.check_journal import JournalEntry
from autograder.verdict import from_json

sys.path.insert(0, str(Path(__file__).parent))
from findings import grave_findings
from open_notebook import OpenNotebook, look

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

pytestmark = [pytest.mark.browser, pytest.mark.slow]
VERDICTS = sorted((Path(__file__).parents[1] / "cards/verdicts").glob("*.json"))
BANK = Path(__file__).parents[1] / "submissions/notebooks/lab_1_2.talker"
MOST_TABS = 200
"""Stops of the Tab key within which everything is reached."""
light_and_dark = pytest.mark.parametrize("scheme", ["light", "dark"])


@light_and_dark
def test_cards(page: Page, scheme: str) -> None:
    page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    cards = [waiting_bundle("The talker", "Checking: run 1 of your code …")["text/html"]]
    for path in VERDICTS:
        verdict = from_json(path.read_bytes())
        cards += [
            card_html(verdict, before=3.0),
            card_html(verdict, notice="This check is out of date."),
            card_html(replace(verdict, title=f"{verdict.title} in short"), short=True),
        ]
    body = "\n".join(f"<div>{card}</div>" for card in cards)
    page.set_content(
        '<!DOCTYPE html><html lang="en"><head><title>Cards</title><style>:root { color-scheme: light dark; }'
        f"</style></head><body><main><h1>Cards</h1><h2>Of all kinds</h2>{body}</main></body></html>"
    )
    page.evaluate("document.querySelectorAll('details').forEach(one => { one.open = true; })")
    look(page, f"cards-{scheme}")
    assert grave_findings(page) == []


def note_points(chapters: Path, share: float) -> None:
    """Note checks of every other exercise, or of all, with a share of their points."""
    names = exercises.all_ids()
    for exercise in names if share == 1 else names[::2]:
        possible = exercises.get(exercise).points
        assert check_journal.note(
            JournalEntry("check", exercise, 1, share * possible, possible), chapters / check_journal.NAME
        )


def answer(file: str) -> str:
    """What a student types into the solution cell."""
    return (BANK / file).read_text().partition("# %% solution ")[2].partition("\n")[2].strip()


def tab_to(page: Page, target: Locator) -> None:
    """Press Tab until the target has the keyboard."""
    for _ in range(MOST_TABS):
        page.keyboard.press("Tab")
        if target.evaluate("one => one === one.ownerDocument.activeElement"):
            return
    pytest.fail(f"{target} was not reached with {MOST_TABS} stops of the Tab key")


@light_and_dark
def test_the_course_page(page: Page, lab: str, chapters: Path, scheme: str) -> None:
    from playwright.sync_api import expect

    (chapters / check_journal.NAME).unlink(missing_ok=True)
    page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    page.goto(lab.format("course"))
    assert grave_findings(page) == []
    for share in (0.5, 1.0):
        note_points(chapters, share)
        page.reload()
        assert grave_findings(page) == []
    page.locator(".reset").first.focus()
    page.keyboard.press("Enter")
    expect(page.locator("#ask")).to_be_visible()
    look(page, f"course-{scheme}")
    assert grave_findings(page, "#ask") == []


@pytest.mark.ros
@light_and_dark
def test_the_side_panel_and_a_card_in_jupyterlab_by_the_keyboard(
    page: Page, lab: str, chapters: Path, scheme: str
) -> None:
    from playwright.sync_api import expect

    (chapters / check_journal.NAME).unlink(missing_ok=True)
    # As a student who stopped in Lab 1.2: "Continue" leads there.
    for lab_before in ("00_nervous_system", "lab_1_1"):
        for exercise in exercises.all_ids():
            if exercise.startswith(f"{lab_before}."):
                points = exercises.get(exercise).points
                check_journal.note(
                    JournalEntry("check", exercise, 1, points, points), chapters / check_journal.NAME
                )
    page.goto(lab.format("lab"))
    panel = page.frame_locator("iframe[title=Course]")
    expect(panel.locator("#continue")).to_contain_text("Lab 1.2")
    if scheme == "dark":
        # JupyterLab sets the attribute once its own theme is loaded, and would set it again.
        expect(page.locator("body")).to_have_attribute("data-jp-theme-light", "true")
        page.evaluate("document.body.dataset.jpThemeLight = 'false'")
        expect(panel.locator("html")).to_have_attribute("data-theme", "dark")
    frame = next(one for one in page.frames if one.url.endswith("/course"))
    assert grave_findings(frame) == []
    tab_to(page, panel.locator("#continue"))
    page.keyboard.press("Enter")
    notebook = OpenNotebook(page)
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    expect(notebook.panel.locator(".jp-Cell").first).to_be_visible()
    if scheme == "dark":
        return

    notebook.run(r"^import time")
    notebook.write(r"^class TalkerNode", answer("wrong/topic_name.py"))
    notebook.run(r"^class TalkerNode")
    checked = notebook.run(r'^check\("lab_1_2\.talker"')
    expect(checked.locator(".agc-failed")).to_contain_text("What to do next")
    assert grave_findings(page, ".agc") == []
    page.keyboard.press("Escape")
    table = checked.locator("summary", has_text=re.compile("^The traffic as a table"))
    tab_to(page, table)
    page.keyboard.press("Enter")
    expect(checked.locator(".agc-moments")).to_be_visible()
    look(page, "keyboard")
