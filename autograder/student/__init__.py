"""What students use: JupyterLab, the course page (also as text), resetting a notebook, and the hand-out."""
