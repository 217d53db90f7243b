"""Students' colcon workspaces: built once for the same sources, and run without sourcing anything by hand."""
