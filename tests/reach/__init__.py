"""Which tests reach a changed file: for ``./course test --changed``."""
