"""The running graph for students: live pictures, plots and recordings."""
