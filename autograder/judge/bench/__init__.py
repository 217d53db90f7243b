"""The bench on which scenarios run: the judge's node, its endpoints, its clock, and its record."""
