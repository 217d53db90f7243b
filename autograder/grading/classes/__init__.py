"""Makes class directories, and reads their folders, configuration and lock."""
