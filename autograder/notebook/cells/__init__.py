"""The notebook's cells: which cell runs, what it prints, and tracebacks with only the student's own lines."""
