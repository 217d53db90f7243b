"""Draws the certificate for earning all points of a chapter, as one self-contained picture."""

from __future__ import annotations

import time
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

from jinja2 import Template

from autograder.cards import wording
from autograder.cards.readable import one_line, wrap

if TYPE_CHECKING:
    from collections.abc import Sequence

WORDS = "Made on your own machine, and checked by the judge there. It is not a grade."
"""The line on each certificate that says what the certificate means."""
_WIDTH = 42
"""The maximum length of a line of the title, in characters."""


def certificate_svg(title: str, points: float, finished: float) -> str:
    """Return the certificate as SVG, with all texts escaped.

    Args:
        title: The title of the chapter.
        points: The total points of the chapter.
        finished: The Unix time in seconds at which the last point was reached.
    """
    return _template().render(
        label=certificate_text(title, points, finished),
        title=_lines(title),
        points=_points(points),
        date=_date(finished),
        words=WORDS,
    )


def certificate_text(title: str, points: float, finished: float) -> str:
    """Return the certificate in words.

    Args:
        title: The title of the chapter.
        points: The total points of the chapter.
        finished: The Unix time in seconds at which the last point was reached.
    """
    return f"Chapter complete: {one_line(title, 160)}. {_points(points)}, {_date(finished)}. {WORDS}"


def mimebundle(title: str, points: float, finished: float) -> dict[str, str]:
    """Return the certificate as ``display(..., raw=True)`` takes it. For the arguments see :func:`certificate_svg`."""
    return {
        "text/html": f'<div class="agc-certificate">{certificate_svg(title, points, finished)}</div>',
        "text/plain": certificate_text(title, points, finished),
    }


def _points(points: float) -> str:
    return f"All {wording.points(points)} points of all exercises"


def _date(finished: float) -> str:
    day = time.localtime(finished)
    return f"{day.tm_mday} {time.strftime('%B %Y', day)}"


def _lines(title: str) -> Sequence[str]:
    title = one_line(title, 2 * _WIDTH)
    name, colon, rest = title.partition(": ")
    if colon and len(title) > _WIDTH and max(len(name), len(rest)) < _WIDTH:
        return [f"{name}:", rest]
    return wrap(title, _WIDTH)[:2]


@cache
def _template() -> Template:
    source = files("autograder.cards").joinpath("certificate.svg.j2").read_text(encoding="utf-8")
    return Template(source, autoescape=True)
