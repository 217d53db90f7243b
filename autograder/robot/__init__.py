"""The small robot of the course: how it moves, and what it senses, for the notebook and for the judge."""
