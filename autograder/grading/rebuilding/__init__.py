"""From what a student handed in to a task: read, compared with the trusted master, rebuilt."""
