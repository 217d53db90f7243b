"""Sources as data: what is collected and what is refused; and what is in no key is in no box."""

from __future__ import annotations

import json
import os
import shutil
import socket
import sys
import tracemalloc
import unicodedata
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from autograder.messages.json_lines import Lines, NotUnderstood, encode
from autograder.messages.workspace_messages import Source
from autograder.workspaces import sources
from autograder.workspaces.packages import sources_of
from autograder.workspaces.sources import BadSources, SourceTree, read_sources

sys.path.insert(0, str(Path(__file__).parent))
from made_workspaces import packages_in

from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Callable

TWIN = unicodedata.normalize("NFC", "ä.py"), unicodedata.normalize("NFD", "ä.py")


def tree_of(folder: Path, largest: int = 1_000) -> SourceTree:
    return SourceTree(tuple(read_sources(folder, ".", largest)))


def listening(folder: Path) -> None:
    here = os.open(folder, os.O_PATH)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(f"/proc/self/fd/{here}/socket")
    os.close(here)


def compiled(folder: Path) -> None:
    for place in (folder / "setuptools.pyc", folder / "sub" / "os.pyc", folder / "x.pyc" / "y.py"):
        place.parent.mkdir(exist_ok=True)
        place.write_text("x")


def tools(folder: Path) -> None:
    for name in ("__pycache__", ".git", ".ipynb_checkpoints"):
        (folder / name).mkdir()
        (folder / name / "setup.py").write_text("x")


def link_to_a_folder(folder: Path) -> None:
    (folder.parent / "elsewhere").mkdir()
    (folder.parent / "elsewhere" / "a.py").write_text("x")
    (folder / "link").symlink_to("../elsewhere")


LEFT_OUT: dict[str, Callable[[Path], object]] = {
    "compiled": compiled,
    "folders of tools": tools,
    "extension module": lambda folder: (folder / "setuptools.abi3.so").write_bytes(b"\x7fELF"),
    "library under another name": lambda folder: (folder / "notes.txt").write_bytes(b"!<arch>\nx"),
    "link to a file": lambda folder: (folder / "link.py").symlink_to("setup.py"),
    "link to a file of the host": lambda folder: (folder / "link.py").symlink_to("/etc/passwd"),
    "link to a folder": link_to_a_folder,
    "link to nothing": lambda folder: (folder / "link").symlink_to("nothing"),
    "pipe": lambda folder: os.mkfifo(folder / "pipe"),
    "socket": listening,
    "time": lambda folder: os.utime(folder / "setup.py", (1, 1)),
    "rights of others": lambda folder: (folder / "setup.py").chmod(0o4666),
    "rights of a folder": lambda folder: (folder / "sub").chmod(0o777),
    "extended attribute": lambda folder: os.setxattr(folder / "setup.py", "user.build", b"poison"),
}
KEPT: dict[str, Callable[[Path], object]] = {
    "hidden": lambda folder: (folder / ".hidden").write_text("x"),
    "hidden folder": lambda folder: (folder / ".hidden").mkdir(),
    "empty folder": lambda folder: (folder / "empty").mkdir(),
    "empty file": lambda folder: (folder / "COLCON_IGNORE").touch(),
    "right to execute": lambda folder: (folder / "setup.py").chmod(0o744),
    "another case": lambda folder: (folder / "SETUP.py").write_text("x"),
    "one normal form": lambda folder: (folder / TWIN[0]).write_text("x"),
    "the other normal form": lambda folder: (folder / TWIN[1]).write_text("x"),
    "egg-info": lambda folder: (folder / "my_pkg.egg-info").mkdir(),
    "build": lambda folder: (folder / "build").mkdir(),
    "hard link": lambda folder: (folder / "link.py").hardlink_to(folder / "setup.py"),
    "hole in a file": lambda folder: os.truncate(folder / "setup.py", 900),
    "name that is no text": lambda folder: (folder / os.fsdecode(b"\xff.py")).write_text("x"),
    "a byte in a name for one in a file": lambda folder: (folder / "setup.py").rename(folder / "setup.pyx"),
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a file, and one in a folder."""
    (tmp_path / "src" / "sub").mkdir(parents=True)
    (tmp_path / "src" / "setup.py").write_text("x")
    (tmp_path / "src" / "sub" / "module.py").write_text("x")
    return tmp_path / "src"


@pytest.mark.parametrize("kind", [*LEFT_OUT, *KEPT])
def test_what_is_written_is_what_the_hash_is_of(kind: str, folder: Path, tmp_path: Path) -> None:
    plain = tree_of(folder)
    (LEFT_OUT | KEPT)[kind](folder)
    tree = tree_of(folder)
    for name in ("once", "twice"):
        (tmp_path / name).mkdir()
        tree.write(tmp_path / name)
    assert tree_of(tmp_path / "once") == tree_of(tmp_path / "twice") == tree
    assert (tree.digest == plain.digest) is (kind in LEFT_OUT)
    boxed = list((tmp_path / "once").rglob("*"))
    assert len(boxed) == len(tree.sources) - 1  # all but the folder itself
    assert all(path.is_dir() or path.is_file() for path in boxed)
    assert not [path for path in boxed if path.is_symlink()]
    assert {path.stat().st_mode & 0o7777 for path in boxed if path.is_file()} <= {0o755, 0o644}


def test_what_changes_after_it_was_read_is_in_neither(folder: Path, tmp_path: Path) -> None:
    tree = tree_of(folder)
    before = tree.digest
    (folder / "setup.py").write_text("poison")
    (folder / "more.py").write_text("poison")
    tree.write(tmp_path / "box")
    assert tree_of(tmp_path / "box").digest == before == tree.digest
    assert not [file for file in (tmp_path / "box").rglob("*.py") if "poison" in file.read_text()]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_what_may_not_be_read_is_in_neither(folder: Path) -> None:
    plain = tree_of(folder)
    (folder / "secret.py").write_text("x")
    (folder / "secret.py").chmod(0)
    assert tree_of(folder) == plain


def test_two_names_that_look_the_same_are_two(folder: Path, tmp_path: Path) -> None:
    for number, name in enumerate((*TWIN, "Setup.py")):
        (folder / name).write_text(str(number))
    (tmp_path / "there").mkdir()
    tree_of(folder).write(tmp_path / "there")
    assert [(tmp_path / "there" / name).read_text() for name in (*TWIN, "Setup.py")] == ["0", "1", "2"]


def test_nothing_is_written_over_what_is_there_or_through_a_link(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "setup.py").symlink_to(tmp_path / "outside")
    with pytest.raises(FileExistsError):
        tree_of(folder).write(tmp_path / "there")
    assert not (tmp_path / "outside").exists()


def test_a_huge_file_is_refused_before_it_is_read(folder: Path) -> None:
    with (folder / "huge.py").open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(BadSources, match="kB"):
        tree_of(folder)


def test_no_two_trees_have_the_same_hash_by_where_a_name_ends() -> None:
    trees = [
        (Source("a", b"b"),),
        (Source("ab", b""),),
        (Source("a", b""), Source("b", b"")),
        (Source("a"), Source("b", b"")),
        (Source("a", b"b", executable=True),),
        (Source("a", b"file 1 0\0b"),),
    ]
    assert len({SourceTree(tree).digest for tree in trees}) == len(trees)


def test_a_grader_takes_nothing_that_no_key_has() -> None:
    """Whoever speaks as a notebook may send anything: it need not have been read from a folder."""
    sent = [
        Source("ws/src/p/setuptools.pyc", b"x"),
        Source("ws/src/p/__pycache__"),
        Source("ws/src/.git/x", b""),
        Source("ws/src/p/notes.txt", b"\x7fELF"),
    ]
    assert sources.checked_sources([*sent, Source("ws/src/p/setup.py", b"x")]) == [
        Source("ws/src/p/setup.py", b"x")
    ]


def sent_over(line: bytes) -> Source:
    """What the other side takes a line for."""
    here, there = socket.socketpair()
    with here, there:
        here.sendall(line)
        return Lines(there).hear(Source)


def test_what_is_collected_builds_the_same(workspace: Path, tmp_path: Path) -> None:
    setup = workspace / "src" / "tiny_pkg" / "setup.py"
    setup.chmod(0o755)
    sent = [sent_over(encode(source)) for source in sources.collect_workspace(workspace)]
    SourceTree(tuple(sources.checked_sources(sent))).write(tmp_path / "there")
    here, there = workspace / "src", tmp_path / "there" / "ros2_ws" / "src"
    assert sources_of(there, packages_in(there)) == sources_of(here, packages_in(here))


def test_a_launch_file_comes_with_what_lies_beside_it(workspace: Path) -> None:
    file = workspace.parent / "remap.launch.py"
    file.write_text("launch")
    (workspace.parent / "other.yaml").touch()
    (workspace.parent / "lab.ipynb").touch()
    path, found = sources.collect_launch(file, workspace)
    names = {source.path for source in found}
    assert path == "remap.launch.py"
    assert {path, "other.yaml", "ros2_ws/src/tiny_pkg/setup.py"} <= names
    assert "lab.ipynb" not in names


def test_a_launch_file_in_a_package_is_sent_once(workspace: Path) -> None:
    file = workspace / "src" / "tiny_pkg" / "x.launch.py"
    file.write_text("launch")
    path, found = sources.collect_launch(file, workspace)
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
        sources.checked_sources([Source(path, b"")])


@pytest.mark.parametrize(
    "some",
    [
        [Source("a", b""), Source("a", b"")],
        [Source("a", b""), Source("a/b", b"")],
        [Source(f"f{number}", b"") for number in range(sources.MAX_FILES + 1)],
        [Source("a", b"x" * (sources.MAX_FILE + 1))],
        [Source(f"f{n}", b"x" * sources.MAX_FILE) for n in range(sources.MAX_BYTES // sources.MAX_FILE + 1)],
    ],
    ids=["twice", "below a file", "too many", "too large", "too much"],
)
def test_what_could_do_harm_is_refused(some: list[Source]) -> None:
    with pytest.raises(BadSources):
        sources.checked_sources(some)


@pytest.mark.parametrize("one", [Source("a", b"x" * 700_000), Source("x" * 900_000)], ids=["data", "paths"])
def test_of_far_too_much_that_is_sent_nothing_is_kept(one: Source, tmp_path: Path) -> None:
    # A thousand such messages were a gigabyte of the grader's, outside of every box.
    here, there = socket.socketpair()
    with here, there, ThreadPoolExecutor(1) as sender:
        count = 40
        sent = sender.submit(here.sendall, encode(one) * count)
        tracemalloc.start()
        with pytest.raises(BadSources, match="src is too large"):
            sources.receive_sources(Lines(there), count, "ros2_ws", tmp_path)
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        sent.result()  # all of it was heard: what is said behind it comes in its turn
    assert most < 20_000_000


@pytest.mark.parametrize("words", cases(__file__, "what_is_no_file_is_refused"))
def test_what_is_no_file_is_refused(words: dict[str, object]) -> None:
    with pytest.raises(NotUnderstood):
        sent_over(json.dumps({"say": "source", **words}).encode() + b"\n")


@pytest.mark.parametrize(("free", "said"), [(0, "is full"), (10**9, "")])
def test_a_full_disk_is_no_mistake_of_the_sources(
    free: int, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(10**10, 10**10 - free, free))
    trouble = sources.full_disk(tmp_path)
    assert said in trouble
    assert bool(trouble) == bool(said)


def test_a_folder_that_is_missing_is_no_full_disk(tmp_path: Path) -> None:
    assert sources.full_disk(tmp_path / "nothing") == ""
