"""``autograder site``: makes one book of HTML pages of the course, its guides and its known mistakes."""
