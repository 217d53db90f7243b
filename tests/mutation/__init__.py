"""Mutants of right answers: each differs in one small thing, and the judge must reject it.

``python -m tests.measure mutants`` makes them, judges them, and lists the survivors.
"""
