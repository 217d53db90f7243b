"""The check cell: the conversation with the judge, the runs of the subject, and the card."""
