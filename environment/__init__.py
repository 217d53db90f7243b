"""Sets up a clone, as a stand-in for /opt/ros/jazzy: pinned wheels, their repair, the interfaces. No wheel has it."""
