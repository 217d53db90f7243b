"""Shows results to the instructor: in the terminal, as JSON, as a page, and as files for another system."""
