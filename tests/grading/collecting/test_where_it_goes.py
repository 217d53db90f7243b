"""Nothing that is handed in is lost: each file is at its place, kept as an earlier attempt, or named with a reason."""

from __future__ import annotations

import io
import random
import shutil
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zoneinfo import ZoneInfo

import nbformat
import pytest
from click.testing import CliRunner
from downloads import write_zip, zipped
from test_collect import kept, lies, stamp, work
from test_collected_csv import edit
from tiny_class import TinyClass

from autograder.cli import cli
from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting import collected_csv, collected_files, submitted_folder
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import LineState
from autograder.grading.reporting.export_files import export
from autograder.grading.reporting.report_page import write_report
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from tiny_class import FakeEngine

    from autograder.grading.collecting.collect import CollectReport

UTC = ZoneInfo("UTC")
MOODLE = "{}_1_assignsubmission_file_{}"


def gathered(
    klass: TinyClass,
    folder: Path,
    files: Mapping[str, bytes | str],
    lists: Sequence[Path] = (),
    **options: Any,
) -> CollectReport:
    """Collect a zip of these files, with lists."""
    return collect(klass.path, [write_zip(folder / "c.zip", files), *lists], zone=UTC, **options)


def named(report: CollectReport, state: LineState) -> list[tuple[str, str]]:
    return [(one.label.removeprefix("c.zip/"), one.student) for one in report.having(state)]


def test_what_has_no_place_is_repeated_until_it_has_one(
    klass: TinyClass, fake_engine: FakeEngine, tmp_path: Path
) -> None:
    gathered(
        klass,
        tmp_path,
        {"lovelaceada_101_9001_lab_1_2.rar": b"Rar!", "bärben_102_9002_lab_1_2.ipynb": work(klass)},
    )
    label = "c.zip/lovelaceada_101_9001_lab_1_2.rar"
    graded = klass.grade()
    assert graded.exit_code == 2
    assert any(
        label in str(one.path) and "ada: archives of this kind" in one.reason for one in graded.refused
    )
    assert any("collected.csv, line 2, cell use" in one.reason for one in graded.refused)
    assert label in write_report(klass.path).read_text()
    assert label not in write_report(klass.path, names=False, to=tmp_path / "r.html").read_text()
    assert any(label in notice for notice in export(klass.path, "csv").ungraded)
    klass.submit("ada", 1, 1)
    edit(klass, "rar", use="no")
    assert any(
        "the file was edited after the last collect: to use the changes, type" in one.reason
        for one in klass.grade().refused
    )
    collect(klass.path)
    assert klass.grade().exit_code == 0
    assert not any(label in notice for notice in export(klass.path, "csv").ungraded)


def test_what_needs_no_place_is_left_out_by_a_cell(
    klass: TinyClass, fake_engine: FakeEngine, tmp_path: Path
) -> None:
    gathered(
        klass,
        tmp_path,
        {"guest_999_9001_lab_1_2.ipynb": work(klass), "bärben_102_9002_lab_1_2.ipynb": work(klass)},
    )
    assert klass.grade().exit_code == 2
    assert klass.grade(students=["ben"]).exit_code == 2, "nobody knows whose it is: it may be hers"
    edit(klass, "guest", use="no")
    assert CliRunner().invoke(cli, ["collect", str(klass.path)]).exit_code == 0
    assert klass.grade().exit_code == 0


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_two_files_of_one_name_in_an_archive_are_told_apart(klass: TinyClass, tmp_path: Path) -> None:
    names = ("lab_1_2.ipynb", "my.ipynb", "my.ipynb")
    with zipfile.ZipFile(tmp_path / "c.zip", "w") as archive:
        for points, name in enumerate(names):
            archive.writestr(MOODLE.format("Ada Lovelace", name), work(klass, points))
    report = collect(klass.path, [tmp_path / "c.zip"])
    assert lies(klass, "ada") == work(klass, 0)
    assert len(report.having(LineState.EARLIER)) == 2
    assert kept(klass) == sorted([work(klass, 1), work(klass, 2)])


def test_a_notebook_of_the_course_that_is_no_assignment_here_is_beside_the_work(
    klass: TinyClass, tmp_path: Path
) -> None:
    summary = nbformat.v4.new_notebook(cells=[nbformat.v4.new_markdown_cell("# Summary")])
    summary.cells[0].metadata["nbgrader"] = {"grade_id": "summary-1", "solution": False, "grade": False}
    work = nbformat.writes(klass.released())
    held = zipped({"summary.ipynb": nbformat.writes(summary), "lab_1_2.ipynb": work})
    report = gathered(klass, tmp_path, {MOODLE.format("Ada Lovelace", "work.zip"): held})
    assert report.exit_code == 0
    assert [one.label.rpartition("/")[2] for one in report.having(LineState.BESIDE)] == ["summary.ipynb"]


def test_a_notebook_of_another_assignment_that_was_put_there_by_hand_is_refused_with_its_page(
    klass: TinyClass, fake_engine: FakeEngine
) -> None:
    other = klass.released()
    named = [cell.metadata["nbgrader"] for cell in other.cells if "nbgrader" in cell.metadata]
    for marks in named[1:]:
        marks["grade_id"] = f"other-{marks['grade_id']}"
    klass.hand_in("ada", other)
    klass.submit("ben", 4, 7)
    report = klass.grade(feedback=True)
    assert fake_engine.ran == ["ben"]
    said = {row.reason for row in report.rows if row.student == "ada" and row.assignment == "lab_1_2"}
    reason = (
        "The cells of lab_1_2.ipynb belong to another assignment: hand in the notebook of this assignment."
    )
    assert said == {reason}
    page = (klass.path / "feedback" / "ada" / "lab_1_2" / "lab_1_2.html").read_text()
    assert reason in page
    assert "was missing. It was put back" not in page


def a_download(klass: TinyClass, chance: random.Random) -> dict[str, bytes | str]:
    """What students may hand in: notebooks of several names, archives in archives, pictures, rubbish."""
    files: dict[str, bytes | str] = {}
    for _ in range(chance.randint(1, 7)):
        student = chance.choice(["ada", "ben", "jose", "guest"])
        when = f"2025-10-0{chance.randint(1, 5)}-14-00-00"
        name = chance.choice(
            ["lab_1_2.ipynb", "lab_1_2 (1).ipynb", "old.ipynb", "lab_1_2.ipynb.txt", "a.png", "a.rar"]
        )
        held: bytes | str = work(klass, chance.randint(0, 4)) if "ipynb" in name else f"{chance.random()}"
        for depth in range(chance.choice([0, 0, 1, 2])):
            held, name = zipped({f"in/{name}": held}), f"pack{depth}.zip"
        style = chance.choice(["blackboard", "folder"])
        at = f"Lab_{student}_attempt_{when}_{name}" if style == "blackboard" else f"{student}/{when}/{name}"
        files[at] = held
    return files


def count(files: Mapping[str, bytes | str]) -> int:
    """How many files there are, those in archives of students included; a stranger's archive has one line."""
    total = 0
    for name, held in files.items():
        if name.endswith(".zip") and isinstance(held, bytes) and "guest" not in name:
            with zipfile.ZipFile(io.BytesIO(held)) as archive:
                total += count({one: archive.read(one) for one in archive.namelist()})
        else:
            total += 1
    return total


def outcome(klass: TinyClass) -> tuple[object, ...]:
    """What is in ``submitted``, and the table without its number."""
    folder = klass.path / "submitted"
    there = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    return there, Table(ClassDirectory(klass.path)).lines()


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_collected_in_any_order_and_again_gives_the_same(
    klass: TinyClass, tmp_path: Path, seed: int
) -> None:
    chance = random.Random(seed)
    zips = [write_zip(tmp_path / f"{number}.zip", a_download(klass, chance)) for number in range(4)]
    written: dict[str, str] = {}
    yes: set[str] = set()
    found = []
    for turn in range(3):
        copy = TinyClass(Path(shutil.copytree(klass.path, tmp_path / f"class{turn}")))
        for archive in chance.sample(zips, 4) + chance.sample(zips, turn):
            report = collect(copy.path, [archive], zone=UTC)
            for one in report.outcomes:
                assert one.reason or one.state in (LineState.PLACED, LineState.UNCHANGED), one
        for line in Table(ClassDirectory(copy.path)).lines() if turn == 0 else ():
            if line["counts"] == "waits" and line["student"]:
                # Of two attempts without a time, the first one counts until a person has said which.
                said = "no" if line["student"] in yes else chance.choice(["yes", "no"])
                yes |= {line["student"]} if said == "yes" else set()
                written[line["file"].rpartition(" ")[2][:11]] = said
        for key, word in written.items():
            edit(copy, key, use=word)
        collect(copy.path)
        found.append(outcome(copy))
    assert found[0] == found[1] == found[2]


class Killed(BaseException):
    """The process ends here."""


@pytest.mark.parametrize("at", range(1, 14))
def test_killed_at_any_write_nothing_is_lost_and_nothing_is_there_twice(
    klass: TinyClass, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, at: int
) -> None:
    first = {
        "Lab_ada_attempt_2025-10-03-14-00-00_lab_1_2.ipynb": work(klass, 1),
        "Lab_ben_attempt_2025-10-03-14-00-00_lab_1_2.ipynb": work(klass, 1),
    }
    second = {
        "Lab_ada_attempt_2025-10-04-14-00-00_lab_1_2.ipynb": work(klass, 2),
        "Lab_ben_attempt_2025-10-02-14-00-00_lab_1_2.ipynb": work(klass, 3),
        "Lab_eve_attempt_2025-10-02-14-00-00_lab_1_2.rar": "Rar!",
    }
    written = write_whole
    left = at

    def write(path: Path, data: bytes) -> None:
        nonlocal left
        left -= 1
        if left == 0:
            raise Killed
        written(path, data)

    with monkeypatch.context() as patch:
        for module in (submitted_folder, collected_files, collected_csv):
            patch.setattr(module, "write_whole", write)
        try:
            gathered(klass, tmp_path, first)
            gathered(klass, tmp_path, second)
        except Killed:
            pass
    gathered(klass, tmp_path, first)
    report = gathered(klass, tmp_path, second)
    assert (lies(klass, "ada"), lies(klass, "ben")) == (work(klass, 2), work(klass, 1))
    assert (stamp(klass, "ada")[:10], stamp(klass, "ben")[:10]) == ("2025-10-04", "2025-10-03")
    assert {student for _, student in named(report, LineState.NOT_PLACED)} == {"eve"}
    assert {work(klass, 1), work(klass, 3)} <= set(kept(klass))
