"""The bench for scenarios: the judge's node with its endpoints, its clock and its record."""
