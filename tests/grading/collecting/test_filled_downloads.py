"""One student fills a download, or names files as no text can be: the others' work comes to its place all the same."""

from __future__ import annotations

import os
import struct
import subprocess
import time
from typing import TYPE_CHECKING

import pytest
from downloads import write_zip, zipped
from test_collect import placed, why, work
from test_collected_csv import edit
from tiny_class import LISTENER, TALKER

from autograder.grading.collecting import downloaded_files
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState
from autograder.grading.collecting.submitted_file_names import base_of
from autograder.grading.rebuilding.submitted_notebook import read_bytes
from autograder.safe_files import remove_unfinished

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from tiny_class import FakeEngine, TinyClass

NO_TEXT = os.fsdecode(b"lab_1_2 \xff.ipynb")
MB = 1_000_000


@pytest.fixture
def deep(tmp_path: Path) -> Iterator[Path]:
    """A folder with more folders in each other than Python has room for calls."""
    folder = tmp_path / "deep"
    folder.mkdir()
    here = os.open(folder, os.O_RDONLY)
    for _ in range(1500):
        os.mkdir("d", dir_fd=here)
        inside = os.open("d", os.O_RDONLY, dir_fd=here)
        os.close(here)
        here = inside
    os.close(here)
    yield folder
    subprocess.run(["rm", "-rf", folder], check=True)  # shutil.rmtree is among what does not come back


def cloned(klass: TinyClass, folder: Path) -> Path:
    """A download with a folder for each of two students."""
    for student in ("ada", "zoe"):
        (folder / student).mkdir(parents=True)
        (folder / student / "lab_1_2.ipynb").write_text(work(klass))
    return folder


def in_moodle(klass: TinyClass, path: Path, of_ben: dict[str, bytes]) -> Path:
    files = {f"Ben Bär_2_assignsubmission_file_/{name}": data for name, data in of_ben.items()}
    return write_zip(path, {**files, "Zoë Zuse_3_assignsubmission_file_/lab_1_2.ipynb": work(klass)})


def test_the_archives_of_one_student_have_one_room(
    klass: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(downloaded_files.Room.__init__, "__defaults__", (100, 10 * MB))
    blanks = zipped({"x.txt": b" " * (4 * MB)})
    of_ben = {f"{number}.zip": blanks for number in range(4)}
    report = collect(klass.path, [in_moodle(klass, tmp_path / "m.zip", of_ben)])
    assert placed(report).keys() == {"zoe"}
    assert report.exit_code == 2
    refused = [one for one in report.having(LineState.NOT_PLACED) if one.label.endswith(".zip")]
    assert [(one.student, one.label[-5:]) for one in refused] == [("ben", "2.zip"), ("ben", "3.zip")]
    assert "the archive has 1 files of 4 MB, but only 98 files of 2 MB may still be unpacked" in why(report)
    for number in range(4):  # named one by one, they have no more
        (tmp_path / f"barben_102_9{number}00_x.zip").write_bytes(blanks)
    report = collect(klass.path, sorted(tmp_path.glob("barben*.zip")))
    refused_labels = [one.label for one in report.outcomes if "may still be unpacked" in one.reason]
    assert refused_labels == ["barben_102_9200_x.zip", "barben_102_9300_x.zip"]


def hollow(archive: bytes, damage: str) -> bytes:
    """An archive that says what cannot be, as nobody's program does."""
    data, entry, end = bytearray(archive), archive.rfind(b"PK\x01\x02"), archive.rfind(b"PK\x05\x06")
    if damage == "a name in no letters":
        place = data.index("é".encode())
        data[place : place + 2] = b"\xff\xfe"
    elif damage == "no name":
        data[entry + 46 : entry + 48] = b"\0x"  # the name ends before it
    elif damage == "before the beginning":
        struct.pack_into("<I", data, end + 16, 0xFFFF0000)
        struct.pack_into("<I", data, end + 12, end - entry)
    else:
        extra = struct.pack("<HHQ", 1, 8, 2**64 - 1)
        data[end:end] = extra
        struct.pack_into("<I", data, entry + 42, 0xFFFFFFFF)
        struct.pack_into("<H", data, entry + 30, len(extra))
        struct.pack_into("<I", data, end + len(extra) + 12, end - entry + len(extra))
    return bytes(data)


@pytest.mark.parametrize(
    "damage", ["a name in no letters", "no name", "before the beginning", "behind any end"]
)
def test_an_archive_that_says_what_cannot_be_keeps_nobodys_work_from_being_collected(
    klass: TinyClass, tmp_path: Path, damage: str
) -> None:
    """Python raised what nobody expected of a broken archive, and the whole command ended."""
    of_ben = {"x.zip": hollow(zipped({"é.ipynb": work(klass)}), damage)}
    report = collect(klass.path, [in_moodle(klass, tmp_path / "m.zip", of_ben)])
    assert placed(report).keys() == {"zoe"}
    assert [one.student for one in report.having(LineState.NOT_PLACED)] == ["ben"]


def test_a_name_longer_than_any_floods_nobody(klass: TinyClass, tmp_path: Path) -> None:
    long = zipped({f"lab_1_2{'(1)' * 20_000}.ipynb": work(klass), "lab_1_2.ipynb": work(klass)})
    report = collect(klass.path, [in_moodle(klass, tmp_path / "m.zip", {"w.zip": long})])
    assert placed(report).keys() == {"ben", "zoe"}
    assert max(len(one.label) for one in report.outcomes) < 1200


def test_a_name_with_many_numbers_is_read_in_a_moment() -> None:
    began = time.process_time()
    assert base_of("lab" + "-1 (2)" * 10_000) == "lab"
    assert time.process_time() - began < 10


def test_what_a_class_hands_in_together_is_in_nobodys_room(
    klass: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(downloaded_files.Room.__init__, "__defaults__", (20, MB))
    ids = [f"s{number:03}" for number in range(30)]
    (klass.path / "students.csv").write_text("\n".join(["id", *ids]))
    archive = zipped({"lab_1_2.ipynb": work(klass), "bag.db3": bytes(MB // 3)})
    files = {f"{id_}/{attempt}.zip": archive for id_ in ids for attempt in range(2)}
    assert placed(collect(klass.path, [write_zip(tmp_path / "m.zip", files)])).keys() == set(ids)


@pytest.mark.parametrize("form", ["folder", "zip", "folder around"])
def test_who_has_too_many_files_hides_nobody_behind(
    klass: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str
) -> None:
    monkeypatch.setattr(downloaded_files, "MOST_FILES", 20)
    download = cloned(klass, tmp_path / "download")
    for number in range(30):
        (download / "ben" / "node_modules").mkdir(parents=True, exist_ok=True)
        (download / "ben" / "node_modules" / f"{number}.js").write_text("x")
    label = "download/ben/node_modules"
    if form == "zip":
        files = {str(path.relative_to(tmp_path)): path.read_bytes() for path in download.rglob("*.*")}
        download, label = (
            write_zip(tmp_path / "download.zip", files),
            "download.zip/download/ben/node_modules",
        )
    elif form == "folder around":
        (tmp_path / "all").mkdir()
        download, label = download.rename(tmp_path / "all" / "download").parent, "all/download/ben"
    report = collect(klass.path, [download])
    assert placed(report).keys() == {"ada", "zoe"}
    assert f"{label}: the folder has more than 20 files; the other files were not read" in why(report)
    assert report.exit_code == 2


def test_a_name_that_is_no_text_keeps_nobodys_work_from_being_collected(
    klass: TinyClass, tmp_path: Path
) -> None:
    download = cloned(klass, tmp_path / "download")
    (download / "ben").mkdir()
    (download / "ben" / NO_TEXT).write_text(work(klass, 3))
    (download / "ben" / os.fsdecode(b"\xff")).mkdir()
    (download / "ben" / os.fsdecode(b"\xff") / "a.zip").write_bytes(b"no zip")
    report = collect(klass.path, [download])
    assert placed(report) == {"ada": "lab_1_2.ipynb", "zoe": "lab_1_2.ipynb", "ben": "lab_1_2 ?.ipynb"}
    assert "download/ben/?/a.zip: " in why(report)
    assert collect(klass.path, [download]).having(LineState.UNCHANGED)


@pytest.mark.parametrize("where", ["lab_1_2", "."])
def test_a_name_that_is_no_text_keeps_nobodys_work_from_being_graded(
    tiny: TinyClass, fake_engine: FakeEngine, where: str
) -> None:
    tiny.submit("ada", 4, 7)
    folder = tiny.submit("ben", 10, 10).parent.parent / where
    (folder / NO_TEXT).write_text("{}")
    tiny.grade()
    assert tiny.scores("ada") == {TALKER: 4, LISTENER: 7}
    assert tiny.scores("ben") == {TALKER: 10, LISTENER: 10}


def test_folders_without_end_keep_nobodys_work_from_being_collected(
    klass: TinyClass, tmp_path: Path, deep: Path
) -> None:
    download = cloned(klass, tmp_path / "download")
    (download / "ben").mkdir()
    deep.rename(download / "ben" / "deep")
    try:
        report = collect(klass.path, [download])
    finally:
        (download / "ben" / "deep").rename(deep)
    assert placed(report).keys() == {"ada", "zoe"}
    assert "folders are nested more than 100 deep" in why(report)
    assert report.exit_code == 2


def test_what_a_killed_run_left_is_found_beside_names_and_folders_of_any_kind(
    tmp_path: Path, deep: Path
) -> None:
    left, other = deep / ".lab_1_2.ipynb.123.new", deep / NO_TEXT
    left.touch()
    other.touch()
    remove_unfinished(tmp_path)
    assert (left.exists(), other.exists()) == (False, True)


def test_folders_without_end_keep_nobodys_work_from_being_read_where_a_backup_has_links(
    tiny: TinyClass, tmp_path: Path, deep: Path
) -> None:
    path = tiny.submit("ada", 4, 7)
    (tmp_path / "backup.ipynb").hardlink_to(path)
    deep.rename(tiny.path / "submitted" / "ben")
    try:
        assert read_bytes(path) == path.read_bytes()
    finally:
        (tiny.path / "submitted" / "ben").rename(deep)


@pytest.mark.parametrize(
    "when", ["9999-12-31T23:59:59-05:00", "9999-12-31T23:59:59Z", "0001-01-01T00:00:00+05:00"]
)
def test_a_time_that_no_clock_shows_is_none(klass: TinyClass, tmp_path: Path, when: str) -> None:
    klass.configure('c.NbGraderAPI.timezone = "Asia/Kolkata"')
    times = tmp_path / "times.csv"
    times.write_text(
        "Identifier,Full name,Grade,Last modified (submission)\n"
        f"Participant 2,Ben Bär,,{when}\nParticipant 3,Zoë Zuse,,2025-10-03T12:00Z\n"
    )
    report = collect(
        klass.path, [in_moodle(klass, tmp_path / "m.zip", {"lab_1_2.ipynb": work(klass).encode()}), times]
    )
    assert {one.student: one.when and one.when.year for one in report.having(LineState.PLACED)} == {
        "ben": None,
        "zoe": 2025,
    }
    edit(klass, "Ben", handed_in=when)
    (note,) = collect(klass.path).notes
    assert f"column handed_in: '{when}' is not a time" in note


def test_a_long_text_in_an_lmss_list_keeps_nobodys_time_from_being_read(
    klass: TinyClass, tmp_path: Path
) -> None:
    worksheet = tmp_path / "Grades.csv"
    worksheet.write_text(
        "Identifier,Full name,Grade,Last modified (submission),Online text\n"
        f"Participant 2,Ben Bär,,-,{'x' * 200_000}\n"
        'Participant 3,Zoë Zuse,,"Friday, 3 October 2025, 2:05 PM",\n'
    )
    report = collect(klass.path, [in_moodle(klass, tmp_path / "m.zip", {}), worksheet])
    assert [one.when and one.when.year for one in report.having(LineState.PLACED)] == [2025]
