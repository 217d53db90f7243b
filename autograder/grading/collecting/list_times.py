"""Applies the times of handing in that lists contain to the files that the lists are about.

A list that came together with files is about these files only, because a later list may be about later files. A list
that came alone is about the files of one assignment: the assignment that the command named or, if it named none, the
only one of which its students have handed in work.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from datetime import UTC
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

from autograder.grading.collecting.downloaded_files import read_list
from autograder.kit.in_words import counted

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from datetime import datetime, tzinfo

    from autograder.grading.collecting.collected_files import Delivery, Inbox, Line
    from autograder.grading.collecting.lms_lists import ListEntry

NO_LIST = (
    "the file is too large, or not a known list. Known lists are Moodle's grading worksheet, Canvas's gradebook or "
    "submissions, GitHub Classroom's grades and Gradescope's scores. Write times into the column handed_in of "
    "collected.csv, and a list of your students into students.csv of the class"
)
"""The reason why a list cannot be used."""
WAS_READ = "the file was read as a list"


def entries_of(inbox: Inbox) -> dict[str, list[ListEntry]]:
    """Return the entries of all lists in the inbox, by the key of the list."""
    return {
        one.key: read_list(one.name, inbox.read(one.content)) or []
        for delivery in inbox.deliveries.values()
        for one in delivery.arrivals
        if one.is_list
    }


def in_utc(when: datetime | None, zone: tzinfo) -> datetime | None:
    """Return a time in UTC; None for a time in the year 1 or 9999, which may not exist in another time zone."""
    if when is None:
        return None
    try:
        found = (when if when.tzinfo else when.replace(tzinfo=zone)).astimezone(UTC)
    except (OverflowError, ValueError):
        return None
    return found if 1 < found.year < 9999 else None


@dataclass(frozen=True)
class _Time:
    """A time in a list, with the key of the list and the delivery that brought it."""

    when: datetime
    key: str
    delivery: Delivery
    is_alone: bool


class ListTimes:
    """The times in all lists of an inbox.

    Args:
        inbox: The inbox of the class.
        zone: The zone of times that have none, unless the command named another one.
    """

    def __init__(self, inbox: Inbox, zone: tzinfo) -> None:
        entries = entries_of(inbox)
        self._times: dict[tuple[str, str], list[_Time]] = defaultdict(list)
        self._with_times: set[str] = set()
        self._about: set[str] = set()
        """The keys of the lists that a command has collected for one assignment."""
        for delivery in inbox.deliveries.values():
            lists = [one for one in delivery.arrivals if one.is_list]
            there = ZoneInfo(delivery.zone) if delivery.zone else zone
            is_alone = len(lists) == len(delivery.arrivals)
            for key in (one.key for one in lists):
                self._about |= {key} if delivery.assignment else set()
                for entry in entries[key]:
                    when = in_utc(entry.when, there)
                    if when and entry.number:
                        self._times[entry.lms, entry.number].append(_Time(when, key, delivery, is_alone))
                        self._with_times.add(key)

    def applied(self, lines: Sequence[tuple[Delivery, Line]]) -> Iterator[Line]:
        """Yield the lines of deliveries with their times; and the lines of lists with the number of times taken."""
        several: dict[tuple[str, str], set[str]] = defaultdict(set)
        for delivery, line in lines:
            if not line.when and not self._certain(delivery, line):
                several[line.lms, line.number].add(line.assignment)
        taken: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
        doubtful: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
        timed = []
        for delivery, line in lines:
            own = [] if line.when else self._certain(delivery, line)
            open_ = [one for one in self._of(line) if one.is_alone and one.key not in self._about]
            if not own and not line.when and line.assignment and open_:
                own = open_
            is_certain = own is not open_ or len(several[line.lms, line.number]) == 1
            if len({one.when for one in own}) == 1 or not is_certain:
                for one in own:
                    (taken if is_certain else doubtful)[one.key][line.assignment].add(line.number)
                line = replace(line, when=own[0].when, time_from=own[0].key) if is_certain else line
            handed_in = None if line.lms == "list" else delivery.handed_in
            timed.append(replace(line, when=line.when or handed_in))
        for line in timed:
            is_list = line.lms == "list" and line.key in self._with_times
            yield replace(line, reason=_told(taken[line.key], doubtful[line.key])) if is_list else line

    def _of(self, line: Line) -> Sequence[_Time]:
        return self._times.get((line.lms, line.number), ())

    def _certain(self, delivery: Delivery, line: Line) -> list[_Time]:
        """Return the times of lists that came with the file; or else of lists that are about its assignment."""
        times, named = self._of(line), line.assignment
        own = [one for one in times if one.delivery == delivery and delivery.assignment in ("", named)]
        return own or [one for one in times if one.is_alone and named and one.delivery.assignment == named]


def _told(taken: dict[str, set[str]], doubtful: dict[str, set[str]]) -> str:
    each = [
        f"{counted(len(numbers), 'time')} taken, for {name}"
        for name, numbers in sorted(taken.items())
        if name
    ]
    text = f"{WAS_READ}: {', '.join(each) or 'no time taken'}"
    if not doubtful:
        return text
    students = counted(len(set().union(*doubtful.values())), "student")
    names = " and ".join(sorted(doubtful))
    return f"{text}; {students} have work for {names}: collect the list again with --assignment"
