"""Shows students the running graph: live pictures, plots of messages, and recordings."""
