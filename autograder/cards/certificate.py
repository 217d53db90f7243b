"""The certificate of a chapter: as a picture, in words, and as a notebook displays it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from autograder.cards.card_wording import points, with_solution
from autograder.cards.html_rendering import templates
from autograder.cards.readable_text import one_line, wrap

if TYPE_CHECKING:
    from collections.abc import Sequence


WORDS = "Made on your own machine, and checked by the judge there. It is not a grade."
"""The line on each certificate that says what the certificate means."""
_TITLE_WIDTH = 42
"""The maximum length of a line of the title, in characters."""


@dataclass(frozen=True)
class Certificate:
    """What a student gets for all points of a chapter.

    Attributes:
        title: The title of the chapter.
        points: The points of all exercises.
        finished: The Unix time in seconds at which the last point was reached.
        helped: The number of tasks whose worked solution the student opened before solving them.
    """

    title: str
    points: float
    finished: float
    helped: int = 0

    def svg(self) -> str:
        """Return the certificate as SVG, with all texts escaped."""
        reached, helped, date = self._facts()
        lines = _lines(self.title)
        return (
            templates()
            .get_template("certificate.svg.j2")
            .render(label=self.text(), title=lines, points=reached, helped=helped, date=date, words=WORDS)
        )

    def text(self) -> str:
        """Return the certificate in words."""
        facts = ", ".join(filter(None, self._facts()))
        return f"Chapter complete: {one_line(self.title, 160)}. {facts}. {WORDS}"

    def bundle(self) -> dict[str, str]:
        """Return the certificate as ``display(..., raw=True)`` takes it."""
        html = f'<div class="agc-certificate">{self.svg()}</div>'
        return {"text/html": html, "text/plain": self.text()}

    def _facts(self) -> tuple[str, str, str]:
        day = time.localtime(self.finished)
        date = f"{day.tm_mday} {time.strftime('%B %Y', day)}"
        return f"All {points(self.points)} points of all exercises", with_solution(self.helped), date


def _lines(title: str) -> Sequence[str]:
    """Return the lines of a certificate's title: at most two, and broken after the colon if there is one."""
    title = one_line(title, 2 * _TITLE_WIDTH)
    name, colon, rest = title.partition(": ")
    if colon and len(title) > _TITLE_WIDTH and max(len(name), len(rest)) < _TITLE_WIDTH:
        return [f"{name}:", rest]
    return wrap(title, _TITLE_WIDTH)[:2]
