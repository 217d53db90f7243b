"""A workspace or a launch file run as the subject of a check."""
