"""Right: asyncio does the waiting, rclpy only publishes."""
import asyncio

import rclpy
from std_msgs.msg import String


async def talk(publisher):
    number = 0
    while True:
        await asyncio.sleep(0.5)
        publisher.publish(String(data=f'Hello, world! {number}'))
        number += 1


def main():
    rclpy.init()
    node = rclpy.create_node('asyncio_talker')
    publisher = node.create_publisher(String, 'chatter', 10)
    try:
        asyncio.run(talk(publisher))
    except KeyboardInterrupt:
        node.destroy_node()


if __name__ == '__main__':
    main()
