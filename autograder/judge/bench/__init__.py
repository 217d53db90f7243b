"""The bench that a scenario works with: the judge's node with its endpoints, its clock, its record."""
