"""What an LMS lets an instructor download lies in its place afterwards, or has a line that says why it does not."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import tracemalloc
import unicodedata
import zipfile
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

import pytest
from click.testing import CliRunner
from downloads import write_zip, zipped
from test_real_forms import gradescope_export

from autograder.boxes import reading_desks
from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import Inbox, LineState
from autograder.grading.grading_errors import GradingError
from autograder.grading.tasks.submission_times import is_not_believed, read_timestamp

if TYPE_CHECKING:
    from tiny_class import FakeEngine, TinyClass

    from autograder.grading.collecting.collect import CollectReport


def work(klass: TinyClass, talker: object = 10, listener: object = 10) -> str:
    path = klass.submit("nobody", talker, listener)
    text = path.read_text()
    for part in (path, path.parent, path.parent.parent):
        part.unlink() if part.is_file() else part.rmdir()
    return text


def placed(report: CollectReport) -> dict[str, str]:
    return {one.student: one.label.rpartition("/")[2] for one in report.having(LineState.PLACED)}


def why(report: CollectReport) -> str:
    return "\n".join(f"{one.label}: {one.reason}" for one in report.having(LineState.NOT_PLACED))


def kept(klass: TinyClass) -> list[str]:
    """The texts of all notebooks in the inbox that do not count."""
    inbox = Inbox(klass.path / ".autograder")
    lines = Table(ClassDirectory(klass.path)).lines()
    earlier = {line["file"].rpartition(" ")[2] for line in lines if line["counts"] in ("earlier", "waits")}
    arrivals = (one for delivery in inbox.deliveries.values() for one in delivery.arrivals)
    contents = {one.content for one in arrivals if one.key in earlier}
    return sorted(inbox.read(content).decode(errors="replace") for content in contents)


def lies(klass: TinyClass, student: str) -> str:
    return (klass.path / "submitted" / student / "lab_1_2" / "lab_1_2.ipynb").read_text()


def stamp(klass: TinyClass, student: str) -> str:
    return (klass.path / "submitted" / student / "lab_1_2" / "timestamp.txt").read_text().strip()


def test_names_that_a_mac_writes_are_the_same_names(klass: TinyClass, tmp_path: Path) -> None:
    name = unicodedata.normalize("NFD", "José Núñez_12346_assignsubmission_file_lab_1_2.ipynb")
    report = collect(klass.path, [write_zip(tmp_path / "m.zip", {name: work(klass)})])
    assert placed(report).keys() == {"jose"}


def test_what_is_kept_is_not_larger_than_what_was_sent(klass: TinyClass, tmp_path: Path) -> None:
    names = [f"lab_1_2 ({number}).ipynb" for number in range(1, 6)]
    with zipfile.ZipFile(tmp_path / "work.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for name in names:
            archive.writestr(name, name.encode() + bytes(1_000_000))
    sent = (tmp_path / "work.zip").read_bytes()
    write_zip(tmp_path / "a.zip", {"Lab_ada_attempt_2025-10-03-14-00-00_work.zip": sent})
    report = collect(klass.path, [tmp_path / "a.zip"])
    assert len(report.having(LineState.NOT_PLACED)) == 5
    inbox = klass.path / ".autograder" / "inbox"
    assert sum(path.stat().st_size for path in inbox.glob("*.zip")) <= 3 * len(sent)


def test_only_the_collectors_time_counts(klass: TinyClass, fake_engine: FakeEngine, tmp_path: Path) -> None:
    from nbgrader.api import Gradebook

    archive = {
        "Lab_ada_attempt_2025-10-03-14-00-00_lab_1_2.ipynb": work(klass),
        "Lab_ada_attempt_2025-10-03-14-00-00_timestamp.txt": "2025-01-01 00:00:00 UTC",
    }
    collect(klass.path, [write_zip(tmp_path / "b.zip", archive)], zone=ZoneInfo("UTC"))
    klass.submit("ben").with_name("timestamp.txt").write_text("2025-01-01 00:00:00.000000 UTC")
    folder = klass.path / "submitted" / "ada" / "lab_1_2"
    (folder / "timestamp.txt").write_text("2025-01-01 00:00:00.000000 UTC")
    report = klass.grade()
    with Gradebook(f"sqlite:///{klass.path / 'gradebook.db'}") as book:
        assert book.find_submission("lab_1_2", "ada").timestamp == datetime(2025, 10, 3, 14)
        assert book.find_submission("lab_1_2", "ben").timestamp is None
    assert any("ben/lab_1_2" in notice and "timestamp.txt" in notice for notice in report.notices)


def test_a_file_without_a_place_takes_no_time_from_an_exchange(klass: TinyClass, tmp_path: Path) -> None:
    there = klass.submit("ben").with_name("timestamp.txt")
    there.write_text("2025-10-03 14:00:00.000000 UTC")
    stranger = write_zip(tmp_path / "c.zip", {"nobody_999_9001_lab_1_2.ipynb": work(klass, 3)})
    assert [one.state for one in collect(klass.path, [stranger], zone=ZoneInfo("UTC")).outcomes] == [
        LineState.NOT_PLACED
    ]
    assert read_timestamp(there.parent) == there.read_text()
    assert not is_not_believed(there.parent)


def test_a_link_in_a_downloaded_folder_goes_nowhere(klass: TinyClass, tmp_path: Path) -> None:
    folder = tmp_path / "in" / "Ada Lovelace_1_assignsubmission_file"
    folder.mkdir(parents=True)
    (folder / "lab_1_2.ipynb").symlink_to("/etc/passwd")
    report = collect(klass.path, [folder.parent], form="moodle")
    assert (placed(report), "is a link" in why(report)) == ({}, True)


def test_a_bomb_is_harmless(klass: TinyClass, tmp_path: Path) -> None:
    bomb = tmp_path / "bomb.zip"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb", b" " * 60_000_000)
    assert "the limit is 50 MB" in why(collect(klass.path, [bomb]))
    # One that lies about its size: the list says 10 bytes.
    data = bytearray(bomb.read_bytes())
    place = data.rfind(b"PK\x01\x02")
    struct.pack_into("<I", data, place + 24, 10)
    bomb.write_bytes(data)
    report = collect(klass.path, [bomb])
    assert report.having(LineState.PLACED) == ()
    assert report.having(LineState.NOT_PLACED)


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_every_method_that_python_knows_is_unpacked(klass: TinyClass, tmp_path: Path, method: int) -> None:
    member = "Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb"
    with zipfile.ZipFile(tmp_path / "m.zip", "w", method) as archive:
        archive.writestr(member, work(klass))
    inner = {"Ben Bär_2_assignsubmission_file_lab.zip": (tmp_path / "m.zip").read_bytes()}
    report = collect(klass.path, [tmp_path / "m.zip", write_zip(tmp_path / "n.zip", inner)])
    assert placed(report).keys() == {"ada", "ben"}


def test_what_unpacks_to_gigabytes_is_held_as_small_as_it_came(klass: TinyClass, tmp_path: Path) -> None:
    """16 kB, handed in by one student, took 4 GB of the grader's memory with files of 49 MB."""
    inner = zipped({f"{number}/lab_1_2.ipynb": b" " * 4_000_000 for number in range(4)})
    files = {f"Ben Bär_2_assignsubmission_file_/{number}.zip": inner for number in range(3)}
    files["Ada Lovelace_1_assignsubmission_file_/lab_1_2.ipynb"] = work(klass).encode()
    download = write_zip(tmp_path / "d.zip", files)
    tracemalloc.start()
    try:
        assert placed(collect(klass.path, [download])).keys() == {"ada"}
        assert tracemalloc.get_traced_memory()[1] < 40_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("damage", ["cut", "list", "crc", "text", "encrypted"])
def test_a_damaged_archive_is_one_line(klass: TinyClass, tmp_path: Path, damage: str) -> None:
    name = "Ada Lovelace_1_assignsubmission_file_lab_1_2.ipynb"
    data = bytearray(zipped({name: work(klass)}))
    end = data.rfind(b"PK\x05\x06")
    if damage == "cut":
        data = data[: end - 5]
    elif damage == "list":
        struct.pack_into("<I", data, end + 12, 0xF0000000)
    elif damage == "crc":
        data[60] ^= 0xFF
    elif damage == "text":
        data = bytearray(b"no zip at all")
    else:
        place = data.rfind(b"PK\x01\x02")
        data[place + 8] |= 1
    (tmp_path / "m.zip").write_bytes(data)
    report = collect(klass.path, [tmp_path / "m.zip"])
    assert report.having(LineState.PLACED) == ()
    assert len(report.having(LineState.NOT_PLACED)) == 1
    if damage == "encrypted":
        assert "encrypted" in why(report)


def test_the_command_says_everything(klass: TinyClass, tmp_path: Path) -> None:
    archive = write_zip(
        tmp_path / "c.zip",
        {"lovelaceada_LATE_101_9001_lab_1_2.ipynb": work(klass), "guest_999_9002_lab_1_2.ipynb": work(klass)},
    )
    result = CliRunner().invoke(cli, ["collect", str(klass.path), str(archive)])
    assert result.exit_code == 2, result.output
    assert "placed       ada/lab_1_2" in result.output
    assert "late according to the LMS" in result.output
    assert (
        "not placed   c.zip/guest_999_9002_lab_1_2.ipynb: no student in the class is called guest"
        in result.output
    )
    assert "nothing of   lab_1_2: ben, eve, jose, zoe" in result.output
    for arguments in (
        ["nowhere.zip"],
        [str(archive), "--assignment", "x"],
        [str(archive), "--timezone", "../x"],
    ):
        assert CliRunner().invoke(cli, ["collect", str(klass.path), *arguments]).exit_code == 2
    with pytest.raises(GradingError, match="There is no nowhere"):
        collect(klass.path, [Path("nowhere.zip")])


def test_a_terminal_without_utf_8_collects_the_same(klass: TinyClass, tmp_path: Path) -> None:
    archive = write_zip(tmp_path / "m.zip", {"José Núñez_7_assignsubmission_file_lab_1_2.ipynb": work(klass)})
    command = [sys.executable, "-m", "autograder", "collect", str(klass.path), str(archive)]
    (klass.path / "students.csv").unlink()
    environ = {**os.environ, "PYTHONUTF8": "0", "LC_ALL": "C"}
    done = subprocess.run(command, env=environ, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b""), done
    assert "José" in done.stdout.decode()
    assert [path.name for path in (klass.path / "submitted").iterdir()] == ["José Núñez"]


def test_a_list_that_takes_gigabytes_to_read_is_a_line_that_waits(
    klass: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """50 MB of YAML took 4.6 GB of memory; now the memory of the desk ends that, and a smaller one ends it sooner."""
    monkeypatch.setattr(reading_desks, "MEMORY_BYTES", 200_000_000)
    files = gradescope_export("assignment_1_export/", work(klass, 1), work(klass, 2))
    (name,) = (name for name in files if name.endswith(".yml"))
    files[name] += "a: b\n" * 1_000_000
    report = collect(klass.path, [write_zip(tmp_path / "export.zip", files)])
    assert placed(report) == {}
    assert "submission_metadata.yml: the file is too large, or not a known list" in why(report)


@pytest.mark.parametrize("name", ["x" * 1_001, "..\\x", "a/../../x", "x/" * 600 + "x"])
def test_no_name_that_is_refused_takes_the_folder_around_all_away(
    klass: TinyClass, tmp_path: Path, name: str
) -> None:
    root = "assignment_8046601_export"
    files = gradescope_export(f"{root}/", work(klass, 1), work(klass, 2))
    with zipfile.ZipFile(tmp_path / "export.zip", "w") as archive:
        for path, content in files.items():
            archive.writestr(path, content)
        archive.writestr(f"{root}/submission_500000001/{name}", "x")
    report = collect(klass.path, [tmp_path / "export.zip"])
    assert placed(report).keys() == {"ada", "ben", "jose"}
    labels = [one.label for one in report.outcomes if "submission_500000001/lab_1_2" not in one.label]
    (refused,) = (label for label in labels if label.startswith(f"export.zip/{root}/submission_500000001/"))
    assert len(refused) < 1_200


def test_a_named_file_whose_name_is_no_text_is_one_line(klass: TinyClass, tmp_path: Path) -> None:
    """As unzip leaves them that knows no accents, with download/*."""
    for name in (
        "Jos\udce9_12_assignsubmission_file_lab_1_2.ipynb",
        "Ben Bär_13_assignsubmission_file_x.ipynb",
    ):
        (tmp_path / name).write_text(work(klass))
    (tmp_path / "Zo\udceb_14_assignsubmission_file_").mkdir()
    (tmp_path / "Zo\udceb_14_assignsubmission_file_" / "lab_1_2.ipynb").write_text(work(klass))
    (tmp_path / "Zo\udceb_15_assignsubmission_file_x.zip").write_bytes(zipped({"lab_1_2.ipynb": work(klass)}))
    (tmp_path / "Zo\udceb.zip").write_bytes(
        zipped({"Ada Lovelace_1_assignsubmission_file_x.ipynb": work(klass)})
    )
    sources = sorted(path for path in tmp_path.iterdir() if "_file_" in path.name)
    report = collect(klass.path, sources)
    assert placed(report).keys() == {"ben"}
    assert os.fsencode(why(report)) == why(report).encode()
    assert "no student in the class is called Jos?" in why(report)
    report = collect(klass.path, [tmp_path / "Zo\udceb.zip"])
    assert placed(report).keys() == {"ada"}
