"""Commands for authors: make, try and record exercises, execute all notebooks, build the website."""
