"""The feedback pages for students, with nothing harmful in them."""
