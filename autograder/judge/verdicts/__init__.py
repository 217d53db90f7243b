"""Decides from evidence: the criteria's results, the diagnosis, and whose fault an exception is."""
