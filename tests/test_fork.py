"""The list of what a fork renames names every file that has the name or the makers of this course."""

from __future__ import annotations

import re
import subprocess
from fnmatch import fnmatch
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
NAME = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")
OURS = re.compile(
    rf"{re.escape(NAME)}|{NAME.lower().replace(' ', '[-_ ]?')}|(?:the) maintainers of this course",
    re.IGNORECASE,
)
HISTORY = {"CHANGELOG.md", "CONTRIBUTING.md", "docs/decisions.md"}
"""What was done under this name; a fork goes on from there."""


def listed() -> list[str]:
    """The files in the table."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    rows = re.findall(
        r"^\| (`.*?) \|", text.partition("## What a fork renames")[2].partition("\n## ")[0], re.MULTILINE
    )
    return [name for row in rows for name in re.findall(r"`([^`]+)`", row)]


def test_each_file_with_the_name_is_in_the_list_and_no_other() -> None:
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip("this is no git clone")
    having = set()
    for name in filter(None, done.stdout.split("\0")):
        file = ROOT / name
        if name not in HISTORY and file.suffix not in {".xz", ".png", ".gif"} and file.is_file():
            text = file.read_text(encoding="utf-8", errors="replace")
            having |= {name} if OURS.search(text) else set()
    patterns = listed()
    assert len(patterns) > 8
    assert sorted(name for name in having if not any(fnmatch(name, one) for one in patterns)) == []
    assert [one for one in patterns if not any(fnmatch(name, one) for name in having)] == []
