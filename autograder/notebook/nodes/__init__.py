"""Students' nodes: ROS in the kernel, spinning in the background, and how a node ends."""
