"""What a README shows of its public repository, and that it shows nothing of it without one."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import parse_qs, urlsplit

from autograder.course import repository
from autograder.masters.chapter_building import build
from autograder.masters.readme_address import README

if TYPE_CHECKING:
    from autograder.masters.source_notebooks import Points

ROOT = Path(__file__).parents[2]
TEXT = """\
# A course

[Look at Lab 9.1](chapters/01_first/lab_9_1.ipynb), or go on.

<!-- address -->
<!-- end of address -->
"""
NOTEBOOK = "chapters/01_first/lab_9_1.ipynb"
BADGE = re.compile(r"^\[!\[[^\]]+\]\((\S+)\)\]\((\S+)\)$", re.MULTILINE)


def test_with_an_address_a_build_writes_what_can_be_typed_and_without_one_nothing(
    course: Path, ten_points: Points
) -> None:
    readme, settings = course / README, course / "pyproject.toml"
    readme.write_text(TEXT)
    assert readme not in build(course, points=ten_points).written
    settings.write_text('[project.urls]\nRepository = "https://github.com/ada/ros-2.x.git/"\n')
    assert readme in build(course, check=True, points=ten_points).stale
    assert readme in build(course, points=ten_points).written
    written = readme.read_text()
    assert "\n$ git clone https://github.com/ada/ros-2.x && cd ros-2.x\n" in written
    assert "[Look at Lab 9.1](https://ada.github.io/ros-2.x/chapters/01_first/lab_9_1.html)" in written
    pictures, links = zip(*BADGE.findall(written), strict=True)
    assert pictures[0] == "https://github.com/ada/ros-2.x/actions/workflows/ci.yml/badge.svg"
    tests, colab, codespaces, binder = map(urlsplit, links)
    assert {one.scheme for one in map(urlsplit, [*pictures, *links])} == {"https"}
    assert (tests.netloc, tests.path) == ("github.com", "/ada/ros-2.x/actions/workflows/ci.yml")
    assert colab.netloc == "colab.research.google.com"
    assert colab.path == f"/github/ada/ros-2.x/blob/main/{NOTEBOOK}"
    assert (codespaces.netloc, codespaces.path) == ("codespaces.new", "/ada/ros-2.x")
    assert (binder.netloc, binder.path) == ("mybinder.org", "/v2/gh/ada/ros-2.x/main")
    assert parse_qs(binder.query) == {"urlpath": [f"lab/tree/{NOTEBOOK}"]}
    settings.unlink()
    build(course, points=ten_points)
    assert readme.read_text() == TEXT


def test_a_readme_without_a_place_for_badges_is_left_alone(course: Path, ten_points: Points) -> None:
    (course / README).write_text("# Mine\n\n$ git clone SOMETHING else\n")
    (course / "pyproject.toml").write_text('[project.urls]\nRepository = "https://github.com/ada/ros"\n')
    assert course / README not in build(course, points=ten_points).written


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
