"""How fast the grader is, beside stock nbgrader on the same class: ``python -m benchmarks``."""
