"""The table of a class: the points of the gradebook, the words of the judge, and what waits for a person."""
