"""Makes the tasks of a submission, from the folder of its class."""
