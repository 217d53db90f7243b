"""Sandboxes (boxes) for submissions: separate namespaces, limits on every resource, no process left behind."""
