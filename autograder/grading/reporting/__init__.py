"""The result of a run for the person who started it: a table, a JSON object, a CSV file."""
