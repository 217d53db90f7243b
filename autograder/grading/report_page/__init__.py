"""Makes the report page: one HTML page for the instructor about the whole class."""
