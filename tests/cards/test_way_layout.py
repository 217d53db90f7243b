"""The picture of a robot's way fits its frame, and its sentence says the same."""

from __future__ import annotations

from dataclasses import replace

import pytest

from autograder.cards.html_rendering import card_html
from autograder.cards.text_rendering import card_text
from autograder.cards.way_layout import SHOWN, way_in_words, way_picture
from autograder.verdict import State, Verdict, Way, from_json, to_json

WALL = ((0.0, 0.0), (6.0, 0.0))
WAY = Way(((1.0, 1.0), (4.0, 1.0), (1.0, 1.0)), 1.57, (WALL, ((6.0, 0.0), (6.0, 4.0))), {"lamp": (4.0, 1.5)})
VERDICT = Verdict("a.b", "A", State.PASSED, 10.0, 10.0, ways=(WAY,))


def test_a_way_is_said_in_one_sentence() -> None:
    assert way_in_words(WAY) == (
        "The robot drove 6.0 m, from x = 1.00 m, y = 1.00 m to x = 1.00 m, y = 1.00 m; "
        "it came within 0.50 m of the place “lamp”."
    )
    pushed = replace(WAY, places={}, bumps=((5.8, 1.0),))
    assert way_in_words(pushed).endswith("; it pushed against a wall at x = 5.80 m, y = 1.00 m.")
    supposed = way_in_words(replace(pushed, supposed=True))
    assert supposed.startswith("With the right name, the robot would have driven 6.0 m")
    assert "; it would have pushed against" in supposed


@pytest.mark.parametrize(
    "way", [WAY, Way(((0.0, 0.0), (90.0, 1.0))), Way(((0.0, 0.0), (0.0, -50.0))), Way(((2.0, 2.0),))]
)
def test_all_of_a_way_is_in_its_picture(way: Way) -> None:
    picture = way_picture(way)
    drawn = [picture.start, picture.end, *(place for _, place in picture.names)]
    drawn += [end for wall in picture.walls for end in wall]
    assert all(0 <= x <= picture.width and 0 <= y <= picture.height for x, y in drawn)
    assert picture.width <= 430
    assert picture.height <= 300


def test_y_points_up_and_the_robot_turns_to_the_left() -> None:
    picture = way_picture(WAY)
    assert dict(picture.names)["lamp"][1] < picture.start[1]
    assert picture.turned == pytest.approx(-90.0, abs=0.1)


def test_both_kinds_of_card_say_the_way_and_the_picture_is_escaped() -> None:
    verdict = replace(VERDICT, ways=(replace(WAY, places={"<b>lamp": (4.0, 1.5)}),))
    html = card_html(verdict)
    assert '<svg class="agc-plan" aria-hidden="true"' in html
    assert "<b>lamp" not in html
    assert html.count("The robot drove 6.0 m") == 1
    assert "The robot's path\n  The robot drove 6.0 m" in card_text(verdict)
    assert "The robot's path" not in card_html(verdict, short=True) + card_html(replace(verdict, ways=()))


def test_a_card_has_few_pictures() -> None:
    assert card_html(replace(VERDICT, ways=(WAY,) * 9)).count('<svg class="agc-plan"') == SHOWN


def test_a_way_survives_json() -> None:
    assert from_json(to_json(VERDICT)) == VERDICT
