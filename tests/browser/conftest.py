"""JupyterLab as ``./course lab`` opens it, on a copy of the chapters, and a Chromium that looks at it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from environment.system_packages import CHROMIUM_NAMES, find_program

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Page

ROOT = Path(__file__).resolve().parents[2]
LIMIT = 60.0
"""Seconds after which a test gives up waiting for something that a quiet machine shows within ten."""
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
    return Path(shutil.copytree(ROOT / "chapters", tmp_path_factory.mktemp("student") / "chapters"))


@pytest.fixture(scope="module")
def lab(chapters: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a JupyterLab, token included, that knows nothing of the user's own settings."""
    home = tmp_path_factory.mktemp("home")
    places = ("HOME", "IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR")
    environ = {name: value for name, value in os.environ.items() if name != "ROS_DOMAIN_ID"}
    environ |= {name: str(home / name) for name in places}
    command = [sys.executable, "-m", "autograder", "lab", "--folder", str(chapters), "--no-browser"]
    options = ["--allow-root", "--ServerApp.port=0", "--IdentityProvider.token=student"]
    with subprocess.Popen([*command, *options], env=environ, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        said: list[str] = []
        try:
            for line in server.stderr:
                said.append(line)
                if found := re.search(r"http://127\.0\.0\.1:\d+/", line):
                    break
            else:
                pytest.fail("JupyterLab did not start:\n" + "".join(said))
            # A full pipe would stop it.
            threading.Thread(target=server.stderr.read, daemon=True).start()
            yield found.group() + "{}?token=student"
        finally:
            server.terminate()


@pytest.fixture
def page(chromium: str, tmp_path: Path) -> Iterator[Page]:
    """An empty page of a browser that starts as on its first day."""
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=LIMIT * 1000)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch_persistent_context(
            tmp_path / "profile",
            executable_path=chromium,
            args=list(CHROMIUM_OPTIONS),
            viewport={"width": 1300, "height": 1000},
        )
        browser.set_default_timeout(LIMIT * 1000)
        yield browser.pages[0]
        if folder := os.environ.get("SCREENSHOTS"):
            browser.pages[0].screenshot(path=Path(folder) / "end.png")
        browser.close()
