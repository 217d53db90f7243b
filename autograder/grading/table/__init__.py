"""The table of a class: points from the gradebook, texts from the judge, and what waits for a person."""
