"""A student's progress as plain text for a terminal and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from autograder.cards import certificate
from autograder.cards.wording import points_of

if TYPE_CHECKING:
    from autograder.student.standing import ChapterStanding, NotebookStanding, Standing

MARKS = {"done": "[x]", "begun": "[~]", "new": "[ ]"}


def standing_text(standing: Standing) -> str:
    """The map as lines of text."""
    lines = [line for chapter in standing.chapters for line in (*_chapter(chapter), "")]
    if standing.following is not None:
        verb = "Go on" if standing.begun else "Begin"
        lines.append(f"{verb} with {standing.following.title} ({standing.following.name}): ./course lab")
    lines.append("Points are those of your own checks on this machine. They are no grade.")
    return "\n".join(lines)


def standing_json(standing: Standing) -> str:
    """The same for programs."""
    return msgspec.json.encode(
        {
            "chapters": [
                {
                    "name": chapter.name,
                    "title": chapter.title,
                    "points": chapter.points,
                    "possible": chapter.possible,
                    "finished": chapter.finished,
                    "notebooks": [_as_data(one) for one in chapter.notebooks],
                }
                for chapter in standing.chapters
            ],
            "next": standing.following.name if standing.following else None,
        }
    ).decode()


def hours(minutes: int) -> str:
    """A time that nobody measures: ``"40 minutes"``, ``"2 hours"``, ``"8½ hours"``."""
    if minutes < 60:
        return f"{minutes} minutes"
    halves = round(minutes / 30)
    number = f"{halves // 2}{'½' if halves % 2 else ''}"
    return f"{number} hour{'' if halves == 2 else 's'}"


def _as_data(notebook: NotebookStanding) -> dict[str, object]:
    reached = {"state": notebook.state, "points": notebook.points, "possible": notebook.possible}
    return {**msgspec.to_builtins(notebook), **reached}


def _chapter(chapter: ChapterStanding) -> list[str]:
    width = max((len(one.title) for one in chapter.notebooks), default=0)
    lines = [chapter.title, points_of(chapter.points, chapter.possible), ""]
    for one in chapter.notebooks:
        reached = points_of(one.points, one.possible) if one.possible else "to read"
        minutes = f"{one.minutes} min" if one.minutes else ""
        lines.append(f"  {MARKS[one.state]} {one.title:<{width}}  {minutes:>7}  {reached}".rstrip())
    if chapter.finished is not None:
        lines += ["", certificate.certificate_text(chapter.title, chapter.possible, chapter.finished)]
    elif chapter.minutes_left:
        lines += ["", f"About {hours(chapter.minutes_left)} to go."]
    return lines
