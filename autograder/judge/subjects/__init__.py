"""What is under test, seen from the judge: something in a notebook, a command, or a path."""
