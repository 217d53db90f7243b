"""The report page: one page about the whole class, for the instructor."""
