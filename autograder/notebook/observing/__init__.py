"""How students see the running graph: live pictures, plots and recordings."""
