"""Sources as data: what is collected, and what is refused by who writes it down."""

from __future__ import annotations

import json
import os
import socket
from typing import TYPE_CHECKING

import pytest

from autograder.messages.lines import Lines, NotUnderstood, encode
from autograder.messages.workspaces import Source
from autograder.workspaces.sources import collecting
from autograder.workspaces.sources.packages import find_packages, sources_of
from autograder.workspaces.sources.tree import BadSources, Tree

if TYPE_CHECKING:
    from pathlib import Path


def sent_over(line: bytes) -> Source:
    """What the other side takes a line for."""
    here, there = socket.socketpair()
    with here, there:
        here.sendall(line)
        return Lines(there).hear(Source)


def test_what_is_collected_builds_the_same(workspace: Path, tmp_path: Path) -> None:
    setup = workspace / "src" / "tiny_pkg" / "setup.py"
    setup.chmod(0o755)
    sent = [sent_over(encode(source)) for source in collecting.collect_workspace(workspace)]
    Tree(tuple(collecting.checked(sent))).write(tmp_path / "there")
    here, there = workspace / "src", tmp_path / "there" / "ros2_ws" / "src"
    assert sources_of(there, find_packages(there)) == sources_of(here, find_packages(here))


def test_links_pipes_and_what_tools_leave_are_left_out(workspace: Path) -> None:
    src = workspace / "src"
    (src / "link").symlink_to("/etc/passwd")
    (src / "folder").symlink_to("/etc")
    os.mkfifo(src / "pipe")
    (src / "__pycache__").mkdir()
    (src / "__pycache__" / "x.pyc").touch()
    (workspace / "build").mkdir()
    names = {source.path for source in collecting.collect_workspace(workspace)}
    assert not [
        name for name in names if any(word in name for word in ("link", "folder", "pipe", "cache", "build"))
    ]
    assert "ros2_ws/src/tiny_pkg/setup.py" in names


def test_a_launch_file_comes_with_what_lies_beside_it(workspace: Path) -> None:
    file = workspace.parent / "remap.launch.py"
    file.write_text("launch")
    (workspace.parent / "other.yaml").touch()
    (workspace.parent / "lab.ipynb").touch()
    path, found = collecting.collect_launch(file, workspace)
    names = {source.path for source in found}
    assert path == "remap.launch.py"
    assert {path, "other.yaml", "ros2_ws/src/tiny_pkg/setup.py"} <= names
    assert "lab.ipynb" not in names


def test_a_launch_file_in_a_package_is_sent_once(workspace: Path) -> None:
    file = workspace / "src" / "tiny_pkg" / "x.launch.py"
    file.write_text("launch")
    path, found = collecting.collect_launch(file, workspace)
    assert [source.path for source in found].count(path) == 1


@pytest.mark.parametrize(
    "path",
    [
        "",
        ".",
        "..",
        "/etc/passwd",
        "a/../../b",
        "a//b",
        "a/./b",
        "a/",
        "a\0b",
        "a\nb",
        "\udc80",
        "x" * 200,
        "a/" * 20 + "b",
    ],
)
def test_no_path_leads_out(path: str) -> None:
    with pytest.raises(BadSources):
        collecting.checked([Source(path, b"")])


@pytest.mark.parametrize(
    "some",
    [
        [Source("a", b""), Source("a", b"")],
        [Source("a", b""), Source("a/b", b"")],
        [Source(f"f{number}", b"") for number in range(collecting.MAX_FILES + 1)],
        [Source("a", b"x" * (collecting.MAX_FILE + 1))],
        [
            Source(f"f{n}", b"x" * collecting.MAX_FILE)
            for n in range(collecting.MAX_BYTES // collecting.MAX_FILE + 1)
        ],
    ],
    ids=["twice", "below a file", "too many", "too large", "too much"],
)
def test_what_could_do_harm_is_refused(some: list[Source]) -> None:
    with pytest.raises(BadSources):
        collecting.checked(some)


@pytest.mark.parametrize(
    "words",
    [
        {},
        {"path": 1},
        {"path": "a", "data": 1},
        {"path": "a", "data": "?"},
        {"path": "a", "executable": "yes"},
    ],
)
def test_what_is_no_file_is_refused(words: dict[str, object]) -> None:
    with pytest.raises(NotUnderstood):
        sent_over(json.dumps({"say": "source", **words}).encode() + b"\n")


def test_far_too_much_is_not_even_sent(workspace: Path) -> None:
    (workspace / "src" / "mesh.stl").write_bytes(b"x" * (collecting.MAX_FILE + 1))
    with pytest.raises(BadSources, match="kB"):
        collecting.collect_workspace(workspace)
