"""The autograder of the ROS 2 course. It judges nodes on the wire, in a separate process."""
