"""How much a page may hold of what a student wrote, for who tries it and for who cuts it."""

HARMLESS_LENGTH = 6_000
"""Characters of a notebook's own texts that need no trial: the worst of them take less than the budget of a page."""
