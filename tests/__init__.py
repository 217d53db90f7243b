"""The tests, and programs beside them: ``python -m tests.mutation`` and the like."""
