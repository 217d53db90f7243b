"""Boxes and arrows in columns."""

from __future__ import annotations

import itertools
import random

import pytest

from autograder.notebook.observing.graph_picture import GAP_BESIDE, GraphLayout, lay_out

GAP = 50.0


def laid(boxes: str, *arrows: str) -> GraphLayout:
    """Boxes of 100 to 40 pixels; arrows such as "ab"."""
    return lay_out(dict.fromkeys(boxes, (100.0, 40.0)), [(arrow[0], arrow[1]) for arrow in arrows], GAP)


def column(layout: GraphLayout, box: str) -> float:
    return layout.centers[box][0]


def test_arrows_point_to_the_right() -> None:
    layout = laid("dcba", "ab", "bc", "ad", "dc")
    assert [column(layout, box) for box in "abdc"] == [50.0, 200.0, 200.0, 350.0]
    assert all(arrow.points[0][0] < arrow.points[-1][0] for arrow in layout.arrows)


def test_a_circle_has_one_arrow_back() -> None:
    layout = laid("sabc", "sa", "ab", "bc", "ca")
    back = [arrow for arrow in layout.arrows if arrow.points[-1][0] < arrow.points[0][0]]
    assert len(back) == 1


@pytest.mark.parametrize(
    "arrows",
    [("ab", "ba"), ("ab", "bc", "ca"), ("ab", "bc", "cd", "da", "ae", "ec", "ac"), ("ab", "bc", "cb")],
)
def test_no_arrow_begins_or_ends_where_another_does(arrows: tuple[str, ...]) -> None:
    layout = laid("".join(sorted(set("".join(arrows)))), *arrows)
    ends = [point for arrow in layout.arrows for point in (arrow.points[0], arrow.points[-1])]
    assert len(set(ends)) == len(ends)
    # Also where there is a box between, an arrow passes beside it.
    for arrow in layout.arrows:
        for box, (along, beside) in layout.centers.items():
            for x, y in arrow.points[1:-1]:
                assert abs(x - along) >= 50 or abs(y - beside) >= 20, f"{arrow} runs through {box}"


@pytest.mark.parametrize("arrows", [("ab", "ba"), ("ab", "bc", "cd", "da", "ae", "ec", "ac")])
def test_each_arrow_begins_and_ends_on_the_edge_of_its_box(arrows: tuple[str, ...]) -> None:
    layout = laid("".join(sorted(set("".join(arrows)))), *arrows)
    assert [(arrow.start, arrow.end) for arrow in layout.arrows] == [(arrow[0], arrow[1]) for arrow in arrows]
    for arrow in layout.arrows:
        for box, (x, y) in ((arrow.start, arrow.points[0]), (arrow.end, arrow.points[-1])):
            along, beside = layout.centers[box]
            assert abs(x - along) == 50
            assert abs(y - beside) < 20
        # It leaves to the side on which the other box is, and goes one way only.
        xs = [x for x, _ in arrow.points]
        assert xs == sorted(xs) or xs == sorted(xs, reverse=True)


def test_a_box_that_leads_to_itself_has_no_arrow() -> None:
    assert laid("a", "aa").arrows == ()


def test_an_arrow_that_is_given_twice_is_drawn_once() -> None:
    assert len(laid("ab", "ab", "ab").arrows) == 1


def test_arrows_do_not_cross_without_need() -> None:
    layout = laid("abxy", "ay", "bx")
    height = {box: place for box, (_, place) in layout.centers.items()}
    assert (height["a"] < height["b"]) == (height["y"] < height["x"])


def test_an_empty_graph() -> None:
    assert lay_out({}, [], GAP) == GraphLayout({}, (), (0.0, 0.0))


def test_boxes_never_overlap_and_nothing_leaves_the_picture() -> None:
    for seed in range(30):
        chance = random.Random(seed)
        boxes = "abcdefghij"[: chance.randint(1, 10)]
        sizes = {box: (chance.uniform(40, 200), 40.0) for box in boxes}
        arrows = [(chance.choice(boxes), chance.choice(boxes)) for _ in range(chance.randint(0, 15))]
        layout = lay_out(sizes, arrows, GAP)
        for one, other in itertools.combinations(boxes, 2):
            (x1, y1), (x2, y2) = layout.centers[one], layout.centers[other]
            beside = abs(y1 - y2) - 40 >= GAP_BESIDE - 1e-6
            assert beside or abs(x1 - x2) - (sizes[one][0] + sizes[other][0]) / 2 >= GAP - 1e-6
        width, height = layout.extent
        for box, (x, y) in layout.centers.items():
            assert sizes[box][0] / 2 - 1e-6 <= x <= width - sizes[box][0] / 2 + 1e-6
            assert 20 - 1e-6 <= y <= height - 20 + 1e-6
        assert all(0 <= x <= width and 0 <= y <= height for arrow in layout.arrows for x, y in arrow.points)
