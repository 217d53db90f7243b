"""What a build has made is data: nothing in it leads out of its folder, and there is not too much of it."""

from __future__ import annotations

import errno
import os
from typing import TYPE_CHECKING

import msgspec
import pytest

from autograder.workspaces.builds import build_artifacts, build_cache
from autograder.workspaces.builds.build_artifacts import BadArtifacts, Kind, PackedEntry, pack, unpack

if TYPE_CHECKING:
    from pathlib import Path


def packed(*entries: tuple[str, Kind, str | int]) -> bytes:
    """A packed folder: path, kind, and the size of a file or the target of a link."""
    return msgspec.msgpack.encode(
        [
            PackedEntry(path.encode(), kind, said.encode() if isinstance(said, str) else b"x" * said)
            for path, kind, said in entries
        ]
    )


def test_files_and_folders_come_through_and_links_to_files_as_copies(tmp_path: Path) -> None:
    unpack(
        packed(
            ("./pkg", Kind.FOLDER, 0),
            ("./pkg/lib/run", Kind.PROGRAM, 3),
            ("./pkg/first", Kind.LINK, "second"),
            ("./pkg/second", Kind.LINK, "./lib/../lib/run"),
        ),
        tmp_path / "install",
    )
    for name in ("first", "second", "lib/run"):
        file = tmp_path / "install" / "pkg" / name
        assert file.read_bytes() == b"xxx"
        assert file.stat().st_mode & 0o777 == 0o755
        assert not file.is_symlink()


def test_a_long_path_comes_through(tmp_path: Path) -> None:
    name = "/".join(["p" * 60] * 10)
    unpack(packed((name, Kind.FILE, 3)), tmp_path / "install")
    assert (tmp_path / "install" / name).read_bytes() == b"xxx"


@pytest.mark.parametrize(
    "members",
    [
        [("/etc/x", Kind.FILE, 1)],
        [("../x", Kind.FILE, 1)],
        [("a/../../x", Kind.FILE, 1)],
        [("a", Kind.LINK, "/etc")],
        [("a", Kind.LINK, "../../etc")],
        [("b", Kind.LINK, "c"), ("c", Kind.FOLDER, 0), ("a", Kind.LINK, "b/../../etc")],
        [("c/b", Kind.LINK, "."), ("a", Kind.LINK, "c/b/../../outside")],
        [("b", Kind.FOLDER, 0), ("a", Kind.LINK, "b")],
        [("a", Kind.LINK, "nothing")],
        [("a", Kind.LINK, "b"), ("b", Kind.LINK, "a")],
        [("c/x", Kind.FILE, 1), ("b", Kind.LINK, "c"), ("a", Kind.LINK, "b/x")],
        [("a", Kind.LINK, "b"), ("a/x", Kind.FILE, 1)],
        [("b", Kind.FOLDER, 0), ("a", Kind.LINK, "b"), ("a/x", Kind.FILE, 1)],
        [("a", Kind.LINK, "x"), ("a", Kind.FILE, 1)],
        [("a", Kind.OTHER, 0)],
        [("a" * 250, Kind.FILE, 1)],
        [("a/" * 40 + "x", Kind.FILE, 1)],
    ],
    ids=[
        "absolute", "above", "through above", "absolute link", "link above", "above by way of a link",
        "out by way of a link", "link to a folder", "dead link", "circle", "by way of a link", "behind a dead link",
        "behind a link", "through a link", "pipe or device", "long name", "deep",
    ],
)  # fmt: skip
def test_what_leads_out_is_refused(members: list[tuple[str, Kind, str | int]], tmp_path: Path) -> None:
    (tmp_path / "outside").write_text("x = a.b:c")
    with pytest.raises(BadArtifacts):
        unpack(packed(*members), tmp_path / "install")
    assert {path.name for path in tmp_path.iterdir()} == {"install", "outside"}
    assert not [path for path in (tmp_path / "install").rglob("*") if path.is_symlink()]


@pytest.mark.parametrize(
    "said",
    [
        b"", b"no list", b"\xc1", b"\x90" + b"x", msgspec.msgpack.encode(None), msgspec.msgpack.encode({}),
        msgspec.msgpack.encode([["a"]]), msgspec.msgpack.encode([[b"a", "device"]]),
        msgspec.msgpack.encode([[b"a", "file", "text"]]), msgspec.msgpack.encode([[b"", "file"]]),
        msgspec.msgpack.encode([[b".", "file"]]), msgspec.msgpack.encode([[b"a\0b", "file"]]),
        b"\xdd\xff\xff\xff\xff", b"\x91" * 100_000, packed(("a", Kind.FILE, 2000))[:1000],
    ],
)  # fmt: skip
def test_a_list_that_was_written_by_hand_is_refused(said: bytes, tmp_path: Path) -> None:
    with pytest.raises(BadArtifacts):
        unpack(said, tmp_path / "install")
    assert not [path for path in tmp_path.rglob("*") if not path.is_dir()]


def test_what_is_packed_is_unpacked(tmp_path: Path) -> None:
    made = tmp_path / "made"
    (made / "lib").mkdir(parents=True)
    (made / "lib" / "run").write_bytes(b"xxx")
    (made / "lib" / "run").chmod(0o755)
    (made / "caf\udce9").write_bytes(b"")
    (made / "link").symlink_to("lib/run")
    unpack(pack(made), tmp_path / "install")
    assert (tmp_path / "install" / "link").read_bytes() == b"xxx"
    assert (tmp_path / "install" / "lib" / "run").stat().st_mode & 0o777 == 0o755
    assert (tmp_path / "install" / "caf\udce9").stat().st_mode & 0o777 == 0o644
    os.mkfifo(made / "pipe")
    with pytest.raises(BadArtifacts, match="neither a file nor a folder"):
        unpack(pack(made), tmp_path / "other")
    assert pack(tmp_path / "nothing") == b""


def test_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(BadArtifacts, match="too large"):
        unpack(packed(("a", Kind.FILE, 11)), tmp_path / "bytes", most=2 * build_artifacts.BLOCK + 10)
    copies = [(name, Kind.LINK, "a") for name in "bcd"]
    with pytest.raises(BadArtifacts, match="too large"):
        unpack(packed(("a", Kind.FILE, 3), *copies), tmp_path / "copies", most=5 * build_artifacts.BLOCK + 10)
    monkeypatch.setattr(build_artifacts, "MAX_FILES", 2)
    with pytest.raises(BadArtifacts, match="too large"):
        unpack(packed(*((name, Kind.FOLDER, 0) for name in "abc")), tmp_path / "files")


def test_millions_of_entries_are_not_even_read(tmp_path: Path) -> None:
    said = msgspec.msgpack.encode([[b"a", "file"]] * (build_artifacts.MOST_ENTRIES + 1))
    with pytest.raises(BadArtifacts, match="length"):
        unpack(said, tmp_path / "install")


def test_a_full_disk_is_no_fault_of_the_build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def write(*_: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(build_artifacts, "_take", write)
    with pytest.raises(OSError, match="No space left"):
        unpack(packed(("a", Kind.FILE, 1)), tmp_path / "install")


def test_empty_files_and_folders_take_room_too(tmp_path: Path) -> None:
    few = packed(*((f"{number}", Kind.FILE, 0) for number in range(9)))
    unpack(few, tmp_path / "few", most=10 * build_artifacts.BLOCK)
    assert build_cache.size_of(tmp_path / "few") == 10 * build_artifacts.BLOCK
    many = packed(*((f"{number}", Kind.FILE, 0) for number in range(10)))
    with pytest.raises(BadArtifacts, match="too large"):
        unpack(many, tmp_path / "many", most=10 * build_artifacts.BLOCK)
    # A file's path makes folders that the archive does not list.
    deep = packed(("/".join("abcdefghijk"), Kind.FILE, 0))
    with pytest.raises(BadArtifacts, match="too large"):
        unpack(deep, tmp_path / "deep", most=10 * build_artifacts.BLOCK)
