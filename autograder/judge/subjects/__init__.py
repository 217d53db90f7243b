"""The subjects that a judge can check: a class or function in a notebook, a command, or a path."""
