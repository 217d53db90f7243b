"""A class on disk: making it, its folders, its configuration and its lock."""
