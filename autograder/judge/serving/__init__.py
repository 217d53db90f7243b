"""The judge's process: it listens, forks a child for each check, and the child exchanges messages with the notebook."""
