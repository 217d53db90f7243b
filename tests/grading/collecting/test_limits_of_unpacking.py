"""Each limit of what is unpacked holds at its own number: raised a hundredfold, one of these tests fails."""

from __future__ import annotations

import io
import tarfile
import zipfile
from typing import TYPE_CHECKING, Any

import pytest
from downloads import zipped

from autograder.boxes import one_command
from autograder.boxes.sandbox import why_impossible
from autograder.grading.collecting import archives
from autograder.grading.collecting.archives import Boxes, File, NotTaken, Room

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path


@pytest.fixture
def boxes(tmp_path: Path) -> Iterator[Boxes]:
    with Boxes(tmp_path) as made:
        yield made


def archive(names: Iterable[str], said: int = 1) -> bytes:
    """An archive of tiny files that says of each that it unpacks to this many bytes."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as made:
        for name in names:
            made.writestr(name, b"x")
        for entry in made.filelist:
            entry.file_size = said
    return data.getvalue()


def held(file: File) -> bytes | str:
    """The bytes of a file, or the reason why there are none."""
    try:
        return file.read()
    except NotTaken as error:
        return str(error)


def within(boxes: Boxes, folder: Path, data: bytes, room: Room | None = None) -> dict[str, bytes | str]:
    """The files of an archive that a student handed in, by their paths."""
    path = folder / "x.zip"
    path.write_bytes(data)
    (file,) = boxes.files_of(path, opened=False)
    return {"/".join(one.inner): held(one) for one in boxes.within(file, data, room or Room())}


def refusals(boxes: Boxes, folder: Path, several: Iterable[bytes]) -> list[str]:
    """Why archives of one student, in this order, were not taken; empty for each that was."""
    room, reasons = Room(), []
    for data in several:
        found = within(boxes, folder, data, room)
        reasons.append(next((one for one in found.values() if isinstance(one, str)), ""))
    return reasons


def test_the_files_of_a_students_archives_count_together(boxes: Boxes, tmp_path: Path) -> None:
    one = archive(f"{number}.txt" for number in range(2_600))
    first, second = refusals(boxes, tmp_path, [one, one])
    assert first == ""
    assert "2600 files" in second
    assert "and 2400 files of" in second


def test_the_bytes_of_a_students_archives_count_together(boxes: Boxes, tmp_path: Path) -> None:
    (reason,) = refusals(
        boxes, tmp_path, [archive([f"{number}.txt" for number in range(23)], said=45_000_000)]
    )
    assert "23 files that unpack to 1035 MB" in reason
    room = Room(unpacked=1_500_000)
    half = zipped({"a.txt": bytes(1_000_000)})
    assert within(boxes, tmp_path, half, room) == {"a.txt": bytes(1_000_000)}
    assert "of 0 MB may still be unpacked" in str(within(boxes, tmp_path, half, room)[""])


def test_a_file_that_says_it_is_too_large_is_not_unpacked(boxes: Boxes, tmp_path: Path) -> None:
    assert "unpacks to 60 MB" in refusals(boxes, tmp_path, [archive(["a.ipynb"], said=60_000_000)])[0]


def test_archives_in_each_other_are_opened_three_deep(boxes: Boxes, tmp_path: Path) -> None:
    data = archive(["lab.ipynb"])
    for _ in range(3):
        outer = io.BytesIO()
        with zipfile.ZipFile(outer, "w") as made:
            made.writestr("in.zip", data)
        data = outer.getvalue()
    assert list(within(boxes, tmp_path, data)) == ["in.zip/in.zip/in.zip"]


def test_the_memory_of_a_box_has_a_limit(boxes: Boxes, tmp_path: Path) -> None:
    """A few hundred bytes unpack in one step to more than the archive says and than there is room for."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_BZIP2) as made:
        with made.open("bomb.ipynb", "w", force_zip64=True) as bomb:
            for _ in range(800):
                bomb.write(bytes(1_000_000))
        made.filelist[0].file_size = 10
        made.writestr("lab.ipynb", "{}")
    found = within(boxes, tmp_path, data.getvalue())
    assert found["lab.ipynb"] == b"{}"
    assert found["bomb.ipynb"] == "it cannot be unpacked: Unable to allocate output buffer."


@pytest.mark.parametrize("form", ["gz", "bz2", "xz", ""])
def test_a_tar_is_unpacked_without_its_links(boxes: Boxes, tmp_path: Path, form: str) -> None:
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode=f"w:{form}") as made:  # type: ignore[call-overload]
        for name, kind in (
            ("a/lab.ipynb", tarfile.REGTYPE),
            ("link", tarfile.SYMTYPE),
            ("../up", tarfile.REGTYPE),
        ):
            entry = tarfile.TarInfo(name)
            entry.type, entry.linkname, entry.size = kind, "/etc/passwd", 2 if kind == tarfile.REGTYPE else 0
            made.addfile(entry, io.BytesIO(b"{}"))
    found = within(boxes, tmp_path, data.getvalue())
    assert found == {
        "a/lab.ipynb": b"{}",
        "link": "it is a link, or not an ordinary file",
        "../up": "its name leads out of the archive",
    }


def test_a_folder_of_a_download_has_so_many_files(boxes: Boxes, tmp_path: Path) -> None:
    path = tmp_path / "download.zip"
    with zipfile.ZipFile(path, "w") as made:
        for number in range(20_005):
            made.writestr(zipfile.ZipInfo(f"ada/repository/{number}"), b"")
        made.writestr("ben/lab_1_2.ipynb", "{}")
    found = list(boxes.files_of(path))
    assert len(found) == 20_002, (
        "those of ada's that are looked at, one that stands for the others, and ben's"
    )


SPY = """
import json, os, sys
def can_write(name):
    try:
        return bool(open(name, "wb"))
    except OSError:
        return False
seen = [name for name in (sys.argv[1], "/etc/passwd", "/home") if os.path.exists(name)]
written = [name for name in ("/x", "/tmp/x", "/dev/shm/x", "/file") if can_write(name)]
print(json.dumps({"names": ["seen"], "size": 0, "reason": str(seen + written)}))
"""


def test_an_archive_that_took_over_the_program_would_see_and_write_nothing(
    boxes: Boxes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if reason := why_impossible():
        pytest.skip(reason)
    run = one_command.run_alone

    def spied(command: list[str], *others: Any) -> int:
        return run([command[0], "-I", "-S", "-c", SPY, str(tmp_path)], *others)

    monkeypatch.setattr(archives, "run_alone", spied)
    assert within(boxes, tmp_path, archive(["a.ipynb"])) == {"seen": "[]"}


@pytest.mark.parametrize("text", ["no line\n", '{"names": 3}\n', '{"names": [], "size": -5}\n', "\n" * 5])
def test_what_a_box_writes_is_not_believed(
    boxes: Boxes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    def wrote(self: Boxes, path: Path, words: list[str], out: io.BufferedWriter) -> int:
        out.write(text.encode())
        out.flush()
        return 0

    monkeypatch.setattr(Boxes, "_run", wrote)
    assert not [one for one in within(boxes, tmp_path, b"").values() if isinstance(one, bytes) and one]


def test_without_a_sandbox_the_same_limits_hold(
    boxes: Boxes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archives, "why_impossible", lambda: "bubblewrap is not installed")
    monkeypatch.setattr(archives, "run_alone", None)
    assert within(boxes, tmp_path, archive(["a.ipynb"])) == {"a.ipynb": b"x"}
    assert "unpacks to 60 MB" in refusals(boxes, tmp_path, [archive(["a.ipynb"], said=60_000_000)])[0]
