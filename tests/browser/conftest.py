"""JupyterLab as ``./course lab`` opens it, on a copy of the chapters, and a Chromium that looks at it."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_runtime.system_packages import CHROMIUM_NAMES, find_program

sys.path.insert(0, str(Path(__file__).parent))
from open_notebook import LIMIT, opened_page
from server_of_a_test import forget_what_was_open, jupyter_server

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Page

ROOT = Path(__file__).resolve().parents[2]
CHROMIUM_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@pytest.fixture(scope="session")
def chromium() -> str:
    """The path of Chromium."""
    path = find_program(*CHROMIUM_NAMES)
    if path is None:
        pytest.skip("no Chromium is installed (on Debian or Ubuntu: apt-get install chromium)")
    return path


@pytest.fixture(scope="module")
def chapters(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A student's copy of the chapters."""
    # Without what whoever runs the tests has done in the chapters.
    mine = shutil.ignore_patterns(".course-journal.jsonl")
    return Path(
        shutil.copytree(ROOT / "chapters", tmp_path_factory.mktemp("student") / "chapters", ignore=mine)
    )


@pytest.fixture(scope="module")
def server(chapters: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a JupyterLab, token included, that knows nothing of the user's own settings."""
    home = tmp_path_factory.mktemp("home")
    environ = {name: value for name, value in os.environ.items() if name != "ROS_DOMAIN_ID"}
    arguments = ["autograder", "lab", "--folder", str(chapters)]
    with jupyter_server(arguments, "student", home, environ) as address:
        yield address + "{}?token=student"


@pytest.fixture
def lab(server: str) -> str:
    """The address of a JupyterLab in which no kernel runs and no notebook is open, whatever ran before."""
    forget_what_was_open(server)
    return server


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[Browser]:
    """A Chromium. No longer than for a module: in its thread nobody else can run an event loop."""
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=LIMIT * 1000)
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=chromium, args=list(CHROMIUM_OPTIONS))
        yield started
        started.close()


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """An empty page of a browser that knows nothing of any page before."""
    with opened_page(browser) as page:
        yield page
