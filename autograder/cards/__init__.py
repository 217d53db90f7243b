"""The looks of a verdict: an HTML card for notebooks and its plain-text twin for terminals.

Nothing in here knows ROS, notebooks or the judge; it reads ``autograder.verdict`` only.
"""
