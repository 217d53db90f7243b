"""A notebook in JupyterLab, used as by hand."""

from __future__ import annotations

import contextlib
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from playwright.sync_api import Browser, Locator, Page

LIMIT = 180.0
"""Seconds after which a test gives up waiting for something that a quiet machine shows within ten."""


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
        if not found.first.is_visible():  # JupyterLab hides a cell far above the view until somebody scrolls
            self.panel.locator(".jp-WindowedPanel-outer").first.evaluate("one => one.scrollTo(0, 0)")
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


@contextlib.contextmanager
def opened_page(browser: Browser) -> Iterator[Page]:
    """An empty page of a browser that knows nothing of any page before."""
    context = browser.new_context(viewport={"width": 1300, "height": 1000})
    context.set_default_timeout(LIMIT * 1000)
    page = context.new_page()
    yield page
    look(page, "end")
    context.close()


def look(page: Page, name: str) -> None:
    """Keep a picture, and the words of the page, where ``SCREENSHOTS`` names a folder."""
    if folder := os.environ.get("SCREENSHOTS"):
        page.screenshot(path=Path(folder) / f"{name}.png")
        words = [frame.locator("body").inner_text() for frame in page.frames]
        (Path(folder) / f"{name}.txt").write_text("\n".join(words), encoding="utf-8")


def until(page: Page, holds: Callable[[], bool]) -> None:
    """Wait until something holds that no page shows, such as that a file is there."""
    for _ in range(int(LIMIT * 10)):
        if holds():
            return
        page.wait_for_timeout(100)
    raise AssertionError("it has not come to hold")
