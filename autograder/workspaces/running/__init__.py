"""Runs builds and programs of workspaces, here or in a box, and watches the processes of a launch."""
