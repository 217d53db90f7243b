"""Makes a new class, and the sample class, which is graded at once."""
