"""Makes a new class and the sample class, and changes the students of a class."""
