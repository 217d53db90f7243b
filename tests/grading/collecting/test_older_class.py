"""A class that an older version of the course has collected: its times, numbers and earlier attempts stay."""

from __future__ import annotations

import gzip
import hashlib
import json
from typing import TYPE_CHECKING

from test_collect import lies, stamp, work
from test_collected_table import read
from test_where_it_goes import gathered

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import collect
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.records import CollectedRecords

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import TinyClass

OLD, NEW = "lovelaceada_101_9001_lab_1_2.ipynb", "lovelaceada_101_9002_lab_1_2-1.ipynb"


def record(source: str, data: bytes, when: str, **more: object) -> dict[str, object]:
    content = hashlib.sha256(data).hexdigest()
    of = {"notebook": "lab_1_2", "content": content, "source": source, "collected": "2025-10-05T00:00:00Z"}
    return {**of, "when": when, "late": False, **more}


def older(klass: TinyClass) -> None:
    """What the version before the inbox has left: two attempts of Ada's in Canvas, and Zoe's by hand with a time."""
    first, second = work(klass, 1).encode(), work(klass, 2).encode()
    place = klass.submit("ada")
    place.write_bytes(second)
    hand = klass.submit("zoe").read_bytes()
    folder = klass.path / ".autograder" / "collected" / "lab_1_2"
    (folder / "ada.kept").mkdir(parents=True)
    canvas = {"lms": "canvas", "number": "101", "name": "lovelaceada"}
    before = record(OLD, first, "2025-10-03T14:05:00Z", order=9001, file=OLD, **canvas)
    now = record(NEW, second, "2025-10-04T14:05:00Z", order=9002, file=NEW, **canvas)
    name = f"{hashlib.sha256(first).hexdigest()[:16]}.ipynb.gz"
    (folder / "ada.kept" / name).write_bytes(gzip.compress(first, mtime=0))
    (folder / "ada.json").write_text(json.dumps({"now": {"lab_1_2": now}, "before": [before]}))
    of_zoe = record("zoe", hand, "2025-10-02T08:00:00Z", by_hand=True)
    (folder / "zoe.json").write_text(json.dumps({"now": {"lab_1_2": of_zoe}, "before": []}))


def test_what_an_older_version_collected_is_in_the_table_with_its_times(
    klass: TinyClass, tmp_path: Path
) -> None:
    older(klass)
    report = collect(klass.path)
    assert "2 files that an older version had collected are in the table now" in report.notes
    assert lies(klass, "ada") == work(klass, 2)
    assert stamp(klass, "ada") == "2025-10-04 14:05:00.000000 UTC"
    assert stamp(klass, "zoe") == "2025-10-02 08:00:00.000000 UTC"
    directory = ClassDirectory(klass.path)
    assert Table(directory).earlier() == {("ada", "lab_1_2"): 1}
    history = CollectedRecords(directory.state).get("lab_1_2", "ada")
    assert history is not None
    assert (history.now["lab_1_2"].lms, history.now["lab_1_2"].file) == ("canvas", NEW), "for its feedback"
    before = read(klass)
    assert collect(klass.path).notes == ()
    assert read(klass) == before
    gathered(klass, tmp_path, {"lovelaceada_101_9003_lab_1_2-2.ipynb": work(klass, 3)})
    assert lies(klass, "ada") == work(klass, 2), "nothing says that it is newer: it waits"
