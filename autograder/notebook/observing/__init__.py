"""What a student sees of the running graph: live pictures, plots and recordings."""
