"""The picture of the graph, of real nodes."""

from __future__ import annotations

import re
import time
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import pytest
from my_robot_interfaces.action import Fibonacci
from my_robot_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.context import Context
from rclpy.node import Node
from rclpy.utilities import get_default_context
from std_msgs.msg import String

from autograder.notebook import start_ros
from autograder.notebook.observing.graph_picture import GraphPicture, draw_graph
from autograder.notebook.observing.ros_graph import (
    ChannelKind,
    GraphChannel,
    GraphEndpoint,
    RosGraph,
    read_graph,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

CHATTER = GraphChannel(ChannelKind.TOPIC, "/chatter", "std_msgs/msg/String")
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def make() -> Iterator[Callable[[str], Node]]:
    """Make nodes; they are gone after the test."""
    start_ros()
    nodes: list[Node] = []

    def one(name: str, namespace: str = "") -> Node:
        nodes.append(Node(name, namespace=namespace))
        return nodes[-1]

    yield one
    for node in nodes:
        node.destroy_node()


@pytest.mark.ros
def test_topics_services_and_actions_are_seen(make: Callable[..., Node]) -> None:
    one, other = make("one"), make("other", "desk")
    one.create_publisher(String, "chatter", 10)
    other.create_subscription(String, "/chatter", print, 10)
    other.create_client(AddTwoInts, "/add")
    one.create_service(AddTwoInts, "add", print)
    ends = (ActionServer(one, Fibonacci, "count", print), ActionClient(other, Fibonacci, "/count"))
    graph = read_graph()
    for end in ends:
        end.destroy()  # type: ignore[no-untyped-call]  # they would outlive their nodes
    add = GraphChannel(ChannelKind.SERVICE, "/add", "my_robot_interfaces/srv/AddTwoInts")
    count = GraphChannel(ChannelKind.ACTION, "/count", "my_robot_interfaces/action/Fibonacci")
    assert graph.nodes == ("/desk/other", "/one")
    assert set(graph.ends) == {
        GraphEndpoint("/one", CHATTER, True),
        GraphEndpoint("/desk/other", CHATTER, False),
        GraphEndpoint("/desk/other", add, True),
        GraphEndpoint("/one", add, False),
        GraphEndpoint("/desk/other", count, True),
        GraphEndpoint("/one", count, False),
    }


@pytest.mark.ros
def test_two_nodes_of_one_name_in_two_programs_both_count(make: Callable[..., Node]) -> None:
    """A question by a node's name is answered for one of them only."""
    make("twin").create_publisher(String, "chatter", 10)
    other_program = Context()
    other_program.init(domain_id=get_default_context().get_domain_id())
    try:
        other = Node("twin", context=other_program)
        other.create_subscription(String, "chatter", print, 10)
        both = {GraphEndpoint("/twin", CHATTER, True), GraphEndpoint("/twin", CHATTER, False)}
        while set(read_graph().ends) != both:
            time.sleep(0.01)
    finally:
        other_program.shutdown()


@pytest.mark.ros
def test_a_node_that_has_gone_is_not_drawn(make: Callable[..., Node]) -> None:
    make("stays")
    make("goes").destroy_node()
    assert repr(draw_graph()) == "/stays is connected to nothing."


@pytest.mark.ros
def test_nothing_is_running(make: Callable[..., Node]) -> None:
    picture = draw_graph()
    assert repr(picture) == "No node is running."
    ElementTree.fromstring(picture.svg())


GRAPH = RosGraph(
    ("/<talker>", "/listener"),
    (GraphEndpoint("/<talker>", CHATTER, True), GraphEndpoint("/listener", CHATTER, False)),
)


def test_the_picture_has_a_text_alternative() -> None:
    svg = ElementTree.fromstring(GraphPicture(GRAPH).svg())
    assert svg.get("role") == "img"
    assert svg.findtext(f"{SVG}title") == "The running graph"
    assert "/<talker> publishes on /chatter (std_msgs/msg/String)." in str(svg.findtext(f"{SVG}desc"))
    (alternative,) = re.findall(r'<img [^>]*alt="([^"]*)"', GraphPicture(GRAPH)._repr_html_())
    assert "/&lt;talker&gt; publishes on /chatter" in alternative


def test_a_dark_theme_turns_its_brightness_round_and_a_light_one_does_not() -> None:
    html = GraphPicture(GRAPH)._repr_html_()
    (rule,) = re.findall(r"<style>(.*?)</style>", html)
    assert rule.startswith('[data-jp-theme-light="false"] .ros-graph ')
    assert '<img class="ros-graph"' in html


def test_every_box_is_named_and_inside_the_picture() -> None:
    svg = ElementTree.fromstring(GraphPicture(GRAPH).svg())
    names = [text.text for text in svg.iter(f"{SVG}text")]
    assert sorted(filter(None, names)) == ["/<talker>", "/chatter", "/listener", "std_msgs/msg/String"]
    _, _, width, height = map(float, str(svg.get("viewBox")).split())
    for rect in svg.iterfind(f"{SVG}g/{SVG}rect"):
        x, y, w, h = (float(str(rect.get(name))) for name in ("x", "y", "width", "height"))
        assert x >= 0
        assert y >= 0
        assert x + w <= width
        assert y + h <= height


def test_the_arrow_leads_from_the_publisher_to_the_subscriber() -> None:
    svg = ElementTree.fromstring(GraphPicture(GRAPH).svg())
    heads = [path for path in svg.iter(f"{SVG}path") if path.get("class") == "head"]
    boxes = {text.text: float(str(text.get("x"))) for text in svg.iter(f"{SVG}text")}
    tips = sorted(float(re.findall(r"[\d.]+", str(head.get("d")))[0]) for head in heads)
    assert boxes["/<talker>"] < tips[0] < boxes["/chatter"] < tips[1] < boxes["/listener"]


def test_the_first_notebook_s_graph_fits_the_page() -> None:
    """A page shrinks what is too wide, and the letters with it."""
    drive = GraphChannel(ChannelKind.TOPIC, "/cmd_vel", "geometry_msgs/msg/Twist")
    robots = (
        GraphChannel(ChannelKind.TOPIC, "/odom", "nav_msgs/msg/Odometry"),
        GraphChannel(ChannelKind.TOPIC, "/scan", "sensor_msgs/msg/LaserScan"),
        GraphChannel(ChannelKind.SERVICE, "/lamp", "std_srvs/srv/SetBool"),
        GraphChannel(ChannelKind.SERVICE, "/reset", "std_srvs/srv/Trigger"),
        GraphChannel(ChannelKind.ACTION, "/walk_to", "small_robot_interfaces/action/WalkTo"),
    )
    ends = (
        GraphEndpoint("/driver", drive, True),
        GraphEndpoint("/robot", drive, False),
        *(GraphEndpoint("/robot", one, True) for one in robots),
    )
    box = (
        GraphPicture(RosGraph(("/driver", "/robot"), ends)).svg().split('viewBox="')[1].split('"')[0].split()
    )
    assert float(box[2]) < 860
