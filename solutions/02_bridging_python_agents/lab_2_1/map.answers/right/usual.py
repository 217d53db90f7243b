# Right: what the notebook asks for, as a program.
import rclpy
from geometry_msgs.msg import Point
from nav_msgs.msg import OccupancyGrid
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile


class MapKeeper(Node):
    """Publishes a map that late subscribers get, too."""

    def __init__(self) -> None:
        super().__init__("map_keeper")
        self.map = OccupancyGrid()
        self.map.info.width, self.map.info.height, self.map.info.resolution = 6, 4, 1.0
        self.map.data = [0] * 24
        self.create_subscription(Point, "wall", self.on_wall, 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(OccupancyGrid, "map", latched)
        self.publisher.publish(self.map)

    def on_wall(self, point: Point) -> None:
        """Note a wall: the next class does it."""


class GrowingMap(MapKeeper):
    """A map in which walls are noted."""

    def on_wall(self, point: Point) -> None:
        """Note a wall, and publish the map."""
        self.map.data[int(point.y) * 6 + int(point.x)] = 100
        self.publisher.publish(self.map)


rclpy.init()
rclpy.spin(GrowingMap())
