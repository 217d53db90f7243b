"""Shows a verdict: as an HTML card in notebooks, and as the same card in plain text in terminals.

This part knows nothing of ROS, notebooks or the judge. Its only input is ``autograder.verdict``.
"""
