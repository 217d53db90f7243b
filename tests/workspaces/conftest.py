"""Workspaces made for a test, and a cache that holds nothing yet."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from autograder.workspaces.builds import build_cache

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import python_package


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A workspace with one small package."""
    python_package(tmp_path / "ros2_ws" / "src")
    return tmp_path / "ros2_ws"


@pytest.fixture(autouse=True)
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The cache of this test."""
    folder = tmp_path / "cache"
    monkeypatch.setenv(build_cache.VARIABLE, str(folder))
    return folder
