"""A hand-out that a student never wrote in takes the place of no work, whatever either of them is called."""

from __future__ import annotations

from typing import TYPE_CHECKING

import nbformat
import pytest
from downloads import write_zip, zipped
from test_collect import kept, lies, placed, why, work

from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_files import LineState

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

    from autograder.grading.collecting.collect import CollectReport

COPY = "lab_1_2 (your copy, 2026-11-21).ipynb"


def untouched(klass: TinyClass, own: str = "") -> str:
    """The hand-out, run once and saved, perhaps with a cell of the student's own at its end."""
    notebook = klass.released()
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.execution_count = 1
    notebook.cells.append(nbformat.v4.new_code_cell(own))
    text: str = nbformat.writes(notebook)
    return text


def gathered(klass: TinyClass, folder: Path, files: dict[str, str], *, inner: bool = False) -> CollectReport:
    """Collect what Ada handed in at once, in a zip of her own or file by file."""
    ada = "Ada Lovelace_1_assignsubmission_file_{}"
    held: dict[str, bytes | str] = {ada.format(name): text for name, text in files.items()}
    if inner:
        held = {ada.format("work.zip"): zipped(files)}
    return collect(klass.path, [write_zip(folder / "m.zip", held)])


@pytest.mark.parametrize("inner", [False, True])
@pytest.mark.parametrize(
    ("fresh", "worked_on"),
    [
        ("lab_1_2.ipynb", "lab_1_2_ada.ipynb"),
        ("lab_1_2 (1).ipynb", "lab_1_2.ipynb"),
        ("lab_1_2.ipynb", COPY),
        ("lab_1_2.ipynb", "homework.ipynb"),
    ],
)
def test_work_goes_before_a_hand_out(
    klass: TinyClass, tmp_path: Path, fresh: str, worked_on: str, *, inner: bool
) -> None:
    files = {fresh: untouched(klass), worked_on: work(klass, 3)}
    report = gathered(klass, tmp_path, files, inner=inner)
    assert (why(report), lies(klass, "ada")) == ("", work(klass, 3))
    (earlier,) = report.having(LineState.EARLIER)
    assert earlier.label.endswith(fresh)
    assert "has answers and is graded; this file has no answers" in earlier.reason
    assert kept(klass) == [files[fresh]]


def test_what_cannot_be_read_goes_behind_work(klass: TinyClass, tmp_path: Path) -> None:
    cut = work(klass, 4)[:-100]
    report = gathered(klass, tmp_path, {"lab_1_2.ipynb": cut, "lab_1_2_ada.ipynb": work(klass, 3)})
    assert "it is not JSON" in why(report)
    assert (report.exit_code, lies(klass, "ada"), kept(klass)) == (2, work(klass, 3), [cut])


@pytest.mark.parametrize("damaged", ["", "\n", "\0" * 4096, "{", '{"nbformat": 4}', "<!DOCTYPE html>Log in"])
@pytest.mark.parametrize("together", [False, True])
def test_a_later_file_that_is_not_a_notebook_replaces_no_work(
    klass: TinyClass, tmp_path: Path, damaged: str, *, together: bool
) -> None:
    """The browser cut an upload off, or saved the login page: Ada keeps her points, and her instructor asks her."""
    name = "Lab_ada_attempt_2025-10-0{}-14-00-00_lab_1_2.ipynb"
    first, second = {name.format(3): work(klass, 3)}, {name.format(4): damaged}
    parts = [first | second] if together else [first, second]
    reports = [
        collect(klass.path, [write_zip(tmp_path / f"{number}.zip", part)])
        for number, part in enumerate(parts)
    ]
    assert (lies(klass, "ada"), kept(klass)) == (work(klass, 3), [damaged])
    assert "Another file of ada is graded: ask for this file again" in why(reports[-1])
    third = {name.format(5): work(klass, 5)}
    assert collect(klass.path, [write_zip(tmp_path / "new.zip", third)]).exit_code == 0
    assert lies(klass, "ada") == work(klass, 5)


def test_a_damaged_file_alone_waits_and_says_that_it_is_empty(klass: TinyClass, tmp_path: Path) -> None:
    report = gathered(klass, tmp_path, {"lab_1_2.ipynb": ""})
    assert (placed(report), "The file is empty: 0 bytes" in why(report)) == ({}, True)
    gathered(klass, tmp_path, {"lab_1_2.ipynb": work(klass, 3)})
    assert lies(klass, "ada") == work(klass, 3)


def test_a_cell_of_the_students_own_is_work(klass: TinyClass, tmp_path: Path) -> None:
    mine = untouched(klass, "def Talker():\n    return 7")
    gathered(klass, tmp_path, {"lab_1_2.ipynb": mine, "lab_1_2_old.ipynb": work(klass, 3)})
    assert lies(klass, "ada") == mine


def test_a_stub_of_an_older_release_is_no_work(klass: TinyClass, tmp_path: Path) -> None:
    """The source was changed since, and the notebook that students have was not."""
    source = klass.path / "source" / "lab_1_2" / "lab_1_2.ipynb"
    source.write_text(source.read_text().replace("The talker's points", "What the talker earns"))
    gathered(klass, tmp_path, {"lab_1_2.ipynb": untouched(klass), "lab_1_2_ada.ipynb": work(klass, 3)})
    assert lies(klass, "ada") == work(klass, 3)


def test_where_the_source_is_damaged_the_exact_name_counts(klass: TinyClass, tmp_path: Path) -> None:
    files = {"lab_1_2.ipynb": untouched(klass), "lab_1_2_ada.ipynb": work(klass, 3)}
    (klass.path / "source" / "lab_1_2" / "lab_1_2.ipynb").write_text("<<<<<<< HEAD")
    gathered(klass, tmp_path, files, inner=True)
    assert lies(klass, "ada") == files["lab_1_2.ipynb"]


def test_also_where_it_comes_in_a_download_of_its_own(klass: TinyClass, tmp_path: Path) -> None:
    zips = [
        write_zip(tmp_path / f"{name}.zip", {"ada/lab_1_2.ipynb": text})
        for name, text in (("one", untouched(klass)), ("two", work(klass, 3)), ("three", untouched(klass)))
    ]
    report = collect(klass.path, zips[:2])
    assert (why(report), lies(klass, "ada")) == ("", work(klass, 3))
    (late,) = collect(klass.path, zips[2:]).outcomes
    assert (late.state, lies(klass, "ada")) == (LineState.EARLIER, work(klass, 3))
    assert "has answers and is graded; this file has no answers" in late.reason
    assert len(kept(klass)) == 2


def test_what_a_time_says_to_be_newer_counts_whatever_it_holds(klass: TinyClass, tmp_path: Path) -> None:
    for day, text in (("03", work(klass, 3)), ("04", untouched(klass))):
        files = {f"Lab_ada_attempt_2025-10-{day}-14-00-00_lab_1_2.ipynb": text}
        collect(klass.path, [write_zip(tmp_path / "b.zip", files)])
        assert lies(klass, "ada") == text
