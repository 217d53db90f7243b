"""Reads the facts in the names of submitted files, such as student and time.

The names have the form of a row in ``systems.toml``, or the form that the instructor describes with
``collect --names '{id}-{last}_{assignment}'``.
"""

from __future__ import annotations

import functools
import itertools
import unicodedata
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import re2

from autograder.grading.collecting.systems import NAME_FORMS
from autograder.grading.collecting.written_times import read_time
from autograder.grading.grading_errors import GradingError
from autograder.grading.table.roster import Identity
from autograder.safe_files import name_as_text

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from datetime import datetime

    from autograder.grading.collecting.systems import NameForm


@dataclass(frozen=True)
class NameFacts:
    """The facts in the path of a file.

    Attributes:
        identities: The student, as the system names this student; if the name can be read in several ways, the student
            according to each way, with the usual way first.
        file: The name that the student gave the file.
        when: The time of handing in, in the LMS's own time; None if the name contains no readable time.
        order: A number that increases with later files of one student, if the LMS numbers files.
        late: True if the LMS marks the file as late.
        assignment: The assignment, if the instructor's pattern finds one in the name.
        rivals: Other students whom the name may mean. They only make it doubtful, because a student may have chosen the
            part of the name that says so.
    """

    identities: tuple[Identity, ...]
    file: str
    when: datetime | None = None
    order: int = 0
    late: bool = False
    assignment: str = ""
    rivals: tuple[Identity, ...] = ()

    @property
    def identity(self) -> Identity:
        """The student, as the system usually names this student."""
        return self.identities[0]


@functools.cache
def _compiled(system: str) -> re2._Regexp[str]:
    return re2.compile(f"(?s){NAME_FORMS[system].pattern}")  # (?s) because a name may contain line breaks


def read_lms_name(parts: Sequence[str], place: int, system: str) -> NameFacts | None:
    """Return the facts in one name of a path, if it has the form of this LMS; None if it has another form.

    Args:
        parts: The folders of the path and the file, without ``..``. Accents are in composed form (Unicode NFC).
        place: The index of the name in the path.
        system: A key of :data:`NAME_FORMS`.
    """
    form, is_file = NAME_FORMS[system], place == len(parts) - 1
    match = _compiled(system).match(parts[place])
    found = {group: value or "" for group, value in match.groupdict().items()} if match else {}
    order = int(found.get("order") or 0)
    if not match or (form.needs_file and is_file and not found.get("file")) or order < form.least_order:
        return None
    return NameFacts(
        _identities(form, found),
        found.get("file", parts[place]) if is_file else parts[-1],
        read_time(found.get("when", "")),
        order,
        bool(found.get("late")),
        rivals=_rivals(form, parts[place]),
    )


def _rivals(form: NameForm, text: str) -> tuple[Identity, ...]:
    """Return every student to whom a number in a file's name may belong, for a system with numbers in user names."""
    pieces = text.split("_")[1:-1] if form.divide == "number" else []
    pairs = itertools.pairwise(pieces)
    return tuple(
        Identity(form.system, one) for one, file in pairs if f"{one}{file}".isdecimal() and len(file) > 2
    )


def _identities(form: NameForm, found: Mapping[str, str]) -> tuple[Identity, ...]:
    """Return the student; and if the name can be read in several ways, the student according to each way."""
    usual = Identity(form.system, *(found.get(one, "") for one in ("number", "login", "name")))
    if form.divide == "name":
        return (usual, *(replace(usual, name=end) for end in _ends(usual.name, "-")))
    if form.divide == "login":
        whole = f"{found['item']}_{usual.login}"
        # Only ILIAS puts the name in front of the login; in front of Blackboard's login is the title of the assignment.
        names = {
            end: whole.removesuffix(end) if form.needs_from else "" for end in reversed(_ends(whole, "_"))
        }
        return tuple(
            Identity(form.system, login=end, name=name.replace("_", " ").strip())
            for end, name in names.items()
        )
    return (usual,)


_MOST_MARKS = 10
"""The maximum number of hyphens or underscores at which a name is divided; real names have fewer."""


def _ends(text: str, mark: str) -> list[str]:
    """Return the ends of a text after its last few marks, such as hyphens: for ``a-b-c``, ``b-c`` and ``c``."""
    pieces = text.rsplit(mark, _MOST_MARKS)[1:]
    return [end for start in range(len(pieces)) if (end := mark.join(pieces[start:]).strip())]


def read_plain_name(name: str, file: str) -> NameFacts:
    """Return the facts in a name that is a student's id or name, or a user name on GitHub."""
    return NameFacts((Identity(login=name, name=name), Identity("github", number=name)), file)


# Browsers, Canvas and Drive add one of these marks to a name that already exists, and file managers add one to the name
# of a copy.
_COPY_OF = "Copy of "
_MARKED = re2.compile(rf"(?s)^(?:{_COPY_OF})*(?P<base>.+?)(?: ?\(\d{{1,6}}\)|-\d{{1,6}}| - [Cc]opy)*$")


def base_of(stem: str) -> str:
    """Return a name without what programs add to the name of a copy, such as `` (1)`` or ``Copy of``."""
    found = _MARKED.match(name_as_text(stem))
    return found["base"] if found else name_as_text(stem)


_WHO = ("id", "email", "login", "number", "name", "first", "last")
_NOT_WHO = ("assignment", "time", "file", "any")
_MOST_WAYS = 100
"""The maximum number of ways to divide a name that are tried; real names need a few."""
_WORD = re2.compile(r"\{([^{}]*)\}")


class Pattern:
    """A pattern given with ``--names``.

    A pattern without a slash describes a single name: a file without its suffix, or a folder around it. A pattern
    with slashes describes names that follow each other in a path. ``{any}`` stands for any text. A word that is none of
    these words stands for a column of ``students.csv``.

    Args:
        pattern: The pattern.
    """

    def __init__(self, pattern: str) -> None:
        self._pattern = pattern
        self._words = _WORD.findall(pattern)
        self._literals = [unicodedata.normalize("NFC", one).casefold() for one in _WORD.split(pattern)[::2]]
        names = enumerate(pattern.split("/"))
        self._who = next((place for place, name in names if set(_WORD.findall(name)) - {*_NOT_WHO}), 0)

    def check(self, columns: Collection[str]) -> None:
        """Check the pattern.

        Args:
            columns: The columns of ``students.csv`` that the pattern may contain.

        Raises:
            GradingError: The pattern contains an unknown word, a word twice, or no word that identifies a student.
        """
        words, who = [word for word in self._words if word != "any"], {*_WHO, *columns}
        if set(words) - who - {*_NOT_WHO} or len(set(words)) < len(words) or not set(words) & who:
            known = ", ".join(f"{{{word}}}" for word in (*_WHO, *_NOT_WHO, *columns))
            raise GradingError(
                f"--names {self._pattern!r} cannot be used. Use each of {known} at most once, and at least one that "
                "identifies the student. For example: '{id}-{last}_{assignment}'."
            )

    def read(self, parts: Sequence[str], levels: int) -> NameFacts | None:
        """Return the facts in a path; None if the pattern does not fit.

        The pattern has to fit from the top of the path, or to identify the student by one of the path's first
        ``levels`` names, because a student may have chosen any name below these.
        """
        number = self._pattern.count("/") + 1
        for place in range(min(len(parts) - number + 1, max(levels - self._who, 1))):
            *above, last = parts[place : place + number]
            bare = last.rpartition(".")[0] if place + number == len(parts) else ""
            texts = ("/".join([*above, name]) for name in (bare, last) if name)
            ways = (
                list(itertools.islice(_ways(text, self._literals, self._words), _MOST_WAYS)) for text in texts
            )
            if divided := next(filter(None, ways), None):
                # Use the longest possible time, because in 2025-10-03_140506_lab the day alone would be a time, too.
                divided.sort(
                    key=lambda way: -len(way.get("time", "")) if read_time(way.get("time", "")) else 0
                )
                # Return all ways to divide the name, because ben_b_7 may belong to ben or to ben_b.
                facts = [_facts(way, parts[-1]) for way in divided]
                return replace(facts[0], identities=tuple(dict.fromkeys(one.identity for one in facts)))
        return None


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


def _facts(way: dict[str, str], file: str) -> NameFacts:
    word = {name: value.strip() for name, value in way.items()}
    login = word.get("id") or word.get("email") or word.get("login") or word.get("number") or ""
    name = word.get("name") or f"{word.get('first', '')} {word.get('last', '')}".strip()
    column = next((one for one in word if one not in (*_WHO, *_NOT_WHO)), "")
    return NameFacts(
        (Identity(column, word.get(column, ""), login, name),),
        word.get("file") or file,
        when=read_time(word.get("time", "")),
        assignment=base_of(word.get("assignment", "")),
    )
