"""A student's progress: the course page, its words for a terminal, and a notebook begun anew."""
