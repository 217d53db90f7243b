"""The robot's picture: where it is drawn, and the same in words."""

from __future__ import annotations

import base64
import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

from autograder.notebook.live_robot import RobotPicture, _RobotPictures
from autograder.notebook.robot_node import RobotNames, RobotState
from autograder.robot.motion import START, Pose, Velocity


def place(picture: RobotPicture) -> tuple[float, float, float]:
    """Where the robot is drawn: pixels, and degrees clockwise."""
    found = re.search(
        r'class="robot" transform="translate\(([\d.]+), ([\d.]+)\) rotate\(([-\d.]+)\)', picture.svg()
    )
    assert found is not None
    return tuple(map(float, found.groups()))  # type: ignore[return-value]


def test_a_metre_ahead_is_to_the_right_and_a_metre_to_the_left_is_up() -> None:
    here = place(RobotPicture(RobotState()))
    ahead = place(RobotPicture(RobotState(Pose(START.x + 1, START.y, 0.0))))
    left = place(RobotPicture(RobotState(Pose(START.x, START.y + 1, math.pi / 2))))
    assert ahead[0] - here[0] == here[1] - left[1] > 0
    assert (ahead[1], left[0]) == (here[1], here[0])
    assert left[2] == -90.0


def test_the_words_say_what_is_seen() -> None:
    state = RobotState(Pose(5.0, 2.0, math.pi), Velocity(0.5), lamp=True)
    words = repr(RobotPicture(state))
    assert words == (
        "The robot is in the right room, at x = 5.00 m, y = 2.00 m, heading 180°. "
        "It moves at 0.50 m/s and turns at 0.00 rad/s. Its lamp is on."
    )
    html = RobotPicture(state)._repr_html_()
    assert f'alt="{words}"' in html
    assert "A wall is in its way." in repr(RobotPicture(replace(state, bumped=True)))
    assert "It stands still." in repr(RobotPicture(RobotState()))


def test_it_is_whole_xml_in_every_state() -> None:
    for state in (RobotState(), RobotState(lamp=True, bumped=True, ranges=(1.0, 2.0, 3.0))):
        picture = RobotPicture(state, (START.point, (2.0, 2.0)), START)
        data = re.findall(r"base64,([^\"]+)", picture._repr_html_())[0]
        assert ET.fromstring(base64.b64decode(data)).tag.endswith("svg")


def test_it_glides_the_short_way_round() -> None:
    picture = RobotPicture(RobotState(replace(START, heading=-3.1)), (), replace(START, heading=3.1))
    turns = [float(turn) for turn in re.findall(r"rotate\(([-\d.]+)deg\)", picture.svg())]
    assert abs(turns[1] - turns[0]) < 10


def test_its_bubble_is_inside_of_the_picture_wherever_it_is() -> None:
    page = ET.fromstring(RobotPicture(RobotState()).svg())
    for x, y in ((0.2, 3.8), (5.8, 3.8), (3.0, 0.2)):
        picture = RobotPicture(RobotState(Pose(x, y, 0.0), says="I am at x = 1.0 m, y = 2.0 m <&>"))
        (bubble,) = (part for part in ET.fromstring(picture.svg()).iter() if part.get("class") == "bubble")
        left, top, width = (float(bubble.attrib[name]) for name in ("x", "y", "width"))
        assert left >= 0
        assert top >= 0
        assert left + width <= float(page.attrib["width"])
        assert 'It says "I am at' in repr(picture)
    assert "bubble" not in RobotPicture(RobotState()).svg().split("</style>")[1]


def pictures_of(nodes: list[tuple[str, str]], drivers: list[str]) -> tuple[_RobotPictures, Any]:
    """The pictures of a robot that stands still, and its graph with these nodes, of which some drive it."""
    robot = SimpleNamespace(state=RobotState(), get_fully_qualified_name=lambda: "/robot", names=RobotNames())
    graph = SimpleNamespace(
        get_node_names_and_namespaces=lambda: nodes,
        get_publishers_info_by_topic=lambda topic: [
            SimpleNamespace(node_name=name) for name in drivers if topic == "/cmd_vel"
        ],
    )
    return _RobotPictures(cast("Any", robot)), graph


def test_a_second_robot_of_the_same_name_is_told_below_the_picture_while_it_is_there() -> None:
    nodes = [("robot", "/"), ("talker", "/"), ("robot", "/other")]
    pictures, graph = pictures_of(nodes, [])
    assert pictures.next(cast("Any", graph)) is None
    nodes.append(("robot", "/"))
    picture = pictures.next(cast("Any", graph))
    assert picture is not None
    assert "2 robots are called /robot" in repr(picture)
    assert "<p><strong>2 robots are called /robot" in picture._repr_html_()
    assert pictures.next(cast("Any", graph)) is None
    nodes.pop()
    picture = pictures.next(cast("Any", graph))
    assert picture is not None
    assert "robots are called" not in picture._repr_html_()


def test_two_nodes_that_drive_the_robot_are_named_below_the_picture_while_they_are_there() -> None:
    drivers = ["driver", "keyboard"]
    pictures, graph = pictures_of([("robot", "/")], drivers)
    alone = pictures.next(graph)
    assert alone is not None
    assert "nodes drive" not in repr(alone)
    drivers.append("patrol")
    picture = pictures.next(graph)
    assert picture is not None
    assert "2 nodes drive the robot: driver, patrol." in repr(picture)
    assert "If another notebook runs one of them, stop it there." in picture._repr_html_()
    assert pictures.next(graph) is None
