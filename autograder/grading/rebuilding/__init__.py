"""Makes a task from a submitted notebook: reads it, compares it with the trusted master, and builds a new notebook."""
