"""What ``collect`` does: each case of the table has trees of files, what an instructor types, and lines that are true.

A case is a text. ``c.zip:`` or ``d/:`` begins a tree, with what it holds below, indented: ``lab_1_2.ipynb = 3`` is the
notebook of lab_1_2 whose talker has 3 points, and ``|`` begins a line of a text. ``> collect c.zip`` types a command.
The other lines say what is true afterwards; ``_Scene`` has a method for each. Every file that waits needs a line.
"""

from __future__ import annotations

import json
import shlex
from collections import Counter
from datetime import datetime
from typing import TYPE_CHECKING, Any
from zoneinfo import ZoneInfo

import nbformat
import pytest
from downloads import ROSTER, zipped
from test_collect import kept, work
from test_collected_csv import edit, read

from autograder.grading.classes.class_directory import ClassDirectory
from autograder.grading.collecting.collect import CollectReport, collect, report_lines
from autograder.grading.collecting.collected_csv import Table
from autograder.grading.collecting.collected_files import CollectedRecords, LineState
from autograder.grading.grading_errors import GradingError
from autograder.grading.new_classes.new_class import release
from autograder.grading.reporting.lms_gradebooks import line_from_lms
from tests.cases import cases

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from tiny_class import TinyClass

Held = str | bytes | dict[str, Any]
UTC = ZoneInfo("UTC")
OPTIONS = {"from": "form", "timezone": "zone", "handed-in": "handed_in"}
ALL: dict[str, Any] = cases(__file__, "case")
VARIANTS = {
    f"{title} {number}" if "each" in case else title: (case, words)
    for title, case in ALL.items()
    for number, words in enumerate(case.get("each", [{}]), 1)
}


def blocks(lines: Sequence[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield each line with the lines that are indented below it."""
    head, below = "", list[str]()
    for line in (one for one in lines if one.strip() and not one.startswith("#")):
        if line.startswith("  "):
            below.append(line[2:])
            continue
        if head:
            yield head, below
        head, below = line, []
    yield head, below


class _Scene:
    def __init__(self, klass: TinyClass, folder: Path) -> None:
        self._klass, self._folder = klass, folder
        self._report = CollectReport(klass.path)
        self._error = ""
        self._waits: list[tuple[str, str]] = []

    def play(self, text: str) -> None:
        for head, below in blocks(text.splitlines()):
            if head.startswith("> "):
                self._all_is_said()
                verb, *words = shlex.split(head[2:])
                getattr(self, f"do_{verb}")(words, below)
            elif " = " in head:
                name, _, code = head.rpartition(" = ")
                self._write(self._folder / name, self._content(code))
            elif head.endswith(":"):
                self._write(self._folder / head[:-1].rstrip("/"), self._held(head[:-1], below))
            else:
                word, _, rest = head.partition(" ")
                getattr(self, f"see_{word.replace('-', '_')}")(rest)
        self._all_is_said()

    def _all_is_said(self) -> None:
        assert not self._waits, "these wait, and the case does not say so"
        assert not self._error, "this error was not expected"

    def _held(self, name: str, lines: Sequence[str]) -> Held:
        if lines and lines[0].startswith("|"):
            return "\n".join(line[1:].removeprefix(" ") for line in lines) + "\n"
        files: dict[str, Any] = {}
        for head, below in blocks(lines) if lines else ():
            if head.endswith(":"):
                files[head[:-1]] = self._held(head[:-1], below)
            else:
                file, _, code = head.rpartition(" = ")
                files[file] = self._content(code)
        return zipped(files) if name.endswith(".zip") else files

    def _content(self, code: str) -> str:
        if code.startswith('"'):
            return str(json.loads(code))
        if code.startswith(
            "blank"
        ):  # the hand-out, run once and saved, with an empty cell or one of the student's own
            notebook = self._klass.released()
            for cell in (one for one in notebook.cells if one.cell_type == "code"):
                cell.execution_count = 1
            own = f"def Talker():\n    return {code[6:]}" if code[6:] else ""
            notebook.cells.append(nbformat.v4.new_code_cell(own, id="own"))
            return str(nbformat.writes(notebook))
        kind, _, points = code.rpartition(" ")
        text = work(self._klass, int(points))
        if kind == "other":
            return text.replace("Talker", "Server").replace("Listener", "Client")
        if kind == "cut":
            return text[:-100]
        if kind == "nameless":
            return text.replace('"grade_id"', '"nobody"')
        return text.replace('"grade_id": "', f'"grade_id": "{kind}-') if kind else text

    def _write(self, path: Path, held: Held) -> None:
        if isinstance(held, dict):
            path.mkdir(parents=True, exist_ok=True)
            for name, inner in held.items():
                self._write(path / name.replace("␤", "\n"), inner)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(held.encode() if isinstance(held, str) else held)

    # -- what is typed or done

    def do_collect(self, words: Sequence[str], _: object) -> None:
        options: dict[str, Any] = {}
        sources: list[Path] = []
        left = iter(words)
        for word in left:
            if word.startswith("--"):
                options[OPTIONS.get(word[2:], word[2:])] = next(left)
            else:
                place = self._folder / word.removesuffix("/*")
                sources += sorted(place.iterdir()) if word.endswith("/*") else [place]
        options["zone"] = ZoneInfo(options["zone"]) if "zone" in options else None
        if "handed_in" in options:
            options["handed_in"] = datetime.fromisoformat(options["handed_in"])
        try:
            self._report = collect(self._klass.path, sources, **options)
        except GradingError as error:
            self._error = str(error)
        else:
            self._waits = [
                (f"{one.label}|{one.student}", one.reason)
                for one in self._report.having(LineState.NOT_PLACED)
            ]

    def do_edit(self, words: Sequence[str], _: object) -> None:
        edit(self._klass, words[0], **dict(word.split("=", 1) for word in words[1:]))

    def do_submit(self, words: Sequence[str], _: object) -> None:
        self._klass.submit(words[0], words[1])

    def do_students(self, words: Sequence[str], below: Sequence[str]) -> None:
        text = str(self._held("", below)) if below else ""
        path = self._klass.path / "students.csv"
        path.write_text((ROSTER if words == ["and"] else "") + text, encoding="utf-8")
        if words == ["none"]:
            path.unlink()

    def do_lab(self, words: Sequence[str], _: object) -> None:
        """A further assignment: with the cells of lab_1_2, with other ones, or with the same under other names."""
        source, (lab, *how) = self._klass.path / "source", words
        text = (source / "lab_1_2" / "lab_1_2.ipynb").read_text()
        path = source / lab / f"{[lab, *how][-1] if how[1:] else lab}.ipynb"
        self._write(path, text)
        if how[1:]:
            self._write(path, text.replace('"grade_id": "', f'"grade_id": "{lab}-'))
            return
        release(ClassDirectory(self._klass.path))
        if how:
            self._write(path, text.replace("Talker", "Server").replace("Listener", "Client"))

    def do_notebook(self, words: Sequence[str], _: object) -> None:
        self._write(self._klass.path / "source" / words[0] / f"{words[1]}.ipynb", "{}")

    def do_configure(self, words: Sequence[str], _: object) -> None:
        self._klass.configure(f'c.NbGraderAPI.timezone = "{words[0]}"')

    def do_remove(self, words: Sequence[str], _: object) -> None:
        (self._klass.path / words[0]).unlink()

    def do_damage(self, words: Sequence[str], _: object) -> None:
        source = self._klass.path / "source" / words[0] / f"{words[0]}.ipynb"
        old, new = words[1:] if words[1:] else (source.read_text(), "<<<<<<< HEAD")
        assert old in source.read_text()
        source.write_text(source.read_text().replace(old, new))

    # -- what is true afterwards

    def see_placed(self, rest: str) -> None:
        """Exactly these have work that this command placed; - for nobody."""
        found = {f"{one.student}/{one.assignment}" for one in self._report.having(LineState.PLACED)}
        assert {one.removesuffix("/lab_1_2") for one in found} == set(rest.split()) - {"-"}

    def see_submitted(self, rest: str) -> None:
        """Exactly these notebooks are in ``submitted``."""
        folder = self._klass.path / "submitted"
        there = {
            str(path.parent.relative_to(folder)).removesuffix("/lab_1_2"): path.read_text()
            for path in folder.rglob("*.ipynb")
        }
        said = dict(one.rsplit("=", 1) for one in shlex.split(rest))
        assert there == {who: self._content(code) for who, code in said.items()}

    def see_waits(self, rest: str) -> None:
        matching = self._matching(LineState.NOT_PLACED, rest)
        self._waits = [one for one in self._waits if one not in matching]

    def see_earlier(self, rest: str) -> None:
        self._matching(LineState.EARLIER, rest)

    def see_beside(self, rest: str) -> None:
        self._matching(LineState.BESIDE, rest)

    def see_unchanged(self, rest: str) -> None:
        self._matching(LineState.UNCHANGED, rest)

    def see_again(self, rest: str) -> None:
        self._matching(LineState.PLACED, rest)

    def _matching(self, state: LineState, rest: str) -> list[tuple[str, str]]:
        """The lines in this state whose ``label|student`` and reason have these words; with ``2x``, so many."""
        often, _, after = rest.partition(" ")
        is_number = often.endswith("x") and often[:-1].isdecimal()
        name, _, words = (after if is_number else rest).partition(": ")
        lines = [(f"{one.label}|{one.student}", one.reason) for one in self._report.having(state)]
        found = [(label, reason) for label, reason in lines if name in label and words in reason]
        assert len(found) == int(often[:-1]) if is_number else found, lines
        return found

    def see_nobody(self, rest: str) -> None:
        """This student has no work; what waits is not looked at."""
        assert not (self._klass.path / "submitted" / rest).exists()
        self._waits = []

    def see_nothing(self, rest: str) -> None:
        """No file has this state."""
        assert not self._report.having(LineState(rest))

    def see_files(self, rest: str) -> None:
        assert len(self._report.outcomes) == int(rest)

    def see_note(self, rest: str) -> None:
        assert any(rest in note for note in self._report.notes), self._report.notes

    def see_no_note(self, _: str) -> None:
        assert self._report.notes == ()

    def see_cell(self, rest: str) -> None:
        (line,) = Table(ClassDirectory(self._klass.path)).waiting()
        assert line.sentence.endswith(rest)

    def see_error(self, rest: str) -> None:
        assert rest in self._error
        self._error = ""

    def see_says(self, rest: str) -> None:
        assert rest in "\n".join(report_lines(self._report))

    def see_silent(self, rest: str) -> None:
        assert rest not in "\n".join(report_lines(self._report))

    def see_time(self, rest: str) -> None:
        """The time of a student's work in UTC, or - for none."""
        who, _, time = rest.partition(" ")
        student, _, assignment = who.partition("/")
        history = CollectedRecords(self._klass.path / ".autograder").get(assignment or "lab_1_2", student)
        when = history.when if history else None
        assert f"{when or '-'}".startswith(time)
        stamp = self._klass.path / "submitted" / student / (assignment or "lab_1_2") / "timestamp.txt"
        assert (stamp.read_text() if stamp.exists() else "-").startswith(time)

    def see_page(self, rest: str) -> None:
        """The page of a student goes back to a system, under this number."""
        student, lms, number = rest.split()
        records = CollectedRecords(self._klass.path / ".autograder")
        line = line_from_lms(records, "lab_1_2", student, lms)
        assert line is not None
        assert line.number == number

    def see_kept(self, rest: str) -> None:
        """Exactly these notebooks are kept besides those that count."""
        assert kept(self._klass) == sorted(map(self._content, rest.split(", ")))

    def see_counts(self, rest: str) -> None:
        found = Counter(line["counts"].replace(" ", "-") for line in read(self._klass)[1])
        assert found == {name: int(number) for name, number in (one.split("=") for one in rest.split())}


@pytest.mark.parametrize("name", VARIANTS)
def test_collect(tiny: TinyClass, tmp_path: Path, name: str) -> None:
    case, words = VARIANTS[name]
    (tiny.path / "students.csv").write_text(ROSTER, encoding="utf-8")
    text = case["do"]
    for word, value in words.items():
        text = text.replace(f"<{word}>", value)
    _Scene(tiny, tmp_path / "in").play(text)


def test_a_file_that_waits_needs_a_line(klass: TinyClass, tmp_path: Path) -> None:
    scene = _Scene(klass, tmp_path / "in")
    with pytest.raises(AssertionError, match="these wait"):
        scene.play("c.zip:\n  guest/lab_1_2.ipynb = 3\n> collect c.zip\n")
