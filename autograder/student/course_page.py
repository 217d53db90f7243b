"""The course page as HTML: one file that fetches nothing from elsewhere."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from autograder.cards.certificate import certificate_svg, certificate_text
from autograder.cards.wording import points, points_of
from autograder.student.lab import COURSE_PAGE
from autograder.student.progress_text import hours

if TYPE_CHECKING:
    from jinja2 import Environment

    from autograder.student.standing import ChapterStanding, Standing

STATES = {"done": "done", "begun": "begun", "new": "not begun"}


def page_html(standing: Standing, base: str, token: str) -> str:
    """The page.

    Args:
        standing: How far the student is.
        base: The server's base address; it ends with a slash.
        token: Proves to the server that an action comes from this page.
    """
    return _environment().get_template("page.html.j2").render(standing=standing, base=base, token=token)


def trouble_html(message: str, base: str) -> str:
    """The page that is shown where the course cannot be read.

    Args:
        message: Why not.
        base: The server's base address; it ends with a slash.
    """
    return _environment().get_template("trouble.html.j2").render(message=message, base=base)


@cache
def _environment() -> Environment:
    from markupsafe import Markup

    from autograder.page_templates import page_templates

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
