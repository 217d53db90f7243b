"""The student's side: JupyterLab, the course page and its words in a terminal, notebooks begun anew, and the hand-out."""
