"""A check's events for its card: the timeline, and the step at which a run leaves the reference solution's."""
