"""The recipes: one module for each kind of subject, with its scenario, criteria and common mistakes."""
