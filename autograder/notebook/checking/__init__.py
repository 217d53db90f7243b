"""The check cell: the connection to the judge, the runs of the subject, and the card."""
