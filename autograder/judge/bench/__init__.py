"""What a scenario works with: the judge's node, its publishers, servers and clients, its clock, its record."""
