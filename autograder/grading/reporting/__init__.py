"""Shows the result of a grading run to the instructor: as a table in the terminal, as JSON, and as a CSV file."""
