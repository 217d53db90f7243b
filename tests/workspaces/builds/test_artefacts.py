"""What a build has made is data: nothing in it leads out of its folder, and there is not too much of it."""

from __future__ import annotations

import errno
import io
import tarfile
from typing import TYPE_CHECKING

import pytest

from autograder.workspaces.builds import artefacts, cache
from autograder.workspaces.builds.artefacts import BadArtefacts, unpack

if TYPE_CHECKING:
    from pathlib import Path


def packed(*members: tuple[str, bytes, str, int]) -> bytes:
    """A tar file: name, type, link target, and size of each entry."""
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w") as tar:
        for name, kind, target, size in members:
            info = tarfile.TarInfo(name)
            info.type, info.linkname, info.size, info.mode = kind, target, size, 0o755
            tar.addfile(info, io.BytesIO(b"x" * size))
    return file.getvalue()


def test_files_and_folders_come_through_and_links_to_files_as_copies(tmp_path: Path) -> None:
    unpack(
        packed(
            ("./pkg", tarfile.DIRTYPE, "", 0),
            ("./pkg/lib/run", tarfile.REGTYPE, "", 3),
            ("./pkg/first", tarfile.SYMTYPE, "second", 0),
            ("./pkg/second", tarfile.SYMTYPE, "./lib/../lib/run", 0),
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
    unpack(packed((name, tarfile.REGTYPE, "", 3)), tmp_path / "install")
    assert (tmp_path / "install" / name).read_bytes() == b"xxx"


@pytest.mark.parametrize(
    "members",
    [
        [("/etc/x", tarfile.REGTYPE, "", 1)],
        [("../x", tarfile.REGTYPE, "", 1)],
        [("a/../../x", tarfile.REGTYPE, "", 1)],
        [("a", tarfile.SYMTYPE, "/etc", 0)],
        [("a", tarfile.SYMTYPE, "../../etc", 0)],
        [("b", tarfile.SYMTYPE, "c", 0), ("c", tarfile.DIRTYPE, "", 0), ("a", tarfile.SYMTYPE, "b/../../etc", 0)],
        [("c/b", tarfile.SYMTYPE, ".", 0), ("a", tarfile.SYMTYPE, "c/b/../../outside", 0)],
        [("b", tarfile.DIRTYPE, "", 0), ("a", tarfile.SYMTYPE, "b", 0)],
        [("a", tarfile.SYMTYPE, "nothing", 0)],
        [("a", tarfile.SYMTYPE, "b", 0), ("b", tarfile.SYMTYPE, "a", 0)],
        [("c/x", tarfile.REGTYPE, "", 1), ("b", tarfile.SYMTYPE, "c", 0), ("a", tarfile.SYMTYPE, "b/x", 0)],
        [("a", tarfile.SYMTYPE, "b", 0), ("a/x", tarfile.REGTYPE, "", 1)],
        [("b", tarfile.DIRTYPE, "", 0), ("a", tarfile.SYMTYPE, "b", 0), ("a/x", tarfile.REGTYPE, "", 1)],
        [("a", tarfile.SYMTYPE, "x", 0), ("a", tarfile.REGTYPE, "", 1)],
        [("a", tarfile.LNKTYPE, "/etc/passwd", 0)],
        [("a", tarfile.FIFOTYPE, "", 0)],
        [("a", tarfile.CHRTYPE, "", 0)],
        [("a" * 250, tarfile.REGTYPE, "", 1)],
        [("a/" * 40 + "x", tarfile.REGTYPE, "", 1)],
    ],
    ids=[
        "absolute", "above", "through above", "absolute link", "link above", "above by way of a link",
        "out by way of a link", "link to a folder", "dead link", "circle", "by way of a link", "behind a dead link",
        "behind a link", "through a link", "hard link", "pipe", "device", "long name", "deep",
    ],
)  # fmt: skip
def test_what_leads_out_is_refused(members: list[tuple[str, bytes, str, int]], tmp_path: Path) -> None:
    (tmp_path / "outside").write_text("x = a.b:c")
    with pytest.raises(BadArtefacts):
        unpack(packed(*members), tmp_path / "install")
    assert {path.name for path in tmp_path.iterdir()} == {"install", "outside"}
    assert not [path for path in (tmp_path / "install").rglob("*") if path.is_symlink()]


def header(size: bytes, kind: bytes = tarfile.REGTYPE, name: bytes = b"a") -> bytes:
    """The header of one entry, with any bytes for its size (pax(1), ustar)."""
    found = bytearray(name.ljust(100, b"\0") + b"0000755\0" + b"0000000\0" * 2 + size.ljust(12, b"\0"))
    found += b"0" * 11 + b"\0" + b" " * 8 + kind + bytes(100) + b"ustar\x0000" + bytes(247)
    found[148:156] = b"%06o\0 " % sum(found)
    return bytes(found)


def told_before(**words: object) -> bytes:
    """An extended header of pax: what it says of the entry that follows holds in place of the entry's own words."""
    records = b""
    for key, value in words.items():
        record = f" {key.replace('_', '.')}={value}\n".encode()
        length = next(
            n for n in range(len(record), len(record) + 9) if len(f"{n}".encode()) + len(record) == n
        )
        records += f"{length}".encode() + record
    return header(b"%011o" % len(records), tarfile.XHDTYPE) + records.ljust(
        -(-len(records) // 512) * 512, b"\0"
    )


EMPTY, END = header(b"%011o" % 0), bytes(1024)
BACKWARDS = b"\xff" + ((1 << 88) - 512).to_bytes(11, "big")
"""A size of -512 bytes: whoever looks for the next entry behind this one finds this one again."""


@pytest.mark.parametrize(
    "archive",
    [
        pytest.param(header(BACKWARDS, tarfile.DIRTYPE) + header(BACKWARDS, name=b"b") * 2, id="goes back"),
        pytest.param(told_before(size=-512) + header(b"", tarfile.SYMTYPE), id="goes back to a link"),
        pytest.param(told_before(size=10**15) + EMPTY, id="says that it is huge"),
        pytest.param(told_before(path="../x") + EMPTY, id="has another path before it"),
        pytest.param(told_before(linkpath="/etc/passwd") + header(b"", tarfile.SYMTYPE), id="another target"),
        pytest.param(header(b"%011o" % 1, tarfile.GNUTYPE_LONGNAME) + bytes(512), id="a name and no file"),
        pytest.param(
            (header(b"%011o" % 1, tarfile.GNUTYPE_LONGNAME) + bytes(512)) * 3000 + EMPTY, id="names of names"
        ),
        pytest.param(
            told_before(
                GNU_sparse_major=1, GNU_sparse_minor=0, GNU_sparse_realsize=10**12, GNU_sparse_name="a"
            )
            + header(b"%011o" % 512)
            + b"1\n0\n0\n".ljust(512, b"\0"),
            id="is mostly holes",
        ),
        *(
            pytest.param(
                header(size, kind) + b"1" * 4_194_304 + EMPTY,
                id=f"digits for hours, {kind!r}, {size[:1].hex()}",
            )
            for size in (b"%011o" % 4_194_304, BACKWARDS)
            for kind in (tarfile.XHDTYPE, tarfile.XGLTYPE, tarfile.SOLARIS_XHDTYPE)
        ),
    ],
)
def test_an_archive_that_was_written_by_hand_is_refused_and_comes_to_an_end(
    archive: bytes, tmp_path: Path
) -> None:
    (tmp_path / "outside").write_text("x = a.b:c")
    with pytest.raises(BadArtefacts):
        unpack(archive + END, tmp_path / "install", most=1_000_000)
    assert {path.name for path in tmp_path.iterdir()} == {"install", "outside"}
    assert not [path for path in (tmp_path / "install").rglob("*") if path.is_symlink()]


def test_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(BadArtefacts, match="too much"):
        unpack(packed(("a", tarfile.REGTYPE, "", 11)), tmp_path / "bytes", most=2 * artefacts.BLOCK + 10)
    copies = [(name, tarfile.SYMTYPE, "a", 0) for name in "bcd"]
    with pytest.raises(BadArtefacts, match="too much"):
        unpack(
            packed(("a", tarfile.REGTYPE, "", 3), *copies), tmp_path / "copies", most=5 * artefacts.BLOCK + 10
        )
    monkeypatch.setattr(artefacts, "MAX_FILES", 2)
    with pytest.raises(BadArtefacts, match="too much"):
        unpack(packed(*((name, tarfile.DIRTYPE, "", 0) for name in "abc")), tmp_path / "files")


@pytest.mark.parametrize("data", [b"", b"no archive", packed(("a", tarfile.REGTYPE, "", 2000))[:1000]])
def test_garbage_is_refused(data: bytes, tmp_path: Path) -> None:
    with pytest.raises(BadArtefacts):
        unpack(data, tmp_path / "install")


def test_a_full_disk_is_no_fault_of_the_build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def write(*_: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(artefacts, "_take", write)
    with pytest.raises(OSError, match="No space left"):
        unpack(packed(("a", b"1", "", 0o644)), tmp_path / "install")


def test_empty_files_and_folders_take_room_too(tmp_path: Path) -> None:
    few = packed(*((f"{number}", tarfile.REGTYPE, "", 0) for number in range(9)))
    unpack(few, tmp_path / "few", most=10 * artefacts.BLOCK)
    assert cache.size_of(tmp_path / "few") == 10 * artefacts.BLOCK
    many = packed(*((f"{number}", tarfile.REGTYPE, "", 0) for number in range(10)))
    with pytest.raises(BadArtefacts, match="too much"):
        unpack(many, tmp_path / "many", most=10 * artefacts.BLOCK)
    # A file's path makes folders that the archive does not list.
    deep = packed(("/".join("abcdefghijk"), tarfile.REGTYPE, "", 0))
    with pytest.raises(BadArtefacts, match="too much"):
        unpack(deep, tmp_path / "deep", most=10 * artefacts.BLOCK)
