"""How a submission's notebook is executed: a kernel of its own, limits on everything, nothing left behind."""
