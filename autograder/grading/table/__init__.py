"""Makes the table of results of a class: points from the gradebook, and states and diagnoses from the judge."""
