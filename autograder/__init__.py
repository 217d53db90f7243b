"""The autograder of the ROS 2 course: it judges nodes on the wire, from a process of its own."""
