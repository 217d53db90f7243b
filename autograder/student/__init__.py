"""The student's side: JupyterLab, the course page and its words in a terminal, a notebook begun anew, the hand-out."""
