"""A class on disk: how it is made, its folders, its configuration and its lock."""
