"""Grading a class: an nbgrader course directory whose notebooks are judged on the wire."""
