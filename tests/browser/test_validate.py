"""nbgrader's Validate says how far it is, while JupyterLab goes on."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import OpenNotebook, look, opened_page

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = [pytest.mark.browser, pytest.mark.slow]
KERNEL = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}


def test_validate_says_which_cell_runs_and_how_many_are_left(
    browser: Browser, lab: str, chapters: Path
) -> None:
    from playwright.sync_api import expect

    cells = [new_code_cell("import time; time.sleep(4)") for _ in range(3)]
    notebook = new_notebook(cells=cells, metadata={"kernelspec": KERNEL})
    nbformat.write(notebook, chapters / "slow.ipynb")
    with opened_page(browser) as page:
        page.goto(lab.format("lab/tree/slow.ipynb"))
        expect(page.locator("#jp-main-statusbar")).to_contain_text("Idle")
        OpenNotebook(page).panel.get_by_text("Validate", exact=True).click()
        told = page.locator(".Toastify")
        expect(told).to_contain_text(re.compile("Validate: cell [12] of 3 runs, [12] are left"))
        look(page, "validating")
        expect(page.locator(".jp-Dialog")).to_contain_text("Success! Your notebook passes all the tests.")
        expect(told).not_to_contain_text("Validate")
