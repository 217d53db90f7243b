"""A file is read by a desk of its own: whatever takes it over decides only what is said of this one file."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass

from autograder.boxes import reading_desks as desk_of_boxes
from autograder.boxes import sandbox
from autograder.boxes.admission import NotAdmitted, admitted
from autograder.boxes.box_connection import ChannelClosed
from autograder.boxes.reading_desks import Desk, KeptDesk
from autograder.boxes.sandbox import why_impossible
from autograder.grading.collecting.collect import collect
from autograder.grading.grading_errors import GradingError
from autograder.grading.rebuilding import file_desk, submission_desk
from autograder.grading.rebuilding.file_desk import READERS
from autograder.grading.rebuilding.notebook_parsing import answer_to, parse
from autograder.grading.rebuilding.submission_desk import LARGEST_DOCUMENT, read_notebook
from autograder.grading.rebuilding.submitted_notebook import (
    MAX_CELL_CHARACTERS,
    ReadNotebook,
    Unreadable,
    UnreadableSubmission,
)
from tests.boxes.reach import mutated
from tests.drawn import drawn
from tests.grading.rebuilding.hostile_desk import CRAFTED, SCRIPT

if TYPE_CHECKING:
    from collections.abc import Iterator


def why_unreadable(data: bytes) -> str:
    """Why a file cannot be read; empty if it can."""
    try:
        read_notebook(data)
    except UnreadableSubmission as error:
        return str(error)
    return ""


def checked(document: bytes) -> ReadNotebook | Unreadable:
    read: ReadNotebook | Unreadable = admitted(document, ReadNotebook | Unreadable, LARGEST_DOCUMENT)
    return read


ROOT = Path(__file__).resolve().parents[3]
HOSTILE = "tests.grading.rebuilding.hostile_desk"
FAILED_ON_IT = "the program that reads notebooks failed on it"
FAULTS = {
    "at_random 1": FAILED_ON_IT,
    "at_random 2": FAILED_ON_IT,
    "endless": "far more time",
    "endless_answer": "far more time",
    "crash": FAILED_ON_IT,
    "leave": FAILED_ON_IT,
    "late": "nothing waits",
    "reach": "reached:",
    **{f"crafted {number}": FAILED_ON_IT for number in range(len(CRAFTED))},
}
"""A function of the hostile program, and a part of the sentence about the submission that names it."""


@pytest.fixture(scope="module")
def hostile() -> Iterator[Desk]:
    made = Desk(READERS, HOSTILE, {"PYTHONPATH": str(ROOT)})
    yield made
    made.close()


@pytest.fixture
def taken_over(hostile: Desk, monkeypatch: pytest.MonkeyPatch) -> Desk:
    """The desk of this process is one whose program students can choose."""
    monkeypatch.setattr(file_desk.desk, "_desk", hostile)
    monkeypatch.setattr(submission_desk, "CPU_SECONDS", 1)
    return hostile


@pytest.fixture(scope="module", autouse=True)
def each_file_is_read_once() -> None:
    """Here each file is read each time: the desks themselves are tested."""


def notebook(act: str) -> bytes:
    cell = {"cell_type": "code", "source": "x = 1", "metadata": {}}
    return json.dumps({"nbformat": 4, "metadata": {"do": f"hostile: {act}"}, "cells": [cell]}).encode()


def submit_hostile(tiny: TinyClass, student: str, act: str) -> None:
    path = tiny.submit(student, 4, 4)
    text = json.loads(path.read_text())
    text["metadata"]["do"] = f"hostile: {act}"
    path.write_text(json.dumps(text))


def test_a_desk_reads_what_its_parser_reads() -> None:
    for path in sorted((ROOT / "chapters").glob("**/*.ipynb"))[:3]:
        data = path.read_bytes()
        cells, left_out = read_notebook(data)
        assert (list(cells), left_out) == parse(data)


def test_a_desk_is_in_a_box_if_one_can_be_had() -> None:
    read_notebook(notebook(""))
    assert file_desk.desk.is_unboxed is bool(why_impossible())


@pytest.mark.parametrize("act", FAULTS)
def test_hostile_code_at_a_desk_is_the_fault_of_its_own_file(taken_over: Desk, act: str) -> None:
    said = why_unreadable(notebook(act))
    assert FAULTS[act] in said
    assert said.isprintable()
    assert why_unreadable(b"[]") == "The file is JSON, but not a Jupyter notebook."
    assert file_desk.desk._desk is taken_over, "the others need no new desk"


def test_a_desk_reaches_nothing_not_even_without_a_box(
    taken_over: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert why_unreadable(notebook("reach")) == "reached:"
    which = shutil.which
    monkeypatch.setattr(shutil, "which", lambda name: None if name == "bwrap" else which(name))
    plain = Desk(READERS, HOSTILE, {"PYTHONPATH": str(ROOT)})
    monkeypatch.setattr(file_desk.desk, "_desk", plain)
    try:
        assert not plain.is_boxed
        assert why_unreadable(notebook("reach")) == "reached:"
    finally:
        plain.close()


def test_no_other_student_loses_or_gains_anything(
    tiny: TinyClass, fake_engine: FakeEngine, taken_over: Desk
) -> None:
    honest = {"ada": (7, 8), "zoe": (10, 2)}
    for student, points in honest.items():
        tiny.submit(student, *points)
    tiny.grade(feedback=True)
    before = everything_of(tiny, honest)
    acts = ["endless", "crash", "crafted 3", "in_ada_s_name", "script", "script_in_the_reason", "reach"]
    for place, act in enumerate(acts):
        submit_hostile(tiny, f"eve{place}", act)
    report = tiny.grade(feedback=True, again=True)
    assert not report.problems
    assert everything_of(tiny, honest) == before
    for place, act in enumerate(acts):
        taken = {TALKER: {"in_ada_s_name": 1, "script": 3}.get(act, 0), LISTENER: 0}
        assert tiny.scores(f"eve{place}") == taken, act
        page = (tiny.path / "feedback" / f"eve{place}" / "lab_1_2" / "lab_1_2.html").read_text()
        assert "<script>fired" not in page
        assert "<img src=x" not in page
    reasons = {row.student: row.reason for row in report.rows if row.diagnosis == "unreadable"}
    assert sorted(reasons) == ["eve0", "eve1", "eve2", "eve5", "eve6"]
    assert all(reason.isprintable() for reason in reasons.values())


def everything_of(tiny: TinyClass, students: dict[str, tuple[int, int]]) -> dict[str, bytes]:
    """Points, notebooks and pages of students in the class."""
    files = [path for name in students for path in tiny.path.glob(f"*/{name}/*/*.*")]
    points = {name: repr(tiny.scores(name)).encode() for name in students}
    return {**points, **{str(path.relative_to(tiny.path)): path.read_bytes() for path in files}}


def test_ten_thousand_mutated_documents_are_refused_or_harmless() -> None:
    cells = [
        {"cell_type": "code", "source": "def Talker():\n    return 10", "id": "talker", "metadata": {}},
        {"cell_type": "markdown", "source": SCRIPT, "attachments": {"a.png": {"image/png": "aGVsbG8="}}},
    ]
    whole = answer_to(json.dumps({"nbformat": 4, "cells": cells}).encode())
    refused = 0
    for document in mutated(whole, 10_000):
        try:
            read = checked(document)
        except NotAdmitted:
            refused += 1
            continue
        if isinstance(read, Unreadable):
            refused += 1
            continue
        assert 0 <= read.left_out <= 2_000
        assert all(len(cell.source.encode()) <= MAX_CELL_CHARACTERS for cell in read.cells)
    assert 5_000 < refused < 10_000


def test_a_lost_desk_is_no_file_s_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    lost = [ChannelClosed("killed")] * 2

    def ask(self: Desk, request: str, source: int, answer: int, **_: object) -> None:
        if request == "submission":
            if lost:
                os.read(source, 10)
                os.write(answer, b"a part of an answer" * 1_000)
                raise lost.pop()
            os.write(answer, answer_to(os.read(source, 1_000)))

    read_notebook(notebook(""))
    first = file_desk.desk._desk
    monkeypatch.setattr(Desk, "ask", ask)
    assert read_notebook(notebook("of another student"))[1] == 0
    assert file_desk.desk._desk not in (first, None), "a lost desk is not asked again"
    lost = [ChannelClosed("killed")] * 9
    with pytest.raises(GradingError, match=r"killed.*short of memory"):
        read_notebook(notebook(""))


def test_a_desk_that_cannot_read_a_sample_reads_no_student_s_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(file_desk.desk, "_desk", None)
    ill = {"PYTHONPATH": str(ROOT), "ILL": "1"}
    monkeypatch.setattr(desk_of_boxes, "Desk", lambda readers: Desk(readers, HOSTILE, ill))
    with pytest.raises(GradingError, match="not even a sample"):
        read_notebook(notebook(""))


def test_a_desk_that_cannot_be_started_leaves_no_process_and_no_folder(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def too_long(*_: object) -> None:
        raise OSError("AF_UNIX path too long")

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(sandbox, "Enclosure", too_long)
    with pytest.raises(OSError, match="too long"):
        Desk(READERS, HOSTILE, {"PYTHONPATH": str(ROOT)})
    assert not list(tmp_path.iterdir())


# -- documents that are kept


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """The files that a desk was asked to read."""
    files: list[bytes] = []

    def read(self: KeptDesk, request: str, data: bytes, *_: object, **__: object) -> object:
        files.append(data)
        return checked(answer_to(data))

    monkeypatch.setattr(KeptDesk, "read", read)
    return files


def test_a_file_is_read_once_and_each_other_file_for_itself(asked: list[bytes], tmp_path: Path) -> None:
    files = [notebook("one"), notebook("two")]
    read = [read_notebook(data, tmp_path) for data in files * 2]
    assert asked == files
    assert [list(cells) for cells, _ in read] == [list(parse(data)[0]) for data in files * 2]


def test_a_file_that_cannot_be_read_is_tried_again(asked: list[bytes], tmp_path: Path) -> None:
    for _ in range(2):
        with pytest.raises(UnreadableSubmission, match="not a Jupyter notebook"):
            read_notebook(b"[]", tmp_path)
    assert (len(asked), [*tmp_path.rglob("*")]) == (2, [])


@pytest.mark.parametrize("damage", ["cut", "other bytes", "no notebook", "another parser", "a folder"])
def test_a_document_that_does_not_fit_is_not_used(
    asked: list[bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, damage: str
) -> None:
    data = notebook("one")
    right = read_notebook(data, tmp_path)
    (kept,) = (tmp_path / submission_desk._DOCUMENTS).iterdir()
    if damage == "cut":
        kept.write_bytes(kept.read_bytes()[:-3])
    elif damage == "other bytes":
        kept.write_bytes(b"nothing")
    elif damage == "no notebook":
        kept.write_bytes(zlib.compress(b'{"type": "ReadNotebook", "cells": 5}'))
    elif damage == "another parser":
        monkeypatch.setattr(submission_desk, "_VERSION", b"another")
    else:
        kept.unlink()
        kept.mkdir()
    assert read_notebook(data, tmp_path) == right
    assert asked == [data, data]


def test_a_class_reads_each_file_once(tiny: TinyClass, asked: list[bytes], fake_engine: FakeEngine) -> None:
    files = [tiny.submit("ada", 4), tiny.submit("ben", 5)]
    tiny.grade()
    collect(tiny.path)
    tiny.submit("ada", 6)
    tiny.grade(again=True)
    tiny.configure("c.WireExecute.memory_bytes = 4_000_000_000")
    tiny.grade()
    assert len(asked) == 3
    assert set(asked) > {path.read_bytes() for path in files}
    assert tiny.scores("ada")[TALKER] == 6


def documents(path: Path) -> list[str]:
    return sorted(file.name for file in (path / ".autograder" / "documents").iterdir())


def test_a_document_that_no_submission_needs_is_removed_when_the_class_is_graded(
    tiny: TinyClass, asked: list[bytes], fake_engine: FakeEngine, tmp_path: Path
) -> None:
    for points in range(4):
        tiny.submit("ada", points)
        tiny.submit("ben", 5)
        tiny.grade(students=["ada"])
    assert len(documents(tiny.path)) == 1
    tiny.grade()
    assert len(documents(tiny.path)) == 2
    assert len(asked) == 5
    download = tmp_path / "download" / "ada" / "lab_1_2.ipynb"
    download.parent.mkdir(parents=True)
    download.write_bytes(tiny.submit("ada", 6).read_bytes())
    collect(tiny.path, [download.parent.parent])
    (tiny.path / ".autograder/documents/.unfinished.1.new").touch()
    tiny.submit("ada", 7)
    tiny.grade()
    assert len(documents(tiny.path)) == 1 + 3, "those of two submissions and one file in the inbox"
    assert len(asked) == 7
    collect(tiny.path)
    assert len(asked) == 7


# -- what a desk says of any file

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=3), inner, max_size=2),
    max_leaves=4,
)
TEXT = st.text(st.characters(exclude_categories=()), max_size=20)


def maybe(usual: st.SearchStrategy[object]) -> st.SearchStrategy[object]:
    return st.one_of(usual, usual, usual, JSON)


SHOWN = st.dictionaries(
    TEXT, maybe(st.dictionaries(st.sampled_from(["image/png", "image/svg+xml"]), maybe(TEXT)))
)
CELL = st.fixed_dictionaries(
    {
        "cell_type": maybe(st.sampled_from(["code", "markdown", "raw"])),
        "source": maybe(TEXT | st.lists(TEXT)),
    },
    optional={
        "id": maybe(TEXT),
        "metadata": maybe(
            st.fixed_dictionaries({"nbgrader": maybe(st.fixed_dictionaries({"grade_id": maybe(TEXT)}))})
        ),
        "attachments": maybe(SHOWN),
        "outputs": JSON,
    },
)
FILE = st.fixed_dictionaries(
    {"nbformat": st.sampled_from([4, 4, 4, 3, "4"]), "cells": maybe(st.lists(maybe(CELL)))}
)


@drawn(60)
@given(FILE)
@example({"nbformat": 4, "cells": [{"cell_type": "markdown", "source": "\ud800", "id": "\udcff"}]})
def test_what_a_desk_says_of_any_file_is_what_was_parsed(file: object) -> None:
    data = json.dumps(file).encode()
    try:
        cells, left_out = parse(data)
    except UnreadableSubmission:
        assert isinstance(checked(answer_to(data)), Unreadable)
        return
    assert checked(answer_to(data)) == ReadNotebook(tuple(cells), left_out)
    assert len(cells) + left_out == len(file["cells"])  # type: ignore[index]
