"""Dockerfiles and dev container fit the set-up. Nothing here starts a container."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from course_runtime.system_packages import TABLE

ROOT = Path(__file__).resolve().parents[2]
DEV_CONTAINER = ROOT / ".devcontainer" / "devcontainer.json"
DOCKERFILES = sorted((ROOT / "environment").glob("*Dockerfile"))


def words(dockerfile: Path) -> list[str]:
    """The words of its commands, without comments; a command that goes on in the next line is one."""
    lines = [line for line in dockerfile.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return " ".join(lines).replace("\\", " ").split()


def test_there_are_two_images() -> None:
    assert [file.name for file in DOCKERFILES] == ["Dockerfile", "jazzy.Dockerfile"]


@pytest.mark.parametrize("dockerfile", DOCKERFILES, ids=lambda file: file.name)
def test_an_image_installs_what_the_set_up_cannot_install_as_an_ordinary_user(dockerfile: Path) -> None:
    needed = {name for row in TABLE if row.need != "tests" for name in row.debian}
    assert needed
    assert needed <= set(words(dockerfile))


@pytest.mark.parametrize("dockerfile", DOCKERFILES, ids=lambda file: file.name)
def test_an_image_is_set_up_as_an_ordinary_user(dockerfile: Path) -> None:
    found = words(dockerfile)
    assert found.index("USER") < found.index("./course")
    user = found[found.index("USER") + 1]
    assert f"--chown={user}" in found


def test_the_dev_container_names_what_is_there() -> None:
    container = json.loads(DEV_CONTAINER.read_text(encoding="utf-8"))
    build = container["build"]
    dockerfile = (DEV_CONTAINER.parent / build["dockerfile"]).resolve()
    assert dockerfile in DOCKERFILES
    assert (DEV_CONTAINER.parent / build["context"]).resolve() == ROOT
    found = words(dockerfile)
    stages = [found[place + 1] for place, word in enumerate(found) if word == "AS"]
    assert build["target"] in stages
    assert f"--chown={container['remoteUser']}" in found
    # The same sourcing and set-up as in the image.
    assert " ".join(container["postCreateCommand"][2:]) in " ".join(found)
