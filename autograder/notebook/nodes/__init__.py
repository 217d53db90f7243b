"""How students' nodes run: ROS is started in the kernel, nodes spin in the background, and are ended."""
