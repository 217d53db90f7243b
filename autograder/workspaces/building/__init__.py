"""A workspace built with colcon: in place, in a cache, or by the grader for a notebook."""
