"""The result of a run, shown to the person who started it: a table, a JSON object, a CSV file."""
