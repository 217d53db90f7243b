"""Grading a class, that is, an nbgrader course directory whose notebooks are judged on the wire."""
