"""The notebook's cells: which one runs, what it prints, and tracebacks with only the student's own lines."""
