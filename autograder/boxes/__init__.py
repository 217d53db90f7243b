"""The execution of a submission's notebook: a kernel of its own, limits on everything, nothing left behind."""
