"""Boxes and arrows in three columns, measured in the picture."""

from __future__ import annotations

import itertools
import random
import re
from dataclasses import dataclass
from xml.etree import ElementTree

import pytest

from autograder.notebook.observing.graph_picture import GraphPicture
from autograder.notebook.observing.ros_graph import ChannelKind, GraphChannel, GraphEndpoint, RosGraph

SVG = "{http://www.w3.org/2000/svg}"
PAGE = 860
"""Pixels of a notebook's column; what is wider is shrunk, and the letters with it."""


@dataclass(frozen=True)
class Box:
    left: float
    top: float
    width: float
    height: float

    @property
    def middle(self) -> float:
        return self.top + self.height / 2


@dataclass(frozen=True)
class Laid:
    boxes: dict[str, Box]
    arrows: list[tuple[tuple[float, float], tuple[float, float]]]
    width: float
    height: float


def channel(name: str) -> GraphChannel:
    return GraphChannel(ChannelKind.TOPIC, f"/{name}", "std_msgs/msg/String")


def laid(nodes: str, *arrows: str) -> Laid:
    """What is drawn; nodes and topics of one letter, arrows such as "aX" (publishes) and "Xb" (subscribes)."""
    ends = [
        GraphEndpoint(
            f"/{min(arrow, key=str.isupper)}", channel(max(arrow, key=str.isupper)), arrow[0].islower()
        )
        for arrow in arrows
    ]
    svg = ElementTree.fromstring(
        GraphPicture(RosGraph(tuple(f"/{node}" for node in nodes), tuple(sorted(ends)))).svg()
    )
    boxes = {}
    for group in svg.iterfind(f"{SVG}g"):
        rect, text = group.find(f"{SVG}rect"), group.find(f"{SVG}text")
        assert rect is not None
        assert text is not None
        numbers = (float(str(rect.get(name))) for name in ("x", "y", "width", "height"))
        boxes[str(text.text)[1:]] = Box(*numbers)
    drawn = []
    for path in svg.iter(f"{SVG}path"):
        if "line" in str(path.get("class")):
            x1, y1, *_, x2, y2 = map(float, re.findall(r"-?[\d.]+", str(path.get("d"))))
            drawn.append(((x1, y1), (x2, y2)))
    return Laid(boxes, drawn, float(str(svg.get("width"))), float(str(svg.get("height"))))


def test_arrows_lead_to_the_right_through_the_topics() -> None:
    boxes = laid("ab", "aX", "Xb").boxes
    assert boxes["a"].left < boxes["X"].left < boxes["b"].left


def test_a_node_that_hears_more_than_it_says_is_on_the_right() -> None:
    boxes = laid("ab", "aX", "Xb", "Yb", "bZ").boxes
    assert boxes["b"].left > boxes["X"].left == boxes["Z"].left


def test_arrows_in_opposite_directions_lie_apart() -> None:
    ends = [point for arrow in laid("a", "aX", "Xa").arrows for point in arrow]
    assert len(set(ends)) == len(ends) == 4


def test_arrows_do_not_cross_without_need() -> None:
    boxes = laid("abcd", "aY", "bX", "Yd", "Xc").boxes
    up = boxes["a"].middle < boxes["b"].middle
    assert (boxes["Y"].middle < boxes["X"].middle) == up
    assert (boxes["d"].middle < boxes["c"].middle) == up


def test_an_empty_graph_has_a_size() -> None:
    drawn = laid("")
    assert drawn.width > 0 < drawn.height
    assert not drawn.boxes


@pytest.mark.parametrize("count", [1, 7])
def test_a_long_chain_is_no_wider_than_the_page(count: int) -> None:
    nodes, topics = "abcdefgh"[: count + 1], "ABCDEFG"[:count]
    arrows = [node + topic for node, topic in zip(nodes, topics, strict=False)]
    arrows += [topic + node for node, topic in zip(nodes[1:], topics, strict=False)]
    assert laid(nodes, *arrows).width < PAGE


def test_boxes_never_overlap_and_arrows_end_at_their_boxes_and_pass_no_other() -> None:
    for seed in range(40):
        chance = random.Random(seed)
        nodes, topics = "abcdef"[: chance.randint(1, 6)], "UVWXYZ"[: chance.randint(1, 6)]
        pairs = [(chance.choice(nodes), chance.choice(topics)) for _ in range(chance.randint(0, 12))]
        arrows = list(dict.fromkeys("".join(pair[:: chance.choice((1, -1))]) for pair in pairs))
        drawn = laid(nodes, *arrows)
        for one, other in itertools.combinations(drawn.boxes.values(), 2):
            same_column = one.left < other.left + other.width and other.left < one.left + one.width
            assert not same_column or abs(one.top - other.top) > one.height
        for box in drawn.boxes.values():
            assert 0 <= box.left <= box.left + box.width <= drawn.width
            assert 0 <= box.top <= box.top + box.height <= drawn.height
        assert len(drawn.arrows) == len(arrows)
        ends = [point for arrow in drawn.arrows for point in arrow]
        assert len(set(ends)) == len(ends)
        for x, y in ends:
            touched = [
                box
                for box in drawn.boxes.values()
                if min(abs(x - box.left), abs(x - box.left - box.width)) < 0.1
                and abs(y - box.middle) < box.height / 2
            ]
            assert len(touched) == 1
        for (x1, _), (x2, _) in drawn.arrows:
            inside = [
                box for box in drawn.boxes.values() if min(x1, x2) < box.left + box.width / 2 < max(x1, x2)
            ]
            assert not inside
