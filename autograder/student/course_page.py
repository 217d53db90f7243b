"""Makes the course page: as an HTML file that loads nothing else, as text for a terminal, and as JSON."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import msgspec

from autograder.cards.certificate import certificate_svg, certificate_text
from autograder.cards.wording import points, points_of
from autograder.student.lab import COURSE_PAGE
from environment.installation import COMMAND

if TYPE_CHECKING:
    from jinja2 import Environment

    from autograder.student.standing import ChapterStanding, NotebookStanding, Standing

MARKS = {"done": "[x]", "begun": "[~]", "new": "[ ]"}
STATES = {"done": "done", "begun": "begun", "new": "not begun"}


def page_html(standing: Standing, base: str, token: str) -> str:
    """Return the page as HTML.

    Args:
        standing: The progress of the student.
        base: The base address of the server. It ends with a slash.
        token: Proves to the server that a request comes from this page.
    """
    return _environment().get_template("page.html.j2").render(standing=standing, base=base, token=token)


def trouble_html(message: str, base: str) -> str:
    """Return the page that is shown if the course cannot be read.

    Args:
        message: The reason.
        base: The base address of the server. It ends with a slash.
    """
    return _environment().get_template("trouble.html.j2").render(message=message, base=base)


def standing_text(standing: Standing) -> str:
    """Return the page as lines of text."""
    lines = [line for chapter in standing.chapters for line in (*_chapter(chapter), "")]
    if standing.following is not None:
        verb = "Go on" if standing.begun else "Begin"
        lines.append(f"{verb} with {standing.following.title} ({standing.following.name}): {COMMAND} lab")
    lines.append("The points come from your own checks on this machine. They are not a grade.")
    return "\n".join(lines)


def standing_json(standing: Standing) -> str:
    """Return the progress as JSON."""
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
    """Return a rounded duration: ``"40 minutes"``, ``"2 hours"``, ``"8½ hours"``."""
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
        lines += ["", certificate_text(chapter.title, chapter.possible, chapter.finished)]
    elif chapter.minutes_left:
        lines += ["", f"About {hours(chapter.minutes_left)} to go."]
    return lines


@cache
def _environment() -> Environment:
    from markupsafe import Markup

    from autograder.cards.page_templates import page_templates

    environment = page_templates("autograder.student")

    def own_file(name: str) -> Markup:
        return Markup(files("autograder.student").joinpath(name).read_text(encoding="utf-8"))

    def drawn(chapter: ChapterStanding) -> Markup:
        return Markup(certificate_svg(chapter.title, chapter.possible, chapter.finished or 0.0))

    helpers: dict[str, Any] = {
        "certificate": drawn,
        "certificate_text": certificate_text,
        "hours": hours,
        "own_file": own_file,
        "page_name": COURSE_PAGE,
        "points": points,
        "points_of": points_of,
        "quote": quote,
        "states": STATES,
    }
    environment.globals.update(helpers)
    return environment
