"""``collected.csv``: one line for each file, with what ``collect`` decided. What people write there takes precedence.

A cell counts as written by a person if it differs from the same cell in the table that ``collect`` wrote. To compare
them, a copy of each table is kept, and the table's header contains the number of its copy. This works even if the table
was open in a spreadsheet while another ``collect`` wrote a new table.
"""

from __future__ import annotations

import contextlib
import itertools
from collections import defaultdict
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING, Any

import msgspec
import re2
from babel.core import Locale, UnknownLocaleError, get_global
from babel.dates import parse_date

from autograder.grading.collecting.collected_files import INBOX_FOLDER, SHORT_KEY, LineState
from autograder.grading.collecting.file_to_grade import cell_in
from autograder.grading.collecting.inbox_lines import Edit
from autograder.grading.collecting.list_times import in_utc
from autograder.grading.collecting.written_times import read_time
from autograder.grading.table.spreadsheet_csv import csv_rows, csv_text, defused, original
from autograder.safe_files import write_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from autograder.grading.classes.class_directory import ClassDirectory
    from autograder.grading.collecting.collected_files import Line

NAME = "collected.csv"
COLUMNS = (
    "use", "counts", "student", "assignment", "notebook", "handed_in", "system", "number", "name", "file", "reason",
)  # fmt: skip
_EDITABLE = ("use", "student", "assignment", "notebook", "handed_in")
_WAITS = "waits"
_WORDS = {
    LineState.PLACED: "yes",
    LineState.UNCHANGED: "the same",
    LineState.EARLIER: "earlier",
    LineState.BESIDE: "beside",
    LineState.NOT_PLACED: _WAITS,
    LineState.LEFT_OUT: "no",
}
_FIRST = (_WAITS, "yes")
_YES = frozenset(["yes", "y", "ja", "j", "x", "1", "true", "wahr", "oui", "si", "sí"])
_NO = frozenset(["no", "n", "nein", "0", "false", "falsch", "non"])
_KEY = re2.compile(r"#[0-9a-f]{10,64}$")
_WHOLE_KEY = re2.compile(r"#[0-9a-f]{64}")
_CLOCKS = ("", "%H:%M", "%H:%M:%S", "%I:%M %p", "%I:%M:%S %p")
_STAMP = re2.compile(r"table (\d+)")
# Matches values that a spreadsheet would take for a number, a date or a boolean.
_TURNS = re2.compile(r"(?i)^(?:[\d.,]|[a-zäéû]{3,9}[ .-]*\d+$|(?:true|false|wahr|falsch)$)")


@dataclass(frozen=True)
class Waiting:
    """A line of the table that waits for the decision of a person.

    Attributes:
        label: The name of the file, with the key of its line.
        reason: Why the line waits, and what to do.
        student: The id of the student; empty if unknown.
        assignment: The name of the assignment; empty if unknown.
        line: The line number in the table.
    """

    label: str
    reason: str
    student: str
    assignment: str
    line: int

    @property
    def sentence(self) -> str:
        """Return a sentence that says why the file waits for a person, and which cell of the table to edit."""
        cell = f"({NAME}, line {self.line}, cell {cell_in(self.reason) or 'use'})"
        return f"{self.student}{': ' if self.student else ''}{self.reason} {cell}"


class Table:
    """The table ``collected.csv`` of a class.

    Args:
        directory: The class.
    """

    def __init__(self, directory: ClassDirectory) -> None:
        self.path = directory.path / NAME
        self._copies = directory.state / INBOX_FOLDER / "tables"
        self._edits_file = directory.state / INBOX_FOLDER / "edits.json"
        self._zone = directory.time_zone
        self._locale = _locale_of(self._zone.key)

    @property
    def is_edited(self) -> bool:
        """Return True if the table was changed after ``collect`` wrote it."""
        try:
            return self.path.read_bytes() != _shown(self._copy(self._newest).read_bytes().decode("utf-8-sig"))
        except OSError:
            return False

    def take_edits(self, keys: Iterable[str]) -> tuple[dict[str, Edit], list[str]]:
        """Read what people have written into the table, and store it for later commands.

        Args:
            keys: The keys of all files in the inbox. A class may have stored only the first ten digits of them.

        Returns:
            All edits, from now and from earlier commands, by the key of the line; and a sentence about each unclear
            line or cell.

        Raises:
            OSError: The edits could not be stored.
        """
        try:
            before = msgspec.json.decode(self._edits_file.read_bytes(), type=dict[str, Edit])
        except (OSError, msgspec.MsgspecError):
            before = {}
        wholes = _by_short(keys)
        edits, notes = self._read({_whole(key, wholes): edit for key, edit in before.items()}, wholes)
        kept = {key: edit for key, edit in sorted(edits.items()) if edit != Edit()}
        if kept != before:
            write_whole(self._edits_file, msgspec.json.encode(kept))
        return edits, notes

    def _read(
        self, earlier: Mapping[str, Edit], wholes: Mapping[str, Sequence[str]]
    ) -> tuple[dict[str, Edit], list[str]]:
        """Return the earlier edits with those of the table, and a sentence about each unclear line or cell."""
        edits = dict(earlier)
        try:
            data = self.path.read_bytes()
        except OSError:
            missing = [f"{NAME} was missing: it is written again, with everything that was edited before"]
            return edits, missing if self._newest else []
        rows, stamp = _rows(data)
        if rows is None:
            return edits, [
                f"{NAME} has no line that names its columns, so nothing was read from it: it is written again"
            ]
        before = {_whole(row["file"], wholes): row for row in (_rows(self._read_copy(stamp))[0] or [])}
        shown = _by_short(before)
        notes: list[str] = []
        lines: dict[str, list[dict[str, str]]] = defaultdict(list)
        for row in rows:
            lines[_whole(row["file"], shown)].append(row)
        for key, several in lines.items():
            if any(one != several[0] for one in several):
                notes.append(
                    f"{NAME} has {len(several)} different lines for {key[:SHORT_KEY]}: nothing was read from them"
                )
            elif key not in before:
                notes.append(
                    f"{NAME} has a line for {key or 'no file'}, but no such file was collected: the line was ignored"
                )
            else:
                edits[key] = self._read_line(key, several[0], before[key], edits.get(key, Edit()), notes)
        if gone := len(before.keys() - lines.keys()):
            notes.append(
                f"{NAME} lacks {gone} lines: they are written again. To leave a file out, write no under use"
            )
        return edits, notes

    def _read_line(
        self, key: str, row: Mapping[str, str], before: Mapping[str, str], edit: Edit, notes: list[str]
    ) -> Edit:
        for column in _EDITABLE:
            written, was = row[column].strip(), before[column].strip()
            value, old = self._value(column, written), self._value(column, was)
            if value is None:
                what = "neither yes nor no" if column == "use" else "not a time: write 2026-01-31 14:05"
                notes.append(f"{NAME}, line of {key[:SHORT_KEY]}, column {column}: {written!r} is {what}")
            elif value.casefold() != (old or "").casefold():
                edit = replace(edit, **{column: value})
        return edit

    def _value(self, column: str, written: str) -> str | None:
        """Return the value of a cell in one form, such as ``yes`` for *ja*; None if the cell is unclear."""
        if column == "use" and written:
            word = written.casefold()
            return "yes" if word in _YES else "no" if word in _NO else None
        return self._time(written) or None if column == "handed_in" and written else written

    def _time(self, written: str) -> str:
        """Return a time written by a person or a spreadsheet, in UTC; empty if it is not a time."""
        when = read_time(written)
        day, _, clock = written.strip().replace(",", "").partition(" ")
        for form in _CLOCKS if when is None else ():
            with contextlib.suppress(ValueError, IndexError):
                # In a date such as 3/4/2026, the country of the class decides which number is the month.
                when = datetime.combine(parse_date(day, self._locale), datetime.strptime(clock, form).time())
        found = in_utc(when, self._zone)
        return found.isoformat() if found else ""

    def write(self, decided: Iterable[Line], edits: Mapping[str, Edit]) -> None:
        """Write the table if its content has changed.

        Raises:
            OSError: The table could not be written.
        """
        lines = defaultdict(list)
        for one in decided:
            lines[one.key].append(one)
        rows = sorted(
            (self._row(several, edits.get(key, Edit())) for key, several in lines.items()),
            key=lambda row: (
                _FIRST.index(row[1]) if row[1] in _FIRST else len(_FIRST), row[3], row[2], row[4], row[9],
            ),
        )  # fmt: skip
        number = self._newest
        if rows and (not self.path.exists() or _shown(self._text(number, rows)) != self.path.read_bytes()):
            text = self._text(number + 1, rows)
            write_whole(self._copy(number + 1), text.encode("utf-8-sig"))
            write_whole(self.path, _shown(text))

    def _text(self, number: int, rows: Iterable[Sequence[str]]) -> str:
        symbol = self._locale.number_symbols.get("latn", {}).get("decimal", ".")
        header = [*COLUMNS[:-1], f"{COLUMNS[-1]} (table {number})"]
        text = csv_text([header, *rows], ";" if symbol == "," else ",", "\r\n")
        return text.encode("utf-8", "replace").decode()

    def _row(self, several: Sequence[Line], edit: Edit) -> list[str]:
        """Return the row for a file. For the work of a group, ``several`` has a line for each student."""
        first = (LineState.NOT_PLACED, LineState.PLACED)
        line = min(several, key=lambda one: first.index(one.state) if one.state in first else len(first))
        students = "; ".join(dict.fromkeys(id_ for one in several for id_ in one.students)) or edit.student
        assignments = "; ".join(sorted({one.assignment for one in several} - {""})) or edit.assignment
        where = (line.use, _WORDS[line.state], students, assignments, line.notebook or edit.notebook)
        when = f"{line.when.astimezone(self._zone):%Y-%m-%d %H:%M:%S %z}" if line.when else ""
        whence = (line.lms, line.number, line.name, f"{line.label} {line.key}", line.reason)
        return [*map(_guarded, where), when, *map(_guarded, whence)]

    def rename(self, ids: Mapping[str, str]) -> None:
        """Write other ids of students into the column ``student``, as a person would.

        Args:
            ids: The new ids by the old ones.

        Raises:
            OSError: The table could not be written.
        """
        if not self.path.exists():
            return
        (header, *rows), separator = csv_rows(self.path.read_bytes())
        places = [place for place, name in enumerate(header) if name.strip().lower() == "student"]
        for place, row in itertools.product(places, rows):
            students = _unguarded(row[place]).split("; ") if place < len(row) else ()
            if not ids.keys().isdisjoint(students):
                row[place] = _guarded("; ".join(dict.fromkeys(ids.get(one, one) for one in students)))
        write_whole(self.path, csv_text([header, *rows], separator, "\r\n").encode("utf-8-sig"))

    @property
    def _newest(self) -> int:
        return max(
            map(int, filter(str.isdecimal, (path.stem for path in self._copies.glob("*.csv")))), default=0
        )

    def _copy(self, number: int) -> Any:
        return self._copies / f"{number}.csv"

    def _read_copy(self, stamp: int) -> bytes:
        path = self._copy(stamp)
        path = path if path.exists() else self._copy(self._newest)
        return path.read_bytes() if path.exists() else b""

    def lines(self) -> list[dict[str, str]]:
        """Return the lines of the table that ``collect`` wrote last, each as a dictionary by column."""
        return _rows(self._read_copy(self._newest), whole=True)[0] or []

    def waiting(self) -> list[Waiting]:
        """Return the lines that wait for a person, from the table that ``collect`` wrote last."""
        waiting = []
        for number, row in enumerate(self.lines(), 2):
            label = _KEY.sub(lambda key: key[0][:SHORT_KEY], row["file"])
            if row["counts"] == _WAITS:
                waiting.append(Waiting(label, row["reason"], row["student"], row["assignment"], number))
        return waiting


def _rows(data: bytes, *, whole: bool = False) -> tuple[list[dict[str, str]] | None, int]:
    """Return the lines of a table, which any spreadsheet program may have saved, and the number of the table.

    Each line is a dictionary by column. Its cell ``file`` is shortened to the key of the line, unless ``whole`` is
    true. If the first line does not name the columns, None is returned instead of lines.
    """
    header, *lines = csv_rows(data)[0] or [[]]
    stamp = _STAMP.search(" ".join(header))
    columns = [name.partition(" (")[0].strip().lower() for name in header]
    if not {"use", "file"} <= set(columns):
        return None, 0
    cells = (dict(zip(columns, map(_unguarded, line), strict=False)) for line in lines)
    rows = [{**dict.fromkeys(COLUMNS, ""), **row} for row in cells if any(row.values())]
    for row in () if whole else rows:
        key = _KEY.search(row["file"].strip())
        row["file"] = key[0] if key else row["file"]
    return rows, int(stamp[1]) if stamp else 0


def _shown(text: str) -> bytes:
    """Return the text of a table in which each key is cut, but not so far that two of them become equal."""
    keys = set(_WHOLE_KEY.findall(text))
    lengths = range(SHORT_KEY, 66)
    length = next(length for length in lengths if len({key[:length] for key in keys}) == len(keys))
    return _WHOLE_KEY.sub(lambda key: key[0][:length], text).encode("utf-8-sig")


def _by_short(keys: Iterable[str]) -> dict[str, list[str]]:
    several: dict[str, list[str]] = defaultdict(list)
    for key in keys:
        several[key[:SHORT_KEY]].append(key)
    return several


def _whole(key: str, known: Mapping[str, Sequence[str]]) -> str:
    """Return the only known key that begins with the shown one; the shown one itself if there are several or none."""
    meant = [one for one in known.get(key[:SHORT_KEY], ()) if one.startswith(key)]
    return meant[0] if len(meant) == 1 else key


def _guarded(cell: str) -> str:
    """Return a cell changed so that a spreadsheet neither executes it nor takes it for a number or a date."""
    safe = defused(cell)
    return f"'{safe}" if safe == cell and _TURNS.match(cell) else safe


def _unguarded(cell: str) -> str:
    return cell[1:] if cell[:1] == "'" and _TURNS.match(cell[1:]) else original(cell)


def _locale_of(zone: str) -> Locale:
    """Return the conventions of a time zone's country: the separator in spreadsheets, and the order of a date."""
    territory = get_global("zone_territories").get(zone, "001")
    try:
        return Locale.parse(f"und_{territory}")
    except (ValueError, UnknownLocaleError):
        return Locale("en")
