"""The recipes for exercises: the scenario, criteria and common mistakes of each kind of subject."""
