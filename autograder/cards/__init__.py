"""Shows a verdict: as an HTML card in notebooks, and as the same card in plain text in terminals.

This package imports nothing of ROS, notebooks or the judge. The only input is a verdict (``autograder.verdict``).
"""
