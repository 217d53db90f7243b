"""The subjects that a judge can check: a class or function in a notebook, a command, a workspace, or a launch file."""
