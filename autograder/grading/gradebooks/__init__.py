"""How results get into nbgrader's gradebook, through a single writer."""
