"""The judge: a ROS node in a process of its own that watches a subject on the wire and gives the verdict."""
