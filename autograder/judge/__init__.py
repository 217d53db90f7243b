"""The judge: a ROS node in its own process, which watches a subject on the wire and decides the verdict."""
