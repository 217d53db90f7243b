"""The words of a bug hunt: a broken node that a student repairs, and a question on the cause."""
