"""Makes the feedback pages for students, without anything in them that could harm a reader's browser."""
