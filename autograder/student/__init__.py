"""What students use: JupyterLab, the course page, resetting a notebook, and the hand-out (their copy of the course)."""
