"""What came from Blackboard, Brightspace, Sakai or ILIAS goes back there: points and pages."""

from __future__ import annotations

import csv
import io
import zipfile
from typing import TYPE_CHECKING

import pytest
from downloads import ROSTER, write_zip
from instructor import by_person
from test_collect import work
from tiny_class import TALKER

from autograder.grading.collecting.collect import collect
from autograder.grading.reporting.export_files import ExportChoices, export
from tests.cases import cases

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import FakeEngine, TinyClass

FILES = cases(__file__, "FILES")
HEADS = cases(__file__, "HEADS")
PAGES = cases(__file__, "PAGES")


@pytest.fixture
def graded(tiny: TinyClass, fake_engine: FakeEngine) -> TinyClass:
    (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    return tiny


def collected(klass: TinyClass, folder: Path, lms: str) -> None:
    form = "ilias" if lms == "ilias" else ""
    report = collect(klass.path, [write_zip(folder / "c.zip", {FILES[lms]: work(klass, 4, 7)})], form=form)
    assert [one.student for one in report.outcomes] == ["ada"]
    klass.grade(feedback=True)
    by_person(klass, "ada", TALKER, 4.5)


@pytest.mark.parametrize("lms", FILES)
def test_points_and_pages_go_back_to_where_they_came_from(
    graded: TinyClass, tmp_path: Path, lms: str
) -> None:
    collected(graded, tmp_path, lms)
    done = export(graded.path, lms)
    names = {path.name for path, _ in done.files}
    assert names == ({f"{lms}.csv"} if lms in HEADS else set()) | (
        {f"feedback-{lms}-lab_1_2.zip"} if lms in PAGES else set()
    )
    if lms in HEADS:
        head, who = HEADS[lms]
        header, *rows = csv.reader(io.StringIO((graded.path / "export" / f"{lms}.csv").read_text("utf-8")))
        assert header == [*head]
        found = [dict(zip(header, row, strict=True)) for row in rows]
        points = {
            row[who].removeprefix("#"): row[next(one for one in head if "lab_1_2" in one)] for row in found
        }
        assert (points["ada"], points["ben"], len(points)) == ("11.5", "", ROSTER.count("\n") - 1)
    else:
        assert "ILIAS cannot import points" in " ".join(done.notices)
    if lms in PAGES:
        with zipfile.ZipFile(graded.path / "export" / f"feedback-{lms}-lab_1_2.zip") as archive:
            assert archive.namelist() == [PAGES[lms]]


LISTS = cases(__file__, "LISTS")


@pytest.mark.parametrize("lms", LISTS)
def test_a_list_of_the_system_is_filled_in(graded: TinyClass, tmp_path: Path, lms: str) -> None:
    collected(graded, tmp_path, "sakai")
    given, wanted = LISTS[lms]
    (tmp_path / "list.csv").write_text(given, encoding="utf-8")
    export(graded.path, lms, ExportChoices(into=tmp_path / "list.csv"))
    assert (graded.path / "export" / "list.csv").read_text("utf-8").partition("\n")[2] == wanted
