"""Builds and programs as jobs, run here or in a box, and what is known of their processes."""
