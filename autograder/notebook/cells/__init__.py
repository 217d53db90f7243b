"""The notebook itself: which cell runs, what is said under it, and tracebacks with the student's own lines only."""
