"""Makes class directories, reads their folders, configuration and gradebook, and writes results into them."""
