"""How far a student is: the course page, its words for a terminal, and a notebook begun anew."""
