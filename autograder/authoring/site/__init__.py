"""``autograder site``: makes a website of HTML pages from the labs, the guides and the list of mistakes."""
