"""The feedback pages for students, which contain nothing harmful."""
