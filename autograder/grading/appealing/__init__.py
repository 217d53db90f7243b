"""Appeals: everything about one check of one student, taken from a class."""
