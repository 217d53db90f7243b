"""The stand-in for /opt/ros/jazzy: pinned wheels, the interface package, the set-up and the doctor."""
