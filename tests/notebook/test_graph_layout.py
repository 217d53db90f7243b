"""Boxes and arrows in columns."""

from __future__ import annotations

import itertools

import pytest

from autograder.notebook.graph_layout import GAP_BESIDE, Layout, is_place_holder, lay_out, place_beside


def column_of(layout: Layout, box: str) -> int:
    return next(number for number, column in enumerate(layout.columns) if box in column)


def test_arrows_point_to_the_right() -> None:
    layout = lay_out(list("dcba"), [("a", "b"), ("b", "c"), ("a", "d"), ("d", "c")])
    assert [column_of(layout, box) for box in "abdc"] == [0, 1, 1, 2]
    assert not any(line.turned for line in layout.lines)


def test_a_circle_has_one_arrow_back() -> None:
    layout = lay_out(list("sabc"), [("s", "a"), ("a", "b"), ("b", "c"), ("c", "a")])
    assert [(line.start, line.end) for line in layout.lines if line.turned] == [("c", "a")]
    assert [column_of(layout, box) for box in "sabc"] == [0, 1, 2, 3]


def test_a_box_that_leads_to_itself() -> None:
    layout = lay_out(["a", "t"], [("a", "t"), ("t", "a")])
    assert [line.turned for line in layout.lines] == [False, True]
    assert lay_out(["a"], [("a", "a")]).columns == (("a",),)


def test_a_long_line_keeps_its_way_free() -> None:
    layout = lay_out(list("abc"), [("a", "b"), ("b", "c"), ("a", "c")])
    (long,) = (line for line in layout.lines if len(line.way) > 2)
    assert (long.start, long.end) == ("a", "c")
    assert long.way[0] == "a"
    assert is_place_holder(long.way[1])
    assert long.way[1] in layout.columns[1]


def test_lines_do_not_cross_without_need() -> None:
    layout = lay_out(list("abxy"), [("a", "y"), ("b", "x")])
    assert layout.columns == (("a", "b"), ("y", "x"))


def test_an_empty_graph() -> None:
    assert lay_out([], []) == Layout((), ())
    assert place_beside(Layout((), ()), {}) == {}


@pytest.mark.parametrize("fan", [1, 2, 5])
def test_boxes_never_overlap(fan: int) -> None:
    takers = [f"t{number}" for number in range(fan)]
    layout = lay_out(
        ["a", *takers, "z"], [("a", taker) for taker in takers] + [(taker, "z") for taker in takers]
    )
    sizes = {name: 40.0 + 10 * number for number, name in enumerate(["a", *takers, "z"])}
    place = place_beside(layout, sizes)
    for column in layout.columns:
        for above, below in itertools.pairwise(column):
            gap = place[below] - sizes[below] / 2 - (place[above] + sizes[above] / 2)
            assert gap >= GAP_BESIDE - 1e-6
    assert min(place[name] - sizes[name] / 2 for name in place) == pytest.approx(0)
