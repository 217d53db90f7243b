"""The execution of a submission's notebook: a kernel for it alone, limits on every resource, no process left behind."""
