"""A class on disk: how it is made, where things are in it, who is at work in it."""
