"""A field of the messages of a topic, drawn over time."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64, Float64MultiArray, String

from autograder.notebook.observing.topic_plots import WINDOW, PlotPicture, number_in, plot

if TYPE_CHECKING:
    from collections.abc import Callable


def test_finds_a_number_by_its_way_through_the_message() -> None:
    message = Twist()
    message.angular.z = 0.5
    assert number_in(message, "angular.z") == 0.5
    assert number_in(Float64MultiArray(data=[1.0, 2.0]), "data[1]") == 2.0


@pytest.mark.parametrize(
    ("message", "field", "words"),
    [
        (Twist(), "linear.w", "linear has no field w: it has x, y, z"),
        (Twist(), "linear", "name one of its fields (x, y, z)"),
        (String(data="3.5"), "data", "data is a str, not a number"),
        (Float64MultiArray(), "data[0]", "data has 0 items: there is no [0]"),
        (Float64(), "data[0]", "data is a float, not a list: leave out [0]"),
        (Twist(), "speed", "the message has no field speed: it has linear, angular"),
    ],
)
def test_says_what_there_is_where_there_is_no_number(message: Any, field: str, words: str) -> None:
    with pytest.raises(LookupError, match=re.escape(words)):
        number_in(message, field)


@pytest.mark.parametrize("field", ["", "a..b", "data[x]", "__import__('os')", "a b"])
def test_what_is_not_written_like_a_field_is_an_error(field: str) -> None:
    with pytest.raises(ValueError, match="such as"):
        plot("/odom", field)


def test_a_point_stands_at_its_time_and_value() -> None:
    picture = PlotPicture("/odom x", ((-WINDOW, 0.0), (-WINDOW / 2, 4.0), (0.0, 2.0)))
    (line,) = re.findall(r'polyline points="([^"]*)"', picture.svg())
    (x1, y1), (x2, y2), (x3, y3) = (map(float, point.split(",")) for point in line.split())
    assert x2 - x1 == pytest.approx(x3 - x2, abs=0.2)
    assert y1 - y2 == pytest.approx(2 * (y1 - y3), abs=0.2)
    assert "from 0 to 4, the last 2" in repr(picture)


@pytest.mark.parametrize("points", [((0.0, 0.0),), ((-1.0, 5.0), (0.0, 5.0)), ((-1.0, -1e9), (0.0, 1e9))])
def test_any_values_can_be_drawn(points: tuple[tuple[float, float], ...]) -> None:
    (line,) = re.findall(r'polyline points="([^"]*)"', PlotPicture("x", points).svg())
    assert all(0 <= float(number) <= 720 for number in re.findall(r"[-\d.]+", line))


def test_what_is_not_finite_is_left_out() -> None:
    inf, nan = float("inf"), float("nan")
    picture = PlotPicture("/scan ranges[0]", ((-3.0, inf), (-2.0, 1.0), (-1.0, nan), (0.0, -inf)))
    assert "1 values in 3 s, from 1 to 1" in repr(picture)
    assert len(re.findall(r'polyline points="[-\d.]+,[-\d.]+"', picture.svg())) == 1
    assert "the last value is inf: nothing to draw" in PlotPicture("x", ((0.0, inf),)).svg()


@pytest.mark.ros
def test_a_plot_follows_its_topic(run_cells: Callable[..., list[Any]]) -> None:
    source = """
import time
from rclpy.node import Node
from std_msgs.msg import Float64
from autograder.notebook import plot, spin_in_background, start_ros
import autograder.notebook.observing.topic_plots as plots
start_ros()
plots.PERIOD = 0.02
curve = plot("speed", "data")
node = Node("car")
publisher = node.create_publisher(Float64, "speed", 10)
values = iter(range(1, 10**6))
node.create_timer(0.01, lambda: publisher.publish(Float64(data=float(next(values)))))
driving = spin_in_background(node)
while len(curve._pictures._points) < 20:
    time.sleep(0.01)
curve.stop()
driving.stop()
numbers = [value for _, value in curve._pictures._points]
print(all(b == a + 1 for a, b in zip(numbers, numbers[1:])))
"""
    (outputs,) = run_cells(source)
    (said,) = (output.text for output in outputs if output.output_type == "stream")
    (shown,) = (output.data["text/plain"] for output in outputs if output.output_type == "display_data")
    assert said == "True\n"
    assert re.match(r"/speed data: \d+ values", shown)
