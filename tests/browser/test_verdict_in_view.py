"""A verdict is seen without scrolling, and no card says for ever that its check goes on."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import OpenNotebook, look, until

from tests.cases import cases

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

pytestmark = [pytest.mark.browser, pytest.mark.ros, pytest.mark.slow]
BANK = Path(__file__).parents[1] / "submissions/notebooks/lab_1_2.talker"
CHECK = r'^check\("lab_1_2\.talker"'
VIEW = """card => {
    const view = document.querySelector(".jp-WindowedPanel-outer").getBoundingClientRect();
    const inView = part => {
        const box = card.querySelector(part).getBoundingClientRect();
        return box.top >= view.top - 1 && box.bottom <= view.bottom + 1;
    };
    return [inView(".agc-head"), inView(".agc-score"), inView(".agc-advice > p")];
}"""

OVERLAPS = cases(__file__, "OVERLAPS")
"""The words on the course page that a reset button lies on."""
HANGS = """
class TalkerNode(Node):
    def __init__(self):
        super().__init__("talker_node")
        while True:
            pass
"""


def answer(file: str) -> str:
    return (BANK / file).read_text().partition("# %% solution ")[2].partition("\n")[2].strip()


def test_the_verdict_is_seen_and_an_interrupt_and_nothing_lies_on_points(page: Page, lab: str) -> None:
    from playwright.sync_api import expect

    page.set_viewport_size({"width": 1280, "height": 800})
    page.goto(lab.format("lab/tree/01_ros2_fundamentals/lab_1_2.ipynb"))
    notebook = OpenNotebook(page)
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    notebook.run(r"^import time")
    for file, state in (("wrong/topic_name.py", ".agc-failed"), ("right/as_hinted.py", ".agc-passed")):
        notebook.write(r"^class TalkerNode", answer(file))
        notebook.run(r"^class TalkerNode")
        check = notebook.cell(CHECK)
        check.locator(".cm-content").click()
        page.keyboard.press("Shift+Enter")
        card = check.locator(f"{state}:not(.agc-dated)")
        expect(card).to_be_attached()
        until(page, partial(_is_in_view, card))
        look(page, f"after-shift-enter{state}")

    notebook.write(r"^class TalkerNode", HANGS.strip())
    notebook.run(r"^class TalkerNode")
    check = notebook.run(CHECK)
    expect(check.locator(".agc-waiting")).to_contain_text("run 1 of your code")
    page.keyboard.press("i")
    page.keyboard.press("i")
    expect(check.locator(".agc")).to_contain_text("the last one was interrupted")
    expect(check.locator(".agc-waiting")).to_have_count(0)
    look(page, "interrupted")

    page.goto(lab.format("course"))
    expect(page.locator("#reset-lab_1_2")).to_be_attached()
    for width in range(200, 480, 8):
        page.set_viewport_size({"width": width, "height": 900})
        assert page.evaluate(OVERLAPS) == [], f"in a panel of {width} pixels"
    look(page, "panel")


def _is_in_view(card: Locator) -> bool:
    return bool(card.evaluate(VIEW) == [True, True, True])
