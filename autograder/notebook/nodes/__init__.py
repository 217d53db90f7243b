"""Run students' nodes: start ROS in the kernel, spin nodes in the background, and end them."""
