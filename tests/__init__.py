"""The tests, and programs beside them: ``python -m tests.measure mutants`` and the like."""
