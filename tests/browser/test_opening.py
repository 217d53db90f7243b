"""A notebook that was only opened."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = [pytest.mark.browser, pytest.mark.slow]
ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("notebook", ["00_nervous_system", "lab_1_2"])
def test_nothing_is_to_be_saved_in_a_notebook_that_was_only_opened(
    page: Page, lab: str, chapters: Path, notebook: str
) -> None:
    from playwright.sync_api import expect

    file = f"01_ros2_fundamentals/{notebook}.ipynb"
    page.goto(lab.format(f"lab/tree/{file}"))
    # The kernel has said by then which Python it is, which JupyterLab compares with the notebook.
    expect(page.locator("#jp-main-statusbar")).to_contain_text("Python 3 (ipykernel) | Idle")
    expect(page.locator(".jp-NotebookPanel:visible .jp-Cell").first).to_be_visible()
    # While a page is being read it may carry the mark for a moment. Whatever is there to be saved JupyterLab saves by
    # itself within two minutes, and the mark goes away: then the file is another one.
    expect(page.locator(".jp-mod-dirty")).to_have_count(0)
    assert (chapters / file).read_bytes() == (ROOT / "chapters" / file).read_bytes()
