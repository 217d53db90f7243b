"""The workflows name the public repository of a course that names none."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from autograder.course import repository

ROOT = Path(__file__).parents[2]


def test_the_workflows_name_the_repository_if_nobody_has(tmp_path: Path) -> None:
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    for owner in ("ada", "ben"):
        script = [str(ROOT / ".ci" / "address"), f"https://github.com/{owner}/ros"]
        subprocess.run(script, cwd=tmp_path, check=True)
        assert repository(tmp_path) == "https://github.com/ada/ros"
    for name in ("site", "release"):
        workflow = (ROOT / ".github" / "workflows" / f"{name}.yml").read_text()
        _, _, after = workflow.partition('.ci/address "$GITHUB_SERVER_URL/$GITHUB_REPOSITORY"')
        assert 0 < after.find("./course build") < after.find("./course site")
