"""Likely mistakes in a solution, made from the solution: each mutant differs from it in one thing."""
