"""A check in a notebook: the connection to the judge, the runs of the subject, and the card."""
