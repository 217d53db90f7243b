"""``autograder site``: the course, its guides and its known mistakes as one book of HTML pages."""
