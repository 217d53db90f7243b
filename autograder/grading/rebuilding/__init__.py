"""From the file that a student handed in to a task: it is read, compared with the trusted master, and rebuilt."""
