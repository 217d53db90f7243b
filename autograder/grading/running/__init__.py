"""Executes tasks in parallel, on this machine or on the workers of a cluster."""
