"""The execution of a submission's notebook: a separate kernel, limits on every resource, no process left behind."""
