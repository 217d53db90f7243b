"""Each limit of what is unpacked holds at its own number: raised a hundredfold, one of these tests fails."""

from __future__ import annotations

import base64
import io
import os
import shutil
import tarfile
import zipfile
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from downloads import zipped

from autograder.boxes import reading_desks as desk_of_boxes
from autograder.boxes.reading_desks import Desk, in_memory
from autograder.boxes.sandbox import why_impossible
from autograder.grading.collecting import downloaded_files
from autograder.grading.collecting.downloaded_files import Archives, File, NotTaken, Room, read_list
from autograder.grading.rebuilding.file_desk import READERS, desk
from tests.cases import cases
from tests.grading.rebuilding.hostile_desk import RAW

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

ROOT = Path(__file__).resolve().parents[3]
BOMB = cases(__file__, "BOMB")
"""800 MB of zeros after bz2, zlib and base85, in this order: to pack them takes bz2 seven seconds."""


REACH = b"hostile: reach_from_an_archive"
NO_JSON = (b'["\xff"]', b'{"names": ["\xff"], "size": 1}\n', b'{"x":' + b"[" * 40_000 + b"\n")
"""Answers that msgspec decodes with errors of other types than its own."""


@pytest.fixture
def archives(tmp_path: Path) -> Iterator[Archives]:
    with Archives(tmp_path) as made:
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


def within(archives: Archives, folder: Path, data: bytes, room: Room | None = None) -> dict[str, bytes | str]:
    """The files of an archive that a student handed in, by their paths."""
    path = folder / "x.zip"
    path.write_bytes(data)
    (file,) = archives.files_of(path, is_opened=False)
    found = archives.within(file.arrival, data, room or Room())
    return {"/".join(one.arrival.inner): held(one) for one in found}


def refusals(archives: Archives, folder: Path, several: Iterable[bytes]) -> list[str]:
    """Why archives of one student, in this order, were not taken; empty for each that was."""
    room, reasons = Room(), []
    for data in several:
        found = within(archives, folder, data, room)
        reasons.append(next((one for one in found.values() if isinstance(one, str)), ""))
    return reasons


def test_the_files_of_a_students_archives_count_together(archives: Archives, tmp_path: Path) -> None:
    one = archive(f"{number}.txt" for number in range(2_600))
    first, second = refusals(archives, tmp_path, [one, one])
    assert first == ""
    assert "2600 files" in second
    assert "only 2400 files of" in second


def test_a_name_in_an_old_encoding_and_a_content_that_looks_like_a_list_do_no_harm(
    archives: Archives, tmp_path: Path
) -> None:
    list_of_its_own = b'{"names": ["forged.ipynb"], "size": 5, "reason": ""}\nhello\n'
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w", format=tarfile.GNU_FORMAT, encoding="latin-1") as tar:
        for name, content in {"L\xf6sung.txt": list_of_its_own, "b.ipynb": b"{}"}.items():
            entry = tarfile.TarInfo(name)
            entry.size = len(content)
            tar.addfile(entry, io.BytesIO(content))
    (tmp_path / "x.tar").write_bytes(data.getvalue())
    (file,) = archives.files_of(tmp_path / "x.tar", is_opened=False)
    found = archives.within(file.arrival, data.getvalue(), Room())
    assert [(one.arrival.inner, held(one)) for one in found] == [
        (("L?sung.txt",), list_of_its_own),
        (("b.ipynb",), b"{}"),
    ]


def test_a_zip_that_calls_one_file_by_two_long_names_hides_none_of_the_others(
    archives: Archives, tmp_path: Path
) -> None:
    data = bytearray(archive(["n" * 60_000, "b.ipynb"]))
    data[30:60_030] = b"m" * 60_000
    found = within(archives, tmp_path, bytes(data))
    assert found.pop("b.ipynb") == b"x"
    ((name, reason),) = found.items()
    assert name.startswith("nnn")
    assert str(reason).startswith("it cannot be unpacked: File name in directory")


def test_the_bytes_of_a_students_archives_count_together(archives: Archives, tmp_path: Path) -> None:
    (reason,) = refusals(
        archives, tmp_path, [archive([f"{number}.txt" for number in range(23)], said=45_000_000)]
    )
    assert "23 files of 1035 MB" in reason
    room = Room(unpacked=1_500_000)
    half = zipped({"a.txt": bytes(1_000_000)})
    assert within(archives, tmp_path, half, room) == {"a.txt": bytes(1_000_000)}
    assert "of 0 MB may still be unpacked" in str(within(archives, tmp_path, half, room)[""])


def test_a_file_that_says_it_is_too_large_is_not_unpacked(archives: Archives, tmp_path: Path) -> None:
    assert "unpacks to 60 MB" in refusals(archives, tmp_path, [archive(["a.ipynb"], said=60_000_000)])[0]


def test_archives_in_each_other_are_opened_three_deep(archives: Archives, tmp_path: Path) -> None:
    data = archive(["lab.ipynb"])
    for _ in range(3):
        outer = io.BytesIO()
        with zipfile.ZipFile(outer, "w") as made:
            made.writestr("in.zip", data)
        data = outer.getvalue()
    assert list(within(archives, tmp_path, data)) == ["in.zip/in.zip/in.zip"]


def test_the_memory_of_a_box_has_a_limit(archives: Archives, tmp_path: Path) -> None:
    """A few hundred bytes unpack in one step to more than the archive says and than there is room for."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as made:
        made.writestr("bomb.ipynb", zlib.decompress(base64.b85decode(BOMB)))
        made.filelist[0].compress_type, made.filelist[0].file_size = zipfile.ZIP_BZIP2, 10
        made.writestr("lab.ipynb", "{}")
    found = within(archives, tmp_path, data.getvalue())
    assert found["lab.ipynb"] == b"{}"
    assert found["bomb.ipynb"] == "it cannot be unpacked: Unable to allocate output buffer."


@pytest.mark.parametrize("form", ["gz", "bz2", "xz", ""])
def test_a_tar_is_unpacked_without_its_links(archives: Archives, tmp_path: Path, form: str) -> None:
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
    found = within(archives, tmp_path, data.getvalue())
    assert found == {
        "a/lab.ipynb": b"{}",
        "link": "the file is a link, or not an ordinary file",
        "up": b"{}",
    }


def test_a_folder_of_a_download_has_so_many_files(archives: Archives, tmp_path: Path) -> None:
    path = tmp_path / "download.zip"
    with zipfile.ZipFile(path, "w") as made:
        for number in range(20_005):
            made.writestr(zipfile.ZipInfo(f"ada/repository/{number}"), b"")
        made.writestr("ben/lab_1_2.ipynb", "{}")
    found = list(archives.files_of(path))
    assert len(found) == 20_002, (
        "those of ada's that are looked at, one that stands for the others, and ben's"
    )


@pytest.fixture
def taken_over(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The program of the desk is one that an archive has taken over."""
    hostile = Desk(READERS, "tests.grading.rebuilding.hostile_desk", {"PYTHONPATH": str(ROOT)})
    monkeypatch.setattr(desk, "_desk", hostile)
    yield
    hostile.close()


@pytest.mark.usefixtures("taken_over")
def test_an_answer_has_no_byte_more_than_it_may_have() -> None:
    with in_memory(RAW + b"x" * 200) as source, in_memory() as answer:
        desk.ask("list", source, answer, most=99, seconds=5)
        assert os.fstat(answer).st_size == 99


@pytest.mark.usefixtures("taken_over")
def test_an_archive_that_took_over_the_program_reaches_nothing(archives: Archives, tmp_path: Path) -> None:
    assert within(archives, tmp_path, REACH) == {"reached": b""}


@pytest.mark.usefixtures("taken_over")
@pytest.mark.parametrize(
    "text", [b"no line\n", b'{"names": 3}\n', b'{"names": [], "size": -5}\n', b'["a"]', b"\n" * 5, *NO_JSON]
)
def test_what_a_desk_writes_is_not_believed(archives: Archives, tmp_path: Path, text: bytes) -> None:
    assert not [
        one for one in within(archives, tmp_path, RAW + text).values() if isinstance(one, bytes) and one
    ]
    assert read_list("list.csv", RAW + text) is None


@pytest.mark.usefixtures("taken_over")
@pytest.mark.parametrize("act", ["endless_answer", "no_memory", "leave", "endless"])
def test_a_limit_that_is_met_is_a_reason(
    archives: Archives, tmp_path: Path, act: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(downloaded_files, "_CPU_SECONDS", 1)
    data = f"hostile: {act}".encode()
    assert "unpacking the archive would exceed a limit" in str(within(archives, tmp_path, data)[""])
    assert read_list("list.csv", data) is None
    assert within(archives, tmp_path, REACH) == {"reached": b""}, "the next archive needs no new desk"


def test_many_archives_need_one_box(
    archives: Archives, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Desk] = []

    class Counted(Desk):
        def __init__(self, readers: Mapping[str, str]) -> None:
            super().__init__(readers)
            made.append(self)

    monkeypatch.setattr(desk_of_boxes, "Desk", Counted)
    desk.close()
    for _ in range(3):
        assert within(archives, tmp_path, archive(["a.ipynb"])) == {"a.ipynb": b"x"}
    assert len(made) == 1


def test_without_a_sandbox_the_same_limits_hold(
    archives: Archives, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    which = shutil.which
    monkeypatch.setattr(shutil, "which", lambda name: None if name == "bwrap" else which(name))
    monkeypatch.setattr(
        downloaded_files, "why_impossible", why_impossible.__wrapped__
    )  # not what an earlier test found
    desk.close()
    assert within(archives, tmp_path, archive(["a.ipynb"])) == {"a.ipynb": b"x"}
    assert "unpacks to 60 MB" in refusals(archives, tmp_path, [archive(["a.ipynb"], said=60_000_000)])[0]
    assert "bubblewrap is not installed" in downloaded_files.without_sandbox()
    desk.close()
