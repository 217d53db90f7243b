"""A file is itself by its whole bytes and its whole path; what the table shows of its key is only shown."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import pytest
from downloads import write_zip
from test_collect import lies, placed, why, work
from test_collected_csv import edit, read, save

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import Inbox

if TYPE_CHECKING:
    from pathlib import Path

    from tiny_class import TinyClass

ALIKE = ("ada/361614.ipynb", "ada/473277.ipynb")
"""Two paths for which, with the bytes ``{}``, the first 40 bits of the key are equal."""


def test_two_files_whose_shown_keys_begin_alike_are_two_lines(klass: TinyClass, tmp_path: Path) -> None:
    collect(klass.path, [write_zip(tmp_path / "c.zip", dict.fromkeys(ALIKE, "{}"))])
    lines = read(klass)[1]
    keys = [line["file"].rpartition(" ")[2] for line in lines]
    assert (len(lines), len(set(keys)), {key[:11] for key in keys}) == (2, 2, {"#cd44ee01f1"})
    edit(klass, "361614", use="no")
    collect(klass.path)
    assert {line["file"][:14]: line["counts"] for line in read(klass)[1]} == {
        "c.zip/ada/3616": "no",
        "c.zip/ada/4732": "waits",
    }


def test_an_edit_of_a_table_that_was_open_when_a_file_with_the_same_short_key_came_is_of_the_first(
    klass: TinyClass, tmp_path: Path
) -> None:
    collect(klass.path, [write_zip(tmp_path / "c.zip", {ALIKE[0]: "{}"})])
    columns, old = read(klass)
    collect(klass.path, [write_zip(tmp_path / "d.zip", {ALIKE[1]: "{}"})])
    save(klass, columns, [{**old[0], "use": "no"}])
    collect(klass.path)
    assert {line["file"][:14]: line["counts"] for line in read(klass)[1]} == {
        "c.zip/ada/3616": "no",
        "d.zip/ada/4732": "waits",
    }


def test_short_keys_are_what_a_person_sees(klass: TinyClass, tmp_path: Path) -> None:
    collect(klass.path, [write_zip(tmp_path / "c.zip", {"guest/lab_1_2.ipynb": work(klass)})])
    (line,) = read(klass)[1]
    (waiting,) = Table(ClassDirectory(klass.path)).waiting()
    assert waiting.label == line["file"]
    assert len(line["file"]) == len("c.zip/guest/lab_1_2.ipynb #0123456789")
    assert not Table(ClassDirectory(klass.path)).is_edited


def made_by_an_earlier_version(klass: TinyClass) -> None:
    """Store keys and the names of deliveries as this project did until November 2026: cut to 10 and 16 digits."""
    state = klass.path / ".autograder" / "inbox"
    whole = {key: key[:11] for key in Inbox(klass.path / ".autograder").keys}
    for path in (*state.glob("tables/*.csv"), state / "edits.json"):
        text = path.read_text("utf-8-sig") if path.exists() else ""
        for key, short in whole.items():
            text = text.replace(key, short)
        if text:
            path.write_text(text, "utf-8-sig" if path.suffix == ".csv" else "utf-8", newline="")
    for path in state.glob("*.zip"):
        path.rename(path.with_name(f"{path.stem[:16]}.zip"))


@pytest.mark.parametrize("is_open", [True, False])
def test_a_class_with_short_keys_goes_on(klass: TinyClass, tmp_path: Path, *, is_open: bool) -> None:
    """What was written into the table before the update counts, and what is written into the old table counts, too."""
    files = {"mine.ipynb": work(klass, 3), "his.ipynb": work(klass, 4), "ada/lab_1_2.ipynb": work(klass, 5)}
    source = write_zip(tmp_path / "c.zip", files)
    collect(klass.path, [source])
    edit(klass, "mine", student="zoe", handed_in="2026-01-31 12:00")
    collect(klass.path)
    made_by_an_earlier_version(klass)
    assert len(next(iter(json.loads((klass.path / ".autograder/inbox/edits.json").read_text())))) == 11
    if is_open:
        edit(klass, "his", student="ben")
    report = collect(klass.path, [source])
    assert report.notes[:-1] == ()
    assert lies(klass, "zoe") == work(klass, 3)
    if is_open:
        assert lies(klass, "ben") == work(klass, 4)
    else:
        assert "his.ipynb" in why(report)
        edit(klass, "his", student="ben")
        assert placed(collect(klass.path)).keys() == {"ben"}
    assert len([*(klass.path / ".autograder" / "inbox").glob("*.zip")]) == 1, "the same delivery"
    shutil.rmtree(klass.path / "submitted")
    assert placed(collect(klass.path)).keys() == {"zoe", "ben", "ada"}
