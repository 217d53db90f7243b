"""Runs students' nodes: starts ROS in the kernel, spins nodes in the background, and destroys them at the end."""
