"""The limits on a student's texts on a page, for the trial and for the cut."""

HARMLESS_LENGTH = 6_000
"""Characters of a notebook's own texts that need no trial: the worst of them take less than the budget of a page."""
