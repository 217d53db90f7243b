"""The commands of a notebook's text, opened in terminals of JupyterLab."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import OpenNotebook, look, until

from tests.cases import cases

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = [pytest.mark.browser, pytest.mark.slow]
TEXT = cases(__file__, "TEXT")


@pytest.fixture
def folder(chapters: Path) -> Path:
    """The chapter of a notebook with three blocks of code in its text."""
    cells = [
        new_code_cell("pass", metadata={"nbgrader": {"grade_id": "given-set-up"}}),
        new_markdown_cell(TEXT),
        new_code_cell("import os; print('domain', os.environ['ROS_DOMAIN_ID'])"),
    ]
    folder = chapters / "01_ros2_fundamentals"
    metadata = {"kernelspec": {"display_name": "Python 3 (ipykernel)", "name": "python3"}}
    nbformat.write(new_notebook(cells=cells, metadata=metadata), folder / "terminals.ipynb")
    return folder


def test_each_block_of_commands_opens_its_own_terminal_and_the_student_presses_enter(
    page: Page, lab: str, folder: Path
) -> None:
    from playwright.sync_api import expect

    page.goto(lab.format("lab/tree/01_ros2_fundamentals/terminals.ipynb"))
    notebook = OpenNotebook(page)
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    said = notebook.run(r"^import os").locator(".jp-OutputArea-output")
    expect(said).to_have_text(re.compile(r"domain \d+\s*"))  # all of it: a kernel may send a line in pieces
    domain = said.inner_text().split()[-1]

    expect(notebook.panel.locator(".jp-CodeCell", has_text="pass")).to_be_hidden()
    buttons = notebook.panel.get_by_role("button", name="Open in a terminal")
    expect(buttons).to_have_count(2)
    for place in range(2):
        buttons.nth(place).click()
        expect(page.locator(".jp-Terminal:visible")).to_have_count(place + 1)
        expect(buttons.nth(place)).to_be_enabled()
        look(page, f"terminal-{place}")
    assert not [*folder.glob("*.txt")], "a command ran before the student pressed Enter"
    for place in range(2):
        page.locator(".jp-Terminal:visible").nth(place).click()
        page.keyboard.press("Enter")
    look(page, "terminals-run")
    until(page, lambda: _words(folder / "first.txt") == [domain, "again"])
    until(page, lambda: _words(folder / "second.txt") == [str(folder)])


def _words(path: Path) -> list[str]:
    """The words in a file; none, as long as the shell has not made it."""
    return path.read_text().split() if path.exists() else []
