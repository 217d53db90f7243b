"""What stands in for /opt/ros/jazzy: the wheels and their repair, the interface package, the set-up, the doctor."""
