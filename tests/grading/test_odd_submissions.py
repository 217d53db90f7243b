"""What students put in the place of a notebook: each gets one line that names it, and the rest is graded."""

from __future__ import annotations

import errno
import itertools
import json
import os
import shutil
import socket
import stat
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from nbgrader.api import Gradebook
from nbgrader.converters import NbGraderException
from test_nbgrader_and_ours import nbgrader_autograde
from tiny_class import LISTENER, TALKER, FakeEngine, TinyClass, shown

from autograder.grading.rebuilding import submitted_notebook
from autograder.grading.rebuilding.submission_desk import read_notebook
from autograder.grading.rebuilding.submitted_notebook import UnreadableSubmission, read_bytes
from tests.hard_links import hard_link

if TYPE_CHECKING:
    from collections.abc import Callable


pytestmark = pytest.mark.usefixtures("fake_engine")
NOTHING = {TALKER: 0, LISTENER: 0}


def a_pipe(path: Path, _: TinyClass) -> None:
    os.mkfifo(path)


def a_socket(path: Path, _: TinyClass) -> None:
    here = Path.cwd()
    os.chdir(path.parent)  # the name of a socket may have 107 bytes
    try:
        socket.socket(socket.AF_UNIX).bind(path.name)
    finally:
        os.chdir(here)


def a_device(path: Path, _: TinyClass) -> None:
    try:
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 5))  # /dev/zero: reading it never ends
    except PermissionError:
        pytest.skip("only root can make a device")


def a_folder(path: Path, _: TinyClass) -> None:
    path.mkdir()
    (path / "lab_1_2.ipynb").write_text("{}")


def a_link_to_a_neighbour(path: Path, tiny: TinyClass) -> None:
    path.symlink_to(tiny.path / "submitted" / "ada" / "lab_1_2" / path.name)


def a_link_to_itself(path: Path, _: TinyClass) -> None:
    path.symlink_to(path)


def a_link_to_nothing(path: Path, _: TinyClass) -> None:
    path.symlink_to("/nowhere/at/all")


def a_second_name_of_a_neighbours(path: Path, tiny: TinyClass) -> None:
    copy = tiny.path / "submitted" / "copy.ipynb"
    shutil.copy(tiny.path / "submitted" / "ada" / "lab_1_2" / path.name, copy)
    hard_link(path, copy)


ODD: dict[str, tuple[Callable[[Path, TinyClass], None], str]] = {
    "pipe": (a_pipe, "is a pipe"),
    "socket": (a_socket, "is a socket"),
    "device": (a_device, "is a device"),
    "folder": (a_folder, "is a folder"),
    "link": (a_link_to_a_neighbour, "is a link"),
    "link to itself": (a_link_to_itself, "is a link"),
    "link to nothing": (a_link_to_nothing, "is a link"),
    "hard link": (a_second_name_of_a_neighbours, "under a second name"),
}


def in_place_of_the_notebook(tiny: TinyClass, kind: str, student: str = "eve") -> Path:
    path = tiny.path / "submitted" / student / "lab_1_2" / "lab_1_2.ipynb"
    path.parent.mkdir(parents=True)
    ODD[kind][0](path, tiny)
    return path


def test_what_is_no_file_is_named_once_and_earns_nothing(tiny: TinyClass, fake_engine: FakeEngine) -> None:
    tiny.submit("ada", 7, 8)
    students = {kind: f"eve-{place}" for place, kind in enumerate(ODD)}
    paths = {kind: in_place_of_the_notebook(tiny, kind, student) for kind, student in students.items()}
    report = tiny.grade(feedback=True)
    assert fake_engine.ran == ["ada"]
    assert tiny.scores("ada") == {TALKER: 7, LISTENER: 8}
    assert report.exit_code == 2
    lines, table = shown(report, 300).splitlines(), (tiny.path / "grades.csv").read_text()
    for kind, student in students.items():
        assert tiny.scores(student) == NOTHING
        (line,) = (line for line in lines if str(paths[kind]) in line)
        page = (tiny.path / "feedback" / student / "lab_1_2" / "lab_1_2.html").read_text()
        assert ODD[kind][1] in line
        assert ODD[kind][1] in page
        assert f"{student},lab_1_2,lab_1_2.talker,0,10,failed,unreadable" in table
        assert [refused.path for refused in report.refused].count(paths[kind]) == 1


@pytest.mark.parametrize("kind", ["pipe", "hard link"])
def test_plain_nbgrader_is_not_held_up_either(tiny: TinyClass, kind: str) -> None:
    tiny.submit("ada", 7, 8)
    path = in_place_of_the_notebook(tiny, kind)
    with pytest.raises(NbGraderException, match=rf"{path}: .*{ODD[kind][1]}"):
        nbgrader_autograde(tiny)
    assert tiny.scores("eve") == NOTHING
    assert tiny.scores("ada") == {TALKER: 7, LISTENER: 8}


@pytest.mark.parametrize("command", ["ours", "nbgrader's"])
def test_what_lies_beside_the_notebook_holds_nothing_up_and_costs_nothing(
    tiny: TinyClass, command: str
) -> None:
    tiny.submit("ada")
    names = ("timestamp.txt", "robot.py", "deep/robot.py")
    kinds = ("pipe", "device", "folder", "link to itself", "link")
    students: list[str] = []
    for kind, name in itertools.product(kinds, names):
        students.append(f"eve-{len(students)}")
        path = tiny.submit(students[-1], 3, 4).parent / name
        path.parent.mkdir(exist_ok=True)
        ODD[kind][0](path, tiny)
    if command == "ours":
        assert tiny.grade().exit_code == 0
    else:
        nbgrader_autograde(tiny)
    for student in students:
        assert tiny.scores(student) == {TALKER: 3, LISTENER: 4}
        files = (tiny.path / "autograded" / student).rglob("*.*")
        assert [file.name for file in files] == ["lab_1_2.ipynb"]
        assert not [*tiny.path.glob(f"feedback/{student}/*/robot.py")]


@pytest.mark.parametrize("command", ["ours", "nbgrader's"])
def test_a_file_with_a_hole_of_a_terabyte_fills_no_disk(tiny: TinyClass, command: str) -> None:
    beside = tiny.submit("eve", 3, 4).parent / "huge.bin"
    instead = tiny.path / "submitted" / "mallory" / "lab_1_2" / "lab_1_2.ipynb"
    instead.parent.mkdir(parents=True)
    for path in (beside, instead):
        with path.open("wb") as file:
            file.truncate(1 << 40)
    if command == "ours":
        report = tiny.grade()
        assert report.exit_code == 0
        reason = next(row.reason for row in report.rows if row.student == "mallory")
        assert "the limit is 50 MB" in reason
    else:
        nbgrader_autograde(tiny)
    assert tiny.scores("eve") == {TALKER: 3, LISTENER: 4}
    assert tiny.scores("mallory") == NOTHING


def test_a_notebook_that_may_not_be_read(tiny: TinyClass, monkeypatch: pytest.MonkeyPatch) -> None:
    """Root may read everything, so the refusal is played."""
    locked = tiny.submit("eve")
    tiny.submit("ada")
    usual = os.open

    def refuse(path: Any, *args: Any, **kw: Any) -> int:
        if Path(path) == locked:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return usual(path, *args, **kw)

    monkeypatch.setattr(os, "open", refuse)
    report = tiny.grade()
    assert [(r.path, r.reason) for r in report.refused] == [
        (locked, "lab_1_2.ipynb could not be read: Permission denied.")
    ]
    assert report.exit_code == 2
    assert tiny.scores("eve") == NOTHING
    assert tiny.scores("ada")[TALKER] == 10


def test_a_students_folder_that_may_not_be_read(tiny: TinyClass, monkeypatch: pytest.MonkeyPatch) -> None:
    tiny.submit("ada")
    locked = tiny.submit("eve").parents[1]
    usual = Path.iterdir

    def refuse(path: Path) -> Any:
        if path == locked:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return usual(path)

    monkeypatch.setattr(Path, "iterdir", refuse)
    report = tiny.grade()
    assert [(r.path, r.reason) for r in report.refused] == [
        (locked, "the folder could not be read: Permission denied")
    ]
    assert report.exit_code == 2
    assert tiny.scores("ada")[TALKER] == 10


MISLEADING = (
    *("a*", " a", "a ", "x\ny", "=cmd", "[a-z]", "{0}", "a\x1b[2J", ";rm", "a,b"),
    *("a\u202eb", "a\u2066b", "\u200badmin", "\ufeffada", "a\u007f", "a\tb", "a\rb", "\u2215etc"),
    *("a\\b", "~", "$HOME", "`id`", "%2e%2e", "a:b", "<b>", '"', "a?b", "#a", "&a", "x" * 101, "ö" * 60),
)


def test_a_name_that_misleads_is_refused_in_one_line(tiny: TinyClass) -> None:
    tiny.submit("ada")
    for name in MISLEADING:
        (tiny.path / "submitted" / name / "lab_1_2").mkdir(parents=True)
    report = tiny.grade()
    assert sorted(refused.path.name for refused in report.refused) == sorted(MISLEADING)
    assert report.exit_code == 2
    assert tiny.scores("ada")[TALKER] == 10
    lines = [line for line in shown(report, 300).splitlines() if line.startswith("refused")]
    assert len(lines) == len(MISLEADING)
    assert all(line.isprintable() for line in lines)


@pytest.mark.parametrize("name", ["<b>", "a\nb"])
def test_plain_nbgrader_makes_no_student_of_such_a_name(tiny: TinyClass, name: str) -> None:
    """Formgrader writes a student's name into a script of its page."""
    tiny.submit("ada")
    (tiny.path / "submitted" / name).mkdir()
    (tiny.path / "submitted" / "ada" / "lab_1_2").rename(tiny.path / "submitted" / name / "lab_1_2")
    tiny.submit("ada")
    with pytest.raises(NbGraderException):
        nbgrader_autograde(tiny)
    with Gradebook(f"sqlite:///{tiny.path / 'gradebook.db'}") as book:
        assert [student.id for student in book.students] == ["ada"]
    assert tiny.scores("ada")[TALKER] == 10


def test_a_pipe_in_the_place_of_a_student_is_named(tiny: TinyClass) -> None:
    tiny.submit("ada")
    os.mkfifo(tiny.path / "submitted" / "eve")
    report = tiny.grade()
    assert [refused.reason for refused in report.refused] == [
        "the path is neither a folder nor a file; remove it"
    ]
    assert tiny.scores("ada")[TALKER] == 10


def test_a_files_name_cannot_forge_a_line(tmp_path: Path) -> None:
    (tmp_path / "x\nrefused: ada \u202e\x1b[2J.ipynb").write_text("")
    with pytest.raises(UnreadableSubmission) as caught:
        read_bytes(tmp_path / "lab_1_2.ipynb")
    assert str(caught.value).isprintable()


# -- what is in the file
# ---------------------------------------------------------------------------------------------


def notebook(cells: str) -> bytes:
    return b'{"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": ' + cells.encode() + b"}"


CODE = '{"cell_type": "code", "metadata": {}, "outputs": [], "source": "x = 1"}'


@pytest.mark.parametrize(
    ("data", "cells"),
    [
        (notebook(f"[{CODE}]").replace(b'"metadata": {}', b'"metadata": {"a": NaN, "b": Infinity}'), 1),
        (notebook(f'[{CODE}], "cells": [{CODE}, {CODE}]'), 2),
        (notebook('[{"cell_type": "raw", "cell_type": "code", "source": "a", "source": "b"}]'), 1),
        (notebook(f"[{CODE}]").replace(b"x = 1", b"x = \\u0000"), 1),
        (notebook(f"[{CODE}]").replace(b"x = 1", b"\\ud83d x \\udc00"), 1),
        (notebook(f"[{CODE}]").replace(b'"metadata": {}', b'"metadata": {"x": 1e999, "y": -1E+400}'), 1),
        (notebook("[" + ",".join([CODE] * 1999) + "]"), 1999),
    ],
    ids=["NaN", "keys twice", "a cell's keys twice", "NUL", "surrogates", "too large a number", "many cells"],
)
def test_what_is_odd_but_a_notebook_is_taken(data: bytes, cells: int) -> None:
    taken, left_out = read_notebook(data)
    assert (len(taken), left_out) == (cells, 0)
    assert all(cell.source.encode() for cell in taken)


LONG = json.dumps({"cell_type": "code", "source": "x" * 99_000})


@pytest.mark.parametrize(
    ("says", "data"),
    [
        *(("empty", data) for data in (b"", b"\0" * 512)),
        ("not UTF-8", b"\xff\xfe\x00"),
        ("not UTF-8", notebook(f"[{CODE}]").replace(b"x = 1", b"x = \xff")),
        *(("not JSON", data) for data in (b"hello", b"PK\x03\x04" + bytes(1000), notebook(f"[{CODE}]")[:-1])),
        ("not JSON", notebook(f"[{CODE}]").replace(b"x = 1", b"x = \x00")),
        *(("not a Jupyter notebook", data) for data in (b"[]", b'{"cells": []}')),
        ("not a notebook of format 4", b'{"nbformat": 4, "cells": {}}'),
        ("not a notebook of format 4", b'{"nbformat": 9, "cells": []}'),
        *(("nested too deeply", notebook(of * 200_000)) for of in ("[", '{"a":')),
        (".", notebook(f"[{CODE}]").replace(b'"nbformat": 4', b'"nbformat": ' + b"4" * 10_000)),
        (".", notebook("[" + "0," * 1_000_000 + "0]")),
        (".", notebook("[" + ",".join([CODE] * 2001) + "]")),
        (".", notebook("[" + ",".join([LONG] * 11) + "]")),
        (".", b"\x1f\x8b\x08" + bytes(1000)),
    ],
    ids=lambda value: value if isinstance(value, str) else f"{value[:20]!r}",
)
def test_what_is_no_notebook_is_said_in_one_line(says: str, data: bytes) -> None:
    with pytest.raises(UnreadableSubmission, match=says) as caught:
        read_notebook(data)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 300


def test_a_file_that_is_no_notebook_has_its_line(tiny: TinyClass) -> None:
    tiny.submit("ada")
    tiny.hand_in("eve", "hello")
    tiny.hand_in("mallory", "[" * 200_000)
    report = tiny.grade()
    lines = [line for line in shown(report, 300).splitlines() if line.startswith("unreadable")]
    assert [line.partition(":")[0].split()[1] for line in lines] == ["eve/lab_1_2", "mallory/lab_1_2"]
    assert "not JSON" in lines[0]
    assert "nested too deeply" in lines[1]
    assert report.exit_code == 0, "it is graded: with zero"


def test_a_cell_that_is_too_long_is_left_out_with_a_word() -> None:
    long = json.dumps({"cell_type": "code", "source": "x" * (submitted_notebook.MAX_CELL_CHARACTERS + 1)})
    assert read_notebook(notebook(f"[{CODE}, {long}]"))[1] == 1


def test_the_largest_file_is_read_and_the_costliest_ends_at_the_limit_of_the_desk() -> None:
    """The JSON that costs most: fifty megabytes of it took two gigabytes of memory, and half a minute."""
    printed = json.dumps({"cell_type": "code", "source": "x", "said": '"1", [2, ' * 3_000_000})
    assert read_notebook(notebook(f"[{printed}]"))[1] == 0, "what a cell has printed is one value"
    picture = "\N{ROBOT FACE}" + "x" * (submitted_notebook.MAX_BYTES - 1_000)
    shown = json.dumps({"cell_type": "code", "source": "x", "said": picture}, ensure_ascii=False)
    assert len(read_notebook(notebook(f"[{shown}]"))[0]) == 1
    with pytest.raises(UnreadableSubmission, match="far more memory"):
        read_notebook(notebook("[" + "[]," * ((submitted_notebook.MAX_BYTES - 100) // 3) + "0]"))


def test_a_folder_that_cannot_be_listed_is_named_to_whoever_grades_one_student(tiny: TinyClass) -> None:
    (tiny.path / "students.csv").write_text("id\nada\n")
    (tiny.path / "submitted").rmdir()
    (tiny.path / "submitted").touch()
    (refused,) = tiny.grade(students=["ada"]).refused
    assert refused.path == tiny.path / "submitted"
