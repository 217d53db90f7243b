"""What a build has made is data: nothing in it leads out of its folder, and there is not too much of it."""

from __future__ import annotations

import io
import tarfile
from typing import TYPE_CHECKING

import pytest

from autograder.workspaces.building import artefacts
from autograder.workspaces.building.artefacts import BadArtefacts, unpack

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


def test_files_folders_and_inner_links_come_through(tmp_path: Path) -> None:
    unpack(
        packed(
            ("./pkg", tarfile.DIRTYPE, "", 0),
            ("./pkg/lib/run", tarfile.REGTYPE, "", 3),
            ("./pkg/link", tarfile.SYMTYPE, "lib/run", 0),
        ),
        tmp_path / "install",
    )
    assert (tmp_path / "install" / "pkg" / "link").read_bytes() == b"xxx"
    assert (tmp_path / "install" / "pkg" / "lib" / "run").stat().st_mode & 0o777 == 0o755


@pytest.mark.parametrize(
    "members",
    [
        [("/etc/x", tarfile.REGTYPE, "", 1)],
        [("../x", tarfile.REGTYPE, "", 1)],
        [("a/../../x", tarfile.REGTYPE, "", 1)],
        [("a", tarfile.SYMTYPE, "/etc", 0)],
        [("a", tarfile.SYMTYPE, "../../etc", 0)],
        [("a", tarfile.SYMTYPE, "b", 0), ("a/x", tarfile.REGTYPE, "", 1)],
        [("b", tarfile.DIRTYPE, "", 0), ("a", tarfile.SYMTYPE, "b", 0), ("a/x", tarfile.REGTYPE, "", 1)],
        [("a", tarfile.SYMTYPE, "x", 0), ("a", tarfile.REGTYPE, "", 1)],
        [("a", tarfile.LNKTYPE, "/etc/passwd", 0)],
        [("a", tarfile.FIFOTYPE, "", 0)],
        [("a", tarfile.CHRTYPE, "", 0)],
        [("a" * 250, tarfile.REGTYPE, "", 1)],
    ],
    ids=[
        "absolute", "above", "through above", "absolute link", "link above", "behind a dead link", "behind a link",
        "through a link", "hard link", "pipe", "device", "long name",
    ],
)  # fmt: skip
def test_what_leads_out_is_refused(members: list[tuple[str, bytes, str, int]], tmp_path: Path) -> None:
    with pytest.raises(BadArtefacts):
        unpack(packed(*members), tmp_path / "install")
    assert {path.name for path in tmp_path.iterdir()} == {"install"}


def test_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(artefacts, "MAX_BYTES", 10)
    with pytest.raises(BadArtefacts, match="more than"):
        unpack(packed(("a", tarfile.REGTYPE, "", 11)), tmp_path / "bytes")
    monkeypatch.setattr(artefacts, "MAX_FILES", 2)
    with pytest.raises(BadArtefacts, match="more than"):
        unpack(packed(*((name, tarfile.DIRTYPE, "", 0) for name in "abc")), tmp_path / "files")


@pytest.mark.parametrize("data", [b"", b"no archive", packed(("a", tarfile.REGTYPE, "", 2000))[:1000]])
def test_garbage_is_refused(data: bytes, tmp_path: Path) -> None:
    with pytest.raises(BadArtefacts):
        unpack(data, tmp_path / "install")
