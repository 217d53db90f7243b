"""Times of handing in come from lists and from the instructor, and no time that is known gives way to none."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from click.testing import CliRunner
from downloads import write_zip
from test_collect import lies, stamp, why, work
from test_collected_csv import edit
from test_where_it_goes import MOODLE, gathered

from autograder.cli import cli
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass


def test_times_are_cells_also_of_what_a_person_has_put_there(klass: TinyClass, tmp_path: Path) -> None:
    late = {
        "lovelaceada_LATE_101_9001_lab_1_2.ipynb": work(klass),
        "bärben_102_9002_lab_1_2.ipynb": work(klass),
    }
    report = gathered(klass, tmp_path, late)
    assert report.untimed == {"lab_1_2": ("ada", "ben")}
    klass.submit("zoe")
    nothing = write_zip(tmp_path / "empty.zip", {})
    report = collect(klass.path, [nothing])
    assert report.notes == (f"{nothing} contains no file, or only files that programs leave there",)
    edit(klass, "lovelaceada", handed_in="2025-10-03T14:05Z")
    edit(klass, "submitted/zoe", handed_in="2025-10-04 10:00:00 +0200")
    collect(klass.path)
    assert stamp(klass, "ada") == "2025-10-03 14:05:00.000000 UTC"
    assert stamp(klass, "zoe") == "2025-10-04 08:00:00.000000 UTC"
    assert not (klass.path / "submitted" / "ben" / "lab_1_2" / "timestamp.txt").exists()
    mine = lies(klass, "zoe")
    gathered(klass, tmp_path, {"zusezoe_105_9002_lab_1_2.ipynb": work(klass, 2)})
    assert lies(klass, "zoe") == mine, "what the instructor has put there is not overwritten for it"
    times = tmp_path / "times.csv"
    times.write_text("id,handed_in\nada,today\n")
    report = collect(klass.path, [times])
    assert "Write times into the column handed_in of collected.csv" in why(report)


def test_times_are_shown_in_the_time_zone_of_the_class(klass: TinyClass, tmp_path: Path) -> None:
    """The due dates that `grade` shows are in this time zone, so an instructor compares the two at a glance."""
    klass.configure('c.NbGraderAPI.timezone = "Asia/Kolkata"')
    folder = tmp_path / "download"
    timed = folder / "Lab_ada_attempt_2025-10-03-14-00-00_lab_1_2.ipynb"
    folder.mkdir()
    timed.write_text(work(klass, 1))
    command = ["collect", str(klass.path), str(folder), "--timezone", "Europe/Berlin"]
    assert "handed in 2025-10-03 17:30 Asia/Kolkata" in CliRunner().invoke(cli, command).output
    report = gathered(klass, tmp_path, {MOODLE.format("Ada Lovelace", "lab_1_2.ipynb"): work(klass, 2)})
    assert "handed in 2025-10-03 17:30 Asia/Kolkata: write the file's time under handed_in" in why(report)
    assert stamp(klass, "ada") == "2025-10-03 12:00:00.000000 UTC"


def test_handed_in_says_it_of_what_nothing_else_does(klass: TinyClass, tmp_path: Path) -> None:
    gathered(
        klass,
        tmp_path,
        {"lovelaceada_LATE_101_9001_lab_1_2.ipynb": work(klass)},
        handed_in=datetime(2025, 10, 3, 14, 5),
    )
    assert stamp(klass, "ada") == "2025-10-03 14:05:00.000000 UTC"
    archive = str(tmp_path / "c.zip")
    said = CliRunner().invoke(cli, ["collect", str(klass.path), archive, "--handed-in", "noon"])
    assert (said.exit_code, "--handed-in noon is not a time" in said.output) == (2, True)


def test_what_came_without_a_time_does_not_replace_what_has_one(klass: TinyClass, tmp_path: Path) -> None:
    gathered(klass, tmp_path, {"Lab_ada_attempt_2025-10-03-14-00-00_lab_1_2.ipynb": work(klass, 1)})
    report = gathered(klass, tmp_path, {MOODLE.format("Ada Lovelace", "lab_1_2.ipynb"): work(klass, 2)})
    assert "it is unknown whether this file is newer than" in why(report)
    assert "write the file's time under handed_in" in why(report)
    assert lies(klass, "ada") == work(klass, 1)


def test_a_newer_file_of_canvas_without_a_time_does_not_replace_what_has_one(
    klass: TinyClass, tmp_path: Path
) -> None:
    """It may be late, and would count as if it had been handed in on time."""
    canvas = "lovelaceada_LATE_101_{}_lab_1_2.ipynb"
    gathered(klass, tmp_path, {canvas.format(9002): work(klass, 2)}, handed_in=datetime(2025, 10, 3, 14))
    for number, points in ((9003, 3), (9004, 1)):
        report = gathered(klass, tmp_path, {canvas.format(number): work(klass, points)})
        assert "it is unknown whether this file is newer" in why(report)
        assert (lies(klass, "ada"), stamp(klass, "ada")[:10]) == (work(klass, 2), "2025-10-03")
    report = gathered(klass, tmp_path, {canvas.format(9001): work(klass, 1)})
    assert [one.state for one in report.outcomes] == [LineState.EARLIER]
    late = {canvas.format(9003): work(klass, 3)}
    gathered(klass, tmp_path, late, handed_in=datetime(2025, 10, 9, 14))
    assert (lies(klass, "ada"), stamp(klass, "ada")[:10]) == (work(klass, 3), "2025-10-09")
    report = gathered(klass, tmp_path, {canvas.format(9005): work(klass, 2)})
    assert [one.state for one in report.outcomes] == [LineState.NOT_PLACED], (
        "the first again, at a time that is unknown"
    )
