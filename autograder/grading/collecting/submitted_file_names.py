"""Reads the facts in the names of submitted files, such as student and time.

The names have the form of a learning management system (LMS), or the form that the instructor describes with
``collect --names '{id}-{last}_{assignment}'``.
"""

from __future__ import annotations

import functools
import itertools
import unicodedata
from collections import defaultdict
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING

import re2
from babel.core import Locale

from autograder.grading.grading_errors import GradingError
from autograder.grading.table.roster import Identity
from autograder.safe_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

    _IdentityReader = Callable[[Mapping[str, str]], tuple[Identity, tuple[Identity, ...]]]
    """A function that gets the groups of a pattern. It returns the student; and if the name can be read in several
    ways, the student according to each way.
    """
    _Reader = Callable[[Sequence[str], int], "NameFacts | None"]
    """A function that returns the facts in the name at one index of a path; None if it has another form."""


@dataclass(frozen=True)
class NameFacts:
    """The facts in the path of a file.

    Attributes:
        identity: The student, as the system names this student.
        file: The name that the student gave the file.
        when: The time of handing in, in the LMS's own time; None if the name contains no readable time.
        order: A number that increases with later files of one student, if the LMS numbers files.
        late: True if the LMS marks the file as late.
        readings: If the name can be read in several ways, the student according to each way, with the longest name
            first; else empty. Use the first of these students who is in the class.
        assignment: The assignment, if the instructor's pattern finds one in the name.
    """

    identity: Identity
    file: str
    when: datetime | None = None
    order: int = 0
    late: bool = False
    readings: tuple[Identity, ...] = ()
    assignment: str = ""


def read_lms_name(
    parts: Sequence[str], place: int, form: str, is_notebook: Callable[[str], bool]
) -> NameFacts | None:
    """Return the facts in one name of a path, if it has the form of this LMS; None if it has another form.

    Args:
        parts: The folders of the path and the file, without ``..``. Accents are in composed form (Unicode NFC).
        place: The index of the name in the path.
        form: A key of :data:`_READERS`.
        is_notebook: Returns True for the name of a notebook of the class; needed for forms that resemble other names.
    """
    is_folder = place < len(parts) - 1
    found = _READERS[form](parts, place)
    if found is None or form != "canvas":
        return found
    if found.file != parts[-1] and is_notebook(parts[-1]):
        return None  # lab_1_2_3.ipynb and "lab_1_2 - Copy.ipynb" are names that a student chose
    if is_folder:
        return found if found.order >= 100 else None  # lab_1_2_submissions is a name that an instructor chose
    # A name from Blackboard, such as lab_1_2_ada_attempt_..., may have the form of Canvas's names. But Canvas writes
    # names in lower case, and numbers the users and files of its whole site: no student is among the first nine users
    # and has also sent one of the first nine files.
    login, number = found.identity.login, found.identity.number
    if login != login.lower() or (len(number) == 1 and found.order < 10):
        return None if _READERS["blackboard"](parts, place) else found
    return found


def read_plain_name(name: str, file: str) -> NameFacts:
    """Return the facts in a name that is a student's id or name, or a user name on GitHub."""
    return NameFacts(
        Identity(), file, readings=(Identity(login=name, name=name), Identity("github", number=name))
    )


# Browsers, Canvas and Drive add one of these marks to a name that already exists, and file managers add one to the name
# of a copy.
_COPY_OF = "Copy of "
_MARKED = re2.compile(rf"(?s)^(?:{_COPY_OF})*(?P<base>.+?)(?: ?\(\d{{1,6}}\)|-\d{{1,6}}| - [Cc]opy)*$")


def base_of(stem: str) -> str:
    """Return a name without what programs add to the name of a copy, such as `` (1)`` or ``Copy of``."""
    found = _MARKED.match(name_as_text(stem))
    return found["base"] if found else name_as_text(stem)


def canvas_numbers(name: str) -> list[str]:
    """Return all numbers in a Canvas name that may be the student's; names of users and files may have numbers, too."""
    pieces = name.split("_")[1:-1]
    return [one for one, file in itertools.pairwise(pieces) if f"{one}{file}".isdecimal() and len(file) >= 3]


_PATTERN_WORDS = (
    "id",
    "email",
    "login",
    "number",
    "name",
    "first",
    "last",
    "assignment",
    "time",
    "file",
    "any",
)
_NOT_WHO = {"any", "assignment", "time", "file"}
_MOST_WAYS = 100
"""The maximum number of ways to divide a name that are tried; real names need a few."""
_WORD = re2.compile(r"\{([^{}]*)\}")


def check_names(pattern: str, columns: Collection[str]) -> None:
    """Check a pattern given with ``--names``.

    Args:
        pattern: The pattern to check.
        columns: The columns of ``students.csv`` that the pattern may contain.

    Raises:
        GradingError: The pattern contains an unknown word, a word twice, or no word that identifies a student.
    """
    words = [word for word in _WORD.findall(pattern) if word != "any"]
    identifying = set(words) & {*_PATTERN_WORDS[:7], *columns}
    if set(words) - {*_PATTERN_WORDS, *columns} or len(set(words)) < len(words) or not identifying:
        known = ", ".join(f"{{{word}}}" for word in (*_PATTERN_WORDS, *columns))
        raise GradingError(
            f"--names {pattern!r} cannot be used. Use each of {known} at most once, and at least one that "
            "identifies the student. For example: '{id}-{last}_{assignment}'."
        )


def read_names(pattern: str) -> Callable[[Sequence[str], int], NameFacts | None]:
    """Return a function that reads a path according to a pattern.

    The pattern has to fit from the top of the path, or to identify the student by one of the path's first ``levels``
    names, because a student may have chosen any name below these.

    A pattern without a slash describes a single name: a file without its suffix, or a folder around it. A pattern
    with slashes describes names that follow each other in a path. ``{any}`` stands for any text. A word that is not
    in :data:`_PATTERN_WORDS` stands for a column of ``students.csv``.
    """
    words = _WORD.findall(pattern)
    literals = [unicodedata.normalize("NFC", one).casefold() for one in _WORD.split(pattern)[::2]]
    number = pattern.count("/") + 1
    identifying = (
        place for place, name in enumerate(pattern.split("/")) if set(_WORD.findall(name)) - _NOT_WHO
    )
    who = next(identifying, 0)

    def read(parts: Sequence[str], levels: int) -> NameFacts | None:
        for place in range(min(len(parts) - number + 1, max(levels - who, 1))):
            *above, last = parts[place : place + number]
            bare = last.rpartition(".")[0] if place + number == len(parts) else ""
            texts = ("/".join([*above, name]) for name in (bare, last) if name)
            ways = (list(itertools.islice(_ways(text, literals, words), _MOST_WAYS)) for text in texts)
            if divided := next(filter(None, ways), None):
                # Use the longest possible time, because in 2025-10-03_140506_lab the day alone would be a time, too.
                divided.sort(
                    key=lambda way: -len(way.get("time", "")) if read_time(way.get("time", "")) else 0
                )
                # Return all ways to divide the name, because ben_b_7 may belong to ben or to ben_b.
                found = [_found(way, parts[-1]) for way in divided]
                return replace(found[0], readings=tuple(dict.fromkeys(one.identity for one in found)))
        return None

    return read


def _ways(text: str, literals: Sequence[str], words: Sequence[str]) -> Iterator[dict[str, str]]:
    """Yield all ways to divide a text into the words between these literals."""
    folded, first = text.casefold(), literals[0]
    if len(folded) != len(text) or not folded.startswith(first):
        return
    text, folded = text[len(first) :], folded[len(first) :]
    if not words:
        if not text:
            yield {}
        return
    for end in range(words[0] != "any", len(text) + 1):
        if "/" in text[:end]:
            return
        if folded.startswith(literals[1], end):
            for way in _ways(text[end:], literals[1:], words[1:]):
                yield {words[0]: text[:end], **way}


def _found(said: dict[str, str], file: str) -> NameFacts:
    word = {name: value.strip() for name, value in said.items()}
    login = word.get("id") or word.get("email") or word.get("login") or word.get("number") or ""
    name = word.get("name") or f"{word.get('first', '')} {word.get('last', '')}".strip()
    column = next((one for one in word if one not in _PATTERN_WORDS), "")
    number = word.get(column, "")
    identity = Identity(column, number, login, name)
    return NameFacts(
        identity,
        word.get("file") or file,
        when=read_time(word.get("time", "")),
        assignment=base_of(word.get("assignment", "")),
    )


_LANGUAGES = ("en", "de", "fr", "es", "it", "nl", "pt", "sv", "da", "nb", "fi", "pl", "cs", "tr")
_NO_MARKS = str.maketrans(dict.fromkeys(",.:"))
_IN_NUMBERS = ("%Y-%m-%d-%H-%M-%S", "%Y-%m-%d %H:%M:%S %z")


def read_time(text: str) -> datetime | None:
    """Return a time from a name or a list, without regard to its time zone; None if it cannot be read.

    Besides ISO 8601, it reads Blackboard's form (``2025-10-03-14-05-06``), and dates in words as Moodle (``Friday, 3
    October 2025, 2:05 PM``) and Brightspace (``Oct 3, 2025 205 PM``, because the name of a folder cannot contain a
    colon) write them.
    """
    text = text.strip().removesuffix(" UTC") + (" +0000" if text.strip().endswith(" UTC") else "")
    text = text.replace(" Z", "Z")  # YAML writes a space before the Z
    readers: list[Callable[[], datetime]] = [lambda: datetime.fromisoformat(text)]
    readers += [functools.partial(datetime.strptime, text, form) for form in _IN_NUMBERS]
    readers.append(lambda: _in_words(text.translate(_NO_MARKS).casefold()))
    for read in readers:
        try:
            return read()
        except ValueError:
            continue
    return None


def _in_words(text: str) -> datetime:
    """Parse a date with the month as a word before or after the day, then the year and the time of day.

    Raises:
        ValueError: The text is not such a date.
    """
    words = text.split()
    (month,) = (_months()[word] for word in words if word in _months())
    day, year, clock = ("".join(filter(str.isdecimal, word)) for word in words if word[0].isdecimal())
    hour, minute = int(clock[:-2]), int(clock[-2:])
    half = next((half for half in ("am", "pm") if text.endswith(half)), "")
    hour = hour % 12 + 12 * (half == "pm") if half and 0 < hour <= 12 else hour
    return datetime(int(year) if len(year) == 4 else 0, month, int(day), hour, minute)


@functools.cache
def _months() -> dict[str, int]:
    """Return the numbers of the months by name and short form, in several languages. Ambiguous words are left out."""
    meant: dict[str, set[int]] = defaultdict(set)
    for language in _LANGUAGES:
        months = Locale.parse(language).months
        for form, width in itertools.product(("format", "stand-alone"), ("wide", "abbreviated")):
            for number, name in months[form][width].items():
                meant[name.replace(".", "").casefold()].add(number)
    meant["sept"].add(9)
    return {name: numbers.pop() for name, numbers in meant.items() if len(numbers) == 1}


def _name_reader(pattern: str, identity_of: _IdentityReader, *, is_file_named: bool = False) -> _Reader:
    """Return a reader for names in which one folder, or the file, contains all facts.

    Args:
        pattern: The pattern of the name. Its groups ``file``, ``when``, ``order`` and ``late`` are the fields of
            :class:`NameFacts`.
        identity_of: Returns the student from the groups of the pattern; and if the name can be read in several ways,
            the student according to each way.
        is_file_named: True if the name of a file, unlike that of a folder, has to contain the group ``file``.
    """
    expression = re2.compile(f"(?s){pattern}")  # (?s) because a name may contain line breaks

    def read(parts: Sequence[str], place: int) -> NameFacts | None:
        match = expression.match(parts[place])
        found = match.groupdict() if match else {}
        is_file = place == len(parts) - 1
        if not match or (is_file_named and is_file and found.get("file") is None):
            return None
        identity, readings = identity_of(found)
        file, time = found.get("file") if is_file else parts[-1], found.get("when") or ""
        order, late = int(found.get("order") or 0), bool(found.get("late"))
        file = parts[place] if file is None else file
        return NameFacts(identity, file, read_time(time), order, late, readings)

    return read


def _plain_fields(lms: str) -> _IdentityReader:
    """Return a reader for names whose groups ``number``, ``login`` and ``name`` need no further interpretation."""
    return lambda found: (
        Identity(lms, **{one: found.get(one) or "" for one in ("number", "login", "name")}),
        (),
    )


def _moodle(found: Mapping[str, str]) -> tuple[Identity, tuple[Identity, ...]]:
    # For group work, or if a group is selected, the name of the group comes first, as in Group A-Ada Lovelace.
    names = [found["name"], *_ends(found["name"], "-")]
    readings = tuple(Identity("moodle", found["number"], name=name) for name in names)
    return readings[0], readings


def _login_at_the_end(lms: str) -> _IdentityReader:
    """Return a reader for names that end with a mark and a user name, which may itself contain the mark."""

    def who(found: Mapping[str, str]) -> tuple[Identity, tuple[Identity, ...]]:
        whole = f"{found['item']}_{found['login']}"
        named = {end: whole.removesuffix(end).replace("_", " ").strip() for end in _ends(whole, "_")}
        readings = tuple(
            Identity(lms, login=login, name=name if lms == "ilias" else "") for login, name in named.items()
        )
        return readings[-1], readings

    return who


_MOST_MARKS = 10
"""The maximum number of hyphens or underscores at which a name is divided; real names have fewer."""


def _ends(text: str, mark: str) -> list[str]:
    """Return the ends of a text after its last few marks, such as hyphens: for ``a-b-c``, ``b-c`` and ``c``."""
    pieces = text.rsplit(mark, _MOST_MARKS)[1:]
    return [end for start in range(len(pieces)) if (end := mark.join(pieces[start:]).strip())]


_READERS = {
    # Ada Lovelace_12345_assignsubmission_file_lab_1_2.ipynb. Since Moodle 4.1 (before that, if folders were chosen)
    # this is the name of a folder.
    "moodle": _name_reader(
        r"^(?P<name>[^_]+)_(?P<number>\d+)_assignsubmission_(?:file|onlinetext)_?(?P<file>.*)$", _moodle
    ),
    # lab_1_2_adal_attempt_2025-10-03-14-05-06_lab_1_2.ipynb. If .txt follows the time instead of a file's name, the
    # file contains what the student typed. The first "attempt" in the name is Blackboard's, because the student chose
    # only the file's name.
    "blackboard": _name_reader(
        r"^(?P<item>.+?)_(?P<login>[^_]+)_attempt_(?P<when>\d{4}(?:-\d\d){5})(?:_(?P<file>.+)|\.txt)$",
        _login_at_the_end("blackboard"),
    ),
    # 12345-67890 - Ada Lovelace - Oct 3, 2025 205 PM is the name of a folder. The name of a file also has " -
    # lab_1_2.ipynb" at the end. The form of the date depends on the language of the course: for example, 3 October,
    # 2025 1405.
    "brightspace": _name_reader(
        r"^(?P<number>\d+)-\d+ ?- ?(?P<name>.+?) ?- ?"
        r"(?P<when>(?:[^\d\s,.-]+\.? \d\d?|\d\d?\.? (?:de )?[^\d\s,.-]+\.?),? (?:de )?\d{4} "
        r"\d\d?[:.h]?\d\d(?: ?[AaPp]\.?[Mm]\.?)?)"
        r"(?: ?- ?(?P<file>.+))?$",
        _plain_fields("brightspace"),
        is_file_named=True,
    ),
    # lovelaceada_LATE_123_456_lab_1_2-1.ipynb: first the number of the student, then that of the file. The name may be
    # empty, for example for a user named 🙂, because Canvas keeps only the word characters of a name
    # (github.com/instructure/canvas-lms, content_zipper.rb).
    "canvas": _name_reader(
        r"^(?P<login>[\pL\pM\pN_-]*?)_(?i:(?P<late>LATE)_)?(?P<number>\d+)_(?P<order>\d+)_(?P<file>.+)$",
        _plain_fields("canvas"),
    ),
    # Lab 1.2/Lovelace, Ada(ada)/Submission attachment(s)/lab_1_2.ipynb
    "sakai": _name_reader(
        r"^(?P<name>[^,()]+, [^()]*)\((?P<login>[^()]+)\)$", _plain_fields("sakai"), is_file_named=True
    ),
    # Lab 1.2/Lovelace_Ada_ada_12345/lab_1_2.ipynb (from memory)
    "ilias": _name_reader(
        r"^(?P<item>[^_]+_.+?)_(?P<login>[^_]+)_\d+$", _login_at_the_end("ilias"), is_file_named=True
    ),
    # assignment_123_export/submission_456/lab_1_2.ipynb
    "gradescope": _name_reader(
        r"^submission_(?P<number>\d+)$", _plain_fields("gradescope"), is_file_named=True
    ),
}
TOLD_APART = tuple(form for form in _READERS if form != "ilias")
"""The forms that can be recognized from the names alone. A name from ILIAS resembles many others, so that form is used
only if the instructor names the system.
"""
