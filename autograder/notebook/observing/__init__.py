"""Show students the running graph: live pictures, plots and recordings."""
