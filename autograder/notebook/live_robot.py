"""Starts and stops the robot, and draws it live in its two rooms: as SVG, with a description in words."""

from __future__ import annotations

import math
import time
from collections import deque
from dataclasses import dataclass, replace
from html import escape
from typing import TYPE_CHECKING

from IPython.display import display

from autograder.notebook.nodes.background_nodes import replace_named, spin_in_background
from autograder.notebook.nodes.ros_session import start_ros
from autograder.notebook.observing.live_picture import LivePicture, as_image, svg_page
from autograder.notebook.robot_drivers import KEYBOARD, CornerHunt, Spiral
from autograder.notebook.robot_node import RobotNames, RobotNode
from autograder.robot.motion import RADIUS, ROOM
from autograder.robot.plan import Plan, nose

if TYPE_CHECKING:
    from typing import Any

    from rclpy.node import Node

    from autograder.notebook.robot_node import RobotState
    from autograder.robot.motion import Point, Pose


ROBOT_NAME = "robot"
"""The name for ``spin_in_background``, so that a second run of the cell replaces the first robot."""
MINUTES = 30.0
"""The number of minutes for which a picture is kept up to date."""
PERIOD = 0.2
"""Seconds between two pictures if the robot has moved."""
_TRAIL = 150
"""The maximum number of positions in the trail."""
_TRAIL_STEP = 0.08
"""The minimum distance between two positions in the trail, in meters."""
_BUTTON = (
    '<button type="button" class="ros2-course-drive" hidden="hidden" data-commandlinker-command="ros2-course:drive" '
    'data-commandlinker-args="{}">Drive with the arrow keys</button>'
)
"""The HTML of a button. JupyterLab shows it only if the extension of this course is installed."""
LONGEST_WAIT = 20.0
"""The maximum time in seconds for which a cell waits until a scene has ended."""
_LOOK_EVERY = 0.05
_UNKNOWN = "_NODE_NAME_UNKNOWN_"
"""The name of a publisher's node before it has been discovered."""
_TELEPORT = 0.5
"""A distance in meters that the robot cannot roll between two pictures. If the distance is larger, the robot was reset
to the start.
"""


class LiveRobot:
    """A robot that runs in the background. ``start_robot`` returns this object.

    Args:
        stranger: True for a robot with names of its own, which says how many corners it has visited.
    """

    def __init__(self, *, stranger: bool = False) -> None:
        start_ros()
        replace_named(ROBOT_NAME, keep=())
        self._node = RobotNode(RobotNames.drawn() if stranger else RobotNames())
        if stranger:
            self._node.play(CornerHunt())
        self._stranger = stranger
        self._background = spin_in_background(self._node, name=ROBOT_NAME)
        self._picture: LivePicture | None = None

    @property
    def running(self) -> bool:
        """True if the robot is running."""
        return self._background.running

    @property
    def state(self) -> RobotState:
        """The position, motion and laser scan of the robot."""
        return self._node.state

    def show(self) -> None:
        """Show the robot below this cell. An earlier picture stays, but is not updated any more."""
        if self._picture is not None:
            self._picture.stop()
        self._picture = LivePicture(_RobotPictures(self._node), MINUTES)
        self._picture.start()
        if self._picture.running and not self._stranger:
            # The button is not a part of the picture, so that it is not redrawn while a student clicks it.
            display({"text/html": _BUTTON, "text/plain": ""}, raw=True)  # type: ignore[no-untyped-call]

    def walk_numbers(self, action_type: Any, name: str) -> None:
        """Make the robot walk a quarter of a circle for each number that arrives as an action's feedback."""
        self._node.play(Spiral(self._node, action_type, name))

    def wait(self) -> None:
        """Wait until the robot has finished its scene and stands still, at most 20 seconds."""
        deadline = time.monotonic() + LONGEST_WAIT
        while self.running and not self._node.rests and time.monotonic() < deadline:
            time.sleep(_LOOK_EVERY)

    def stop(self) -> None:
        """Destroy the robot's node and stop updating the picture. A second call does nothing."""
        self._background.stop()
        if self._picture is not None:
            self._picture.stop()

    def __repr__(self) -> str:
        """Return one line, shown if this is the last expression of a cell."""
        if self.running:
            listens = (
                "find out what it obeys" if self._stranger else f"it listens to {self._node.names.obeys}"
            )
            return f"The robot runs in the background: {listens}. .stop() ends it."
        return "The robot has stopped: run the cell again that started it."


class _RobotPictures:
    def __init__(self, robot: RobotNode) -> None:
        self.name = "_robot_picture"
        self.period = PERIOD
        self._robot = robot
        self._trail: deque[tuple[float, float]] = deque(maxlen=_TRAIL)
        self._shown = robot.state
        self._robots = 1
        self._drivers: tuple[str, ...] = ()

    def first(self) -> RobotPicture:
        return RobotPicture(self._shown)

    def next(self, node: Node) -> RobotPicture | None:
        before, known = self._shown, (self._robots, self._drivers)
        names = [space.rstrip("/") + "/" + name for name, space in node.get_node_names_and_namespaces()]
        self._robots = max(1, names.count(self._robot.get_fully_qualified_name()))
        publishers = node.get_publishers_info_by_topic(self._robot.names.obeys)
        self._drivers = tuple(sorted({info.node_name for info in publishers} - {KEYBOARD, _UNKNOWN}))
        if self._robot.state == before and (self._robots, self._drivers) == known:
            return None
        far = self._follow()
        glides = not far and self._shown.pose != before.pose
        start = before.pose if glides else None
        return RobotPicture(self._shown, tuple(self._trail), start, PERIOD, self._robots, self._drivers)

    def last(self) -> RobotPicture:
        """Return the last picture, in which the robot stands still."""
        self._follow()
        return RobotPicture(self._shown, tuple(self._trail))

    def _follow(self) -> bool:
        """Add the robot's position to the trail. Return True if it cannot have rolled there since the last picture."""
        state, before = self._robot.state, self._shown
        far = math.dist(state.pose.point, before.pose.point) > _TELEPORT
        if far:
            self._trail.clear()
        if not self._trail or math.dist(state.pose.point, self._trail[-1]) >= _TRAIL_STEP:
            self._trail.append(state.pose.point)
        self._shown = state
        return far


_SCALE = 75
"""Pixels per meter."""
_MARGIN = 14
_at = Plan(0, ROOM.height, _SCALE, _MARGIN).at
_FOOT = 26
_LETTER, _PADDING, _BUBBLE = 7.85, 10, 24
"""Sizes in pixels: the width of a letter, the space left and right of the text, the height of the speech bubble."""

_STYLE = """
.ground { fill: #fff; }
.floor { fill: #f2f5f9; }
.wall { stroke: #212121; stroke-width: 6; stroke-linecap: round; }
.door { stroke: #2e7d32; stroke-width: 3; stroke-dasharray: 4 6; }
.ray { stroke: #0b5cad; stroke-opacity: 0.13; }
.hit { fill: #f57c00; }
.trail { fill: none; stroke: #0b5cad; stroke-width: 2.5; stroke-dasharray: 1 6; stroke-linecap: round; }
.glow { fill: #ffd54f; fill-opacity: 0.45; }
.body { fill: #0b5cad; stroke: #fff; stroke-width: 2; }
.body.bumped { fill: #b3261e; }
.nose { fill: #fff; }
text { font: 13px/1 monospace; fill: #212121; }
text.name { fill: #2e7d32; font-size: 12px; }
.bubble { fill: #fff; stroke: #0b5cad; stroke-width: 1.5; }
"""


@dataclass(frozen=True, repr=False)
class RobotPicture:
    """A picture of the robot at one moment.

    Attributes:
        state: The state of the robot.
        trail: The earlier positions, the oldest first.
        before: The pose in the previous picture, from which an animation moves the robot; None for no animation.
        glide: The duration of the animation in seconds.
        robots: The number of robots with this name on the ROS domain.
        drivers: The names of the nodes that publish on the topic that the robot obeys.
    """

    state: RobotState
    trail: tuple[Point, ...] = ()
    before: Pose | None = None
    glide: float = 0.2
    robots: int = 1
    drivers: tuple[str, ...] = ()

    def __repr__(self) -> str:
        """Return the picture in words."""
        pose, velocity = self.state.pose, self.state.velocity
        room = "the left room" if pose.x < ROOM.door[0] else "the right room"
        doing = "It stands still."
        if velocity.forward or velocity.turn:
            doing = f"It moves at {velocity.forward:.2f} m/s and turns at {velocity.turn:.2f} rad/s."
        wall = " A wall is in its way." if self.state.bumped else ""
        lamp = " Its lamp is on." if self.state.lamp else ""
        says = f' It says "{self.state.says}".' if self.state.says else ""
        return (
            f"The robot is in {room}, at x = {pose.x:.2f} m, y = {pose.y:.2f} m, "
            f"heading {math.degrees(pose.heading):.0f}°. {doing}{wall}{lamp}{says}{self._others()}"
        )

    def _others(self) -> str:
        """Return a warning if other robots have the same name, or several nodes drive; otherwise an empty text."""
        told = ""
        if self.robots > 1:
            told = (
                f"{self.robots} robots are called /robot, and each of them obeys /cmd_vel. If another "
                "notebook has started one, end it there with robot.stop(). The robot of a restarted kernel "
                "disappears within half a minute."
            )
        if len(self.drivers) > 1:
            told += (
                f" {len(self.drivers)} nodes drive the robot: {', '.join(self.drivers)}. It obeys the last command, "
                "whichever node it is from. If another notebook runs one of them, stop it there."
            )
        return told.strip()

    def _repr_html_(self) -> str:
        width, height = _page()
        # decoding="sync": the browser decodes the new picture before it removes the old one, so nothing flickers.
        attributes = (
            f'width="{width}" height="{height}" decoding="sync" style="max-width: 100%; height: auto"'
        )
        warning = f"<p><strong>{escape(self._others().strip())}</strong></p>" if self._others() else ""
        return as_image(self.svg(), repr(self), attributes) + warning

    def svg(self) -> str:
        """Return the picture as SVG."""
        width, height = _page()
        dials = f'<text x="{_MARGIN}" y="{height - 10}">{escape(self._dials())}</text>'
        body = "".join(
            [self._rooms(), self._sight(), self._way(), self._robot(), self._bubble(), dials],
        )
        head = f"<title>{escape(repr(self))}</title>"
        return svg_page(width, height, head, _STYLE + self._gliding(), body)

    def _rooms(self) -> str:
        left, top = _at((0, ROOM.height))
        width, height = ROOM.width * _SCALE, ROOM.height * _SCALE
        floor = f'<rect class="floor" x="{left}" y="{top}" width="{width}" height="{height}"/>'
        x, y = ROOM.door
        door = _line("door", (x, y - 0.6), (x, y + 0.6))
        beside = _at((x + 0.1, y + 0.4))
        name = f'<text class="name" x="{beside[0]}" y="{beside[1]}">door</text>'
        return floor + door + "".join(_line("wall", wall.start, wall.end) for wall in ROOM.walls) + name

    def _sight(self) -> str:
        pose = self.state.pose
        drawn = []
        for ray, distance in enumerate(self.state.ranges):
            angle = pose.heading + math.tau * ray / len(self.state.ranges)
            end = (pose.x + distance * math.cos(angle), pose.y + distance * math.sin(angle))
            x, y = _at(end)
            drawn.append(_line("ray", pose.point, end) + f'<circle class="hit" cx="{x}" cy="{y}" r="2.5"/>')
        return "".join(drawn)

    def _way(self) -> str:
        points = " ".join(f"{x},{y}" for x, y in map(_at, self.trail))
        return f'<polyline class="trail" points="{points}"/>' if points else ""

    def _robot(self) -> str:
        radius = RADIUS * _SCALE
        glow = f'<circle class="glow" r="{2 * radius}"/>' if self.state.lamp else ""
        body = "body bumped" if self.state.bumped else "body"
        return (
            f'<g class="robot" transform="{_placed(self.state.pose, "")}">{glow}'
            f'<circle class="{body}" r="{radius}"/><path class="nose" d="{nose(radius)}"/></g>'
        )

    def _bubble(self) -> str:
        """Return the speech bubble as SVG, above the robot or, if there is no space, below it; empty without a text."""
        if not self.state.says:
            return ""
        x, y = _at(self.state.pose.point)
        width = round(len(self.state.says) * _LETTER + 2 * _PADDING, 1)
        left = min(max(x - width / 2, _MARGIN), _page()[0] - _MARGIN - width)
        away = RADIUS * _SCALE + 8
        top = y - away - _BUBBLE if y - away - _BUBBLE > _MARGIN else y + away
        return (
            f'<rect class="bubble" x="{left:.1f}" y="{top:.1f}" width="{width}" height="{_BUBBLE}" rx="8"/>'
            f'<text x="{left + _PADDING:.1f}" y="{top + 17:.1f}">{escape(self.state.says)}</text>'
        )

    def _gliding(self) -> str:
        if self.before is None:
            return ""
        start, end = (_placed(pose, "px", "deg") for pose in (self.before, _unwound(self.before, self.state)))
        return (
            "@media (prefers-reduced-motion: no-preference) { "
            f".robot {{ animation: glide {self.glide}s linear; }} }} "
            f"@keyframes glide {{ from {{ transform: {start}; }} to {{ transform: {end}; }} }}"
        )

    def _dials(self) -> str:
        pose, velocity = self.state.pose, self.state.velocity
        wall = " · wall!" if self.state.bumped else ""
        return (
            f"x {pose.x:.2f} m · y {pose.y:.2f} m · heading {math.degrees(pose.heading):.0f}° · "
            f"speed {velocity.forward:.2f} m/s{wall}"
        )


def _page() -> tuple[int, int]:
    return round(ROOM.width * _SCALE + 2 * _MARGIN), round(ROOM.height * _SCALE + 2 * _MARGIN + _FOOT)


def _line(kind: str, start: Point, end: Point) -> str:
    (x1, y1), (x2, y2) = _at(start), _at(end)
    return f'<line class="{kind}" x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}"/>'


def _placed(pose: Pose, length: str, angle: str = "") -> str:
    """Return the transform that moves and turns the drawn robot. CSS needs units; an SVG attribute has none."""
    x, y = _at(pose.point)
    return f"translate({x}{length}, {y}{length}) rotate({-math.degrees(pose.heading):.1f}{angle})"


def _unwound(before: Pose, state: RobotState) -> Pose:
    """Return the new pose, with a heading at most half a turn from the earlier one: the robot turns the short way."""
    turned = math.remainder(state.pose.heading - before.heading, math.tau)
    return replace(state.pose, heading=before.heading + turned)
