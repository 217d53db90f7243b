"""The table of results of a class: points from the gradebook, texts from the judge, and what a person has to grade."""
