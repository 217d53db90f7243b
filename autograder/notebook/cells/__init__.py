"""Handle the notebook's cells: which one runs, its output, and tracebacks with the student's own lines only."""
