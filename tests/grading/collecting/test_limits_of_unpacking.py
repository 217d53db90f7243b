"""Each limit of what is unpacked holds at its own number: raised a hundredfold, one of these tests fails."""

from __future__ import annotations

import io
import zipfile
from typing import TYPE_CHECKING

from autograder.grading.collecting.archives import File, NotTaken, Room, files_of, within

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


def archive(names: Iterable[str], said: int = 1) -> bytes:
    """An archive of tiny files that says of each that it unpacks to this many bytes."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as made:
        for name in names:
            made.writestr(name, b"x")
        for entry in made.filelist:
            entry.file_size = said
    return data.getvalue()


def refusals(folder: Path, archives: Iterable[bytes]) -> list[str]:
    """Why archives of one student, in this order, were not taken; empty for each that was."""
    room, reasons = Room(), []
    for number, data in enumerate(archives):
        path = folder / f"{number}.zip"
        path.write_bytes(data)
        (file,) = files_of(path, opened=False)
        assert isinstance(file, File)
        refused = [str(held) for _, held in within(file, data, room) if isinstance(held, NotTaken)]
        reasons.append(refused[0] if refused else "")
    return reasons


def test_the_files_of_a_students_archives_count_together(tmp_path: Path) -> None:
    one = archive(f"{number}.txt" for number in range(2_600))
    first, second = refusals(tmp_path, [one, one])
    assert first == ""
    assert "with the student's other archives, more than 5000 files" in second


def test_the_bytes_of_a_students_archives_count_together(tmp_path: Path) -> None:
    one = archive([f"{number}.txt" for number in range(10)], said=45_000_000)
    *first, third = refusals(tmp_path, [one, one, one])
    assert first == ["", ""]
    assert "more than 5000 files or 1000 MB" in third


def test_a_file_that_says_it_is_too_large_is_not_unpacked(tmp_path: Path) -> None:
    assert "unpacks to 60 MB" in refusals(tmp_path, [archive(["a.ipynb"], said=60_000_000)])[0]


def test_the_list_of_a_students_archive_is_short(tmp_path: Path) -> None:
    (reason,) = refusals(tmp_path, [archive(f"{number:0120}.txt" for number in range(2_400))])
    assert "list" in reason


def test_a_folder_of_a_download_has_so_many_files(tmp_path: Path) -> None:
    path = tmp_path / "download.zip"
    with zipfile.ZipFile(path, "w") as made:
        for number in range(20_005):
            made.writestr(zipfile.ZipInfo(f"ada/repository/{number}"), b"")
        made.writestr("ben/lab_1_2.ipynb", "{}")
    found = list(files_of(path))
    assert len(found) == 20_002, (
        "those of ada's that are looked at, one that stands for the others, and ben's"
    )
