"""Programs that measure the judge, as ``python -m tests.measure``."""
